"""Studies of risky and uncertain paths."""

from .... import _guard as _guard
