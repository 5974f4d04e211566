"""Parts of tours of one robot: the order of its waypoints, and how much it takes at each."""

from .... import _guard as _guard
