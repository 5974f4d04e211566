"""Solvers: the registry, one module per backend or engine, reductions."""

from .. import _guard as _guard
