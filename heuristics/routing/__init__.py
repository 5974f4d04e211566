"""Approximations for routing problems."""

from ... import _guard as _guard
