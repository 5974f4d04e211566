"""Bound ``guarded-walks``: least hazards with all that traverse elements remember, and without repetition where walks would gain by it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from ....formulations.certificate import verified_bound
from ....formulations.evidence import Evidence
from ....formulations.stop import NEVER, Stop, until
from ...engines.risk.risky_path_steps.least_hazard import least_hazard
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.risk.risky_path import RiskyPath


def guarded_walks(
    problem: RiskyPath, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """States to guard, as a search for a best path finds them.

    Parameters
    ----------
    problem : RiskyPath
    stop : Stop
    linear : unused
        No program is solved.
    target : unused
        The search ends with the optimum.
    """
    found = least_hazard(problem, problem.graph.goals, stop)
    if stop.reached() and found.hazard == 0.0:
        return None
    evidence = found.evidence()
    with until(stop):
        bound = verified_bound(problem, evidence)
    return None if bound == -math.inf else replace(evidence, value=bound)


def _missing(problem: Problem) -> frozenset[str]:
    if problem.family != "risky-path":
        return frozenset({f"{problem.family} problems"})
    return problem.features() & {"objective:reward-per-risk"}


BOUNDS.add("guarded-walks", BoundMethod("guarded-walks", _missing, guarded_walks, order=8, aims=True))
