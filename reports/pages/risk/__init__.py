"""Pages of answers about risk."""

from .... import _guard as _guard
