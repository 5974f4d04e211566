"""Steps of heuristics that cut a tour into routes."""

from .... import _guard as _guard
