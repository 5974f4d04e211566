"""What the heuristic of safety margins is made of."""

from .... import _guard as _guard
