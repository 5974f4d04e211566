"""Seeded recipes for selection instances."""

from .... import _guard as _guard
