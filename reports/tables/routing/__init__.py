"""Tables of routes."""

from .... import _guard as _guard
