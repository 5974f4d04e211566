"""Engines that allocate risks and find risky or uncertain paths."""

from .... import _guard as _guard
