"""Set functions and constraints as data."""

from ... import _guard as _guard
