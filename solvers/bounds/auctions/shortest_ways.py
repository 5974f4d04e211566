"""Bound ``shortest-ways``: nobody is at a task sooner than the shortest way from any robot allows."""

from __future__ import annotations

from typing import Any

from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod


def missing(problem: Any) -> frozenset[str]:
    """Nothing for task allocation."""
    return frozenset() if problem.family == "task-allocation" else frozenset({f"{problem.family} problems"})


def compute(problem: Any, stop: Stop, linear: LinearPrograms) -> Evidence:
    """The checker needs nothing but the data."""
    return Evidence("shortest-ways", "shortest ways to all tasks", 0.0, {})


BOUNDS.add("shortest-ways", BoundMethod("shortest-ways", missing, compute))
