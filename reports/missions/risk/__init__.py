"""Missions on uncertain graphs."""

from .... import _guard as _guard
