"""Choosing elements: submodular functions, winner takes all."""

from ... import _guard as _guard
