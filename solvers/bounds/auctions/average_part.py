"""Bound ``average-part``: the largest part is no smaller than the mean of what all parts must cost."""

from __future__ import annotations

from typing import Any

from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod


def missing(problem: Any) -> frozenset[str]:
    """Nothing for balanced partitions."""
    return frozenset() if problem.family == "balanced-partition" else frozenset({f"{problem.family} problems"})


def compute(problem: Any, stop: Stop, linear: LinearPrograms) -> Evidence:
    """The checker needs nothing but the data."""
    return Evidence("average-part", "mean of what all parts must cost", 0.0, {})


BOUNDS.add("average-part", BoundMethod("average-part", missing, compute))
