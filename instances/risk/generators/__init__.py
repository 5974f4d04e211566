"""Seeded recipes for instances under risk."""

from .... import _guard as _guard
