"""Bounds of paths at risk (``move-potentials``, ``guarded-walks``, ``all-paths``) and of paths of uncertain cost (``path-potentials``)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ....formulations.evidence import Evidence
from ....formulations.risk.risky_path import RiskyPath
from ....formulations.risk.uncertain_path import UncertainPath
from ....formulations.stop import Stop, until
from ....formulations.verified_bounds import verified_bound
from ...engines.risk.risky_path_steps.least_hazard import least_hazard
from ...engines.risk.supported_paths import supported_paths
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod


def move_potentials(problem: RiskyPath, stop: Stop, linear: LinearPrograms) -> Evidence | None:
    """Least hazards of walks (Dijkstra's distances on moves as vertices), which no path without repetition falls below.

    They are exact for locale and action elements where the walk found is a path.
    """
    if stop.reached():
        return None
    return _verified(problem, problem.moves.evidence(0.0), stop)


def guarded_walks(problem: RiskyPath, stop: Stop, linear: LinearPrograms, target: float | None = None) -> Evidence | None:
    """Least hazards with all that traverse elements remember, and without repetition of the states that walks would gain by."""
    walks = least_hazard(problem, problem.graph.goals, stop)
    return None if stop.reached() and walks.hazard == 0.0 else _verified(problem, walks.evidence(), stop)


def all_paths(problem: RiskyPath, stop: Stop, linear: LinearPrograms, target: float | None = None) -> Evidence | None:
    """Proof that no path earns more per risk than ``target``, by walking those that could; all paths without a target."""
    return _verified(problem, Evidence("all-paths", "all paths that could earn more", math.nan, {"target": target}), stop)


def _verified(problem: RiskyPath, evidence: Evidence, stop: Stop) -> Evidence | None:
    """Evidence with the bound that its checker derives; None where that is none."""
    with until(stop):
        bound = verified_bound(problem, evidence)
    return None if bound == (-math.inf if problem.sense == "min" else math.inf) else replace(evidence, value=bound)


def path_potentials(problem: UncertainPath, stop: Stop, linear: LinearPrograms) -> Evidence:
    """Shortest paths under weights of mean and variance as half-planes that hold the cost at risk; cut short, they prove less."""
    return supported_paths(problem, stop).evidence(problem)


def _missing(family: str, *features: str) -> Callable[[Any], frozenset[str]]:
    return lambda problem: problem.features() & set(features) if problem.family == family else frozenset({f"{problem.family} problems"})


for _method in (
    BoundMethod("move-potentials", _missing("risky-path"), move_potentials),
    BoundMethod("guarded-walks", _missing("risky-path", "objective:reward-per-risk"), guarded_walks, order=8, aims=True),
    BoundMethod("all-paths", _missing("risky-path", "objective:risk", "objective:hazard"), all_paths, order=8, aims=True),
    BoundMethod("path-potentials", _missing("uncertain-path"), path_potentials),
):
    BOUNDS.add(_method.name, _method)
