"""Seeded recipes for instances of auctions."""

from .... import _guard as _guard
