"""Studies of what several wings decide together."""

from .... import _guard as _guard
