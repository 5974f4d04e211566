"""Missions whose decisions are routes."""

from .... import _guard as _guard
