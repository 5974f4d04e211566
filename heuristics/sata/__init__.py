"""Approximations of submodular selection, winner takes all and max-min programs."""

from ... import _guard as _guard
