"""File formats of routing instances."""

from .... import _guard as _guard
