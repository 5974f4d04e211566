"""Bound ``retrievals``: days in the orchard by the steps that all retrievals take, and the earliest that each bin can be home."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ....formulations.auctions.checking.retrievals import check_retrievals
from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.auctions.orchard_day import OrchardDay


def missing(problem: Any) -> frozenset[str]:
    """Nothing for days in the orchard."""
    return frozenset() if problem.family == "orchard-day" else frozenset({f"{problem.family} problems"})


def compute(problem: OrchardDay, stop: Stop, linear: LinearPrograms) -> Evidence:
    """There is nothing to search for: the evidence is the instance."""
    return Evidence("retrievals", "steps of all retrievals, and of each bin", check_retrievals(problem, {}), {})


BOUNDS.add("retrievals", BoundMethod("retrievals", missing, compute))
