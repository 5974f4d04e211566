"""Max-min linear programs as data."""

from ... import _guard as _guard
