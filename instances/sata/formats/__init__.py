"""File formats of sensing graphs."""

from .... import _guard as _guard
