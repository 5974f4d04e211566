"""What heuristics that cut a tour into routes are made of."""

from .... import _guard as _guard
