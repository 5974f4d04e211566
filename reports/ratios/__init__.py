"""Approximation ratios, observed against stated, and the experiments on sensing graphs: one module a study in ``studies``."""

from ... import _guard as _guard
