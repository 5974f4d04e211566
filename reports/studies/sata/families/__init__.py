"""Families of selections and max-min programs that the studies draw from."""

from ..... import _guard as _guard
