"""What heuristics that add one site after the other are made of."""

from .... import _guard as _guard
