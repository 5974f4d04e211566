"""Combinatorial and LP bounds, each with evidence: one module a bound."""

from ... import _guard as _guard
