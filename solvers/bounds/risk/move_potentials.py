"""Bound ``move-potentials``: least hazards of walks, which no path without repetition falls below."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from ....formulations.certificate import verified_bound
from ....formulations.evidence import Evidence
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.risk.risky_path import RiskyPath


def least_hazards(problem: RiskyPath, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Dijkstra's distances on moves as vertices; exact for locale and action elements where the walk found is a path.

    Parameters
    ----------
    problem : RiskyPath
    stop : Stop
        Looked at before it begins.
    linear : unused
        No program is solved.
    """
    if stop.reached():
        return None
    evidence = problem.moves.evidence(0.0)
    bound = verified_bound(problem, evidence)
    return None if bound == (-math.inf if problem.sense == "min" else math.inf) else replace(evidence, value=bound)


def _missing(problem: Problem) -> frozenset[str]:
    return frozenset() if problem.family == "risky-path" else frozenset({f"{problem.family} problems"})


BOUNDS.add("move-potentials", BoundMethod("move-potentials", _missing, least_hazards))
