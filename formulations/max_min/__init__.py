"""Bottleneck assignment and max-min linear programs."""

from ... import _guard as _guard
