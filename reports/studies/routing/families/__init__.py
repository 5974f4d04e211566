"""Families of routing problems that the studies draw from."""

from ..... import _guard as _guard
