"""What one robot does with its waypoints: in which order it visits them, and how much it takes at each."""

from .... import _guard as _guard
