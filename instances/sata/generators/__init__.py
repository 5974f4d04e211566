"""Generators of sensing graphs and selections."""

from .... import _guard as _guard
