"""Seeded recipes for problems of risk."""

from .... import _guard as _guard
