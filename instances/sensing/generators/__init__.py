"""Seeded recipes for sensing graphs."""

from .... import _guard as _guard
