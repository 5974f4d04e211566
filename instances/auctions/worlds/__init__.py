"""Worlds of robots that share tasks."""

from .... import _guard as _guard
