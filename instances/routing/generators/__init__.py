"""Seeded recipes for routing instances."""

from .... import _guard as _guard
