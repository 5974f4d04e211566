"""Heuristics beside bare programs."""

from ... import _guard as _guard
