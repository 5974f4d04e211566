"""What the savings heuristic is made of."""

from .... import _guard as _guard
