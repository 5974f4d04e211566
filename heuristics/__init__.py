"""Approximations and their guarantees, one algorithm per module."""

from .. import _guard as _guard
