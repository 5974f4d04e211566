"""Steps of the savings heuristic."""

from .... import _guard as _guard
