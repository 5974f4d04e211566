"""Worlds of uncertain and risky ways."""

from .... import _guard as _guard
