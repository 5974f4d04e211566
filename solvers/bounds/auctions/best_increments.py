"""Bound ``best-increments``: the best visits and observations, one a robot and step."""

from __future__ import annotations

from typing import Any

from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod


def missing(problem: Any) -> frozenset[str]:
    """Nothing for explorations of rooms."""
    return frozenset() if problem.family == "room-exploration" else frozenset({f"{problem.family} problems"})


def compute(problem: Any, stop: Stop, linear: LinearPrograms) -> Evidence:
    """The checker needs nothing but the data."""
    return Evidence("best-increments", "best visits and observations, one a robot and step", 0.0, {})


BOUNDS.add("best-increments", BoundMethod("best-increments", missing, compute))
