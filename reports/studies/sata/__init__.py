"""Studies of greedy rules and the local algorithm."""

from .... import _guard as _guard
