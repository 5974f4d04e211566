"""Bundled instances, made by the generators of this package."""

from ... import _guard as _guard
