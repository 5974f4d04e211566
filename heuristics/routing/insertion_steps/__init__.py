"""Steps of heuristics that add one site after the other."""

from .... import _guard as _guard
