"""Approximations for selection problems."""

from ... import _guard as _guard
