"""Bound ``all-paths``: proof that no path earns more per risk than the answer at hand, by walking those that could."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....formulations.certificate import verified_bound
from ....formulations.evidence import Evidence
from ....formulations.stop import NEVER, Stop, until
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.risk.risky_path import RiskyPath


def all_paths_bound(
    problem: RiskyPath, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """What the checker of ``all-paths`` derives for the value of an answer.

    Parameters
    ----------
    problem : RiskyPath
    stop : Stop
    linear : unused
        No program is solved.
    target : float, optional
        Value of an answer; None walks all paths.
    """
    made = Evidence("all-paths", "all paths that could earn more", math.nan, {"target": target})
    with until(stop):
        bound = verified_bound(problem, made)
    return None if bound == math.inf else Evidence(made.kind, made.source, bound, made.data)


def _missing(problem: Problem) -> frozenset[str]:
    if problem.family != "risky-path":
        return frozenset({f"{problem.family} problems"})
    return problem.features() & {"objective:risk", "objective:hazard"}


BOUNDS.add("all-paths", BoundMethod("all-paths", _missing, all_paths_bound, order=8, aims=True))
