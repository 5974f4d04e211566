"""Heuristics by name: one algorithm a module, which registers itself."""

from ... import _guard as _guard
