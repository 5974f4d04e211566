"""Approximations for max-min problems."""

from ... import _guard as _guard
