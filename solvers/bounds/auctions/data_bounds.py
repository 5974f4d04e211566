"""Bounds that need no search: their checkers read the data of the problem alone, and their evidence is empty."""

from typing import Any

from ....formulations.evidence import CHECKERS, Evidence
from .. import BOUNDS, BoundMethod, of_family


def _add(kind: str, family: str, source: str, *, valued: bool = False) -> None:
    def compute(problem: Any, *_: Any) -> Evidence:
        return Evidence(kind, source, CHECKERS[kind](problem, {}) if valued else 0.0, {})

    BOUNDS.enter(BoundMethod(kind, of_family(family), compute))


_add("average-part", "balanced-partition", "mean of what all parts must cost")
_add("best-increments", "room-exploration", "best visits and observations, one a robot and step")
_add("retrievals", "orchard-day", "steps of all retrievals, and of each bin", valued=True)
_add("shortest-ways", "task-allocation", "shortest ways to all tasks")
