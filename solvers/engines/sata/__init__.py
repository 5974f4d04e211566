"""Engines that solve max-min programs."""

from .... import _guard as _guard
