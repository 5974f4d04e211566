"""Tables of risk allocations and paths."""

from .... import _guard as _guard
