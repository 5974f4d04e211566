"""Worlds of robots that watch targets."""

from .... import _guard as _guard
