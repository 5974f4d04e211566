"""Pages of routing answers."""

from .... import _guard as _guard
