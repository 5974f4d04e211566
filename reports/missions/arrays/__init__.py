"""Missions whose decisions are bare programs."""

from .... import _guard as _guard
