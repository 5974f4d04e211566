"""Studies of heuristics for routes."""

from .... import _guard as _guard
