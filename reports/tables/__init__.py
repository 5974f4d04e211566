"""Tables of answers."""

from ... import _guard as _guard
