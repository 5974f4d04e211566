"""Bounds of paths at risk (``move-potentials``, ``guarded-walks``, ``all-paths``) and of paths of uncertain cost (``path-potentials``)."""

import math
from dataclasses import replace

from ....formulations.evidence import Evidence
from ....formulations.risk.risky_path import RiskyPath
from ....formulations.risk.uncertain_path import UncertainPath
from ....formulations.stop import Stop, until
from ....formulations.verified_bounds import verified_bound
from ...engines.risk.risky_path_steps.least_hazard import least_hazard
from ...engines.risk.supported_paths import supported_paths
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod, of_family


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


REWARDS = of_family("risky-path", lambda problem: problem.features() & {"objective:risk", "objective:hazard"})
RISKS = of_family("risky-path", lambda problem: problem.features() & {"objective:reward-per-risk"})

for _method in (
    BoundMethod("move-potentials", of_family("risky-path"), move_potentials),
    BoundMethod("guarded-walks", RISKS, guarded_walks, order=8, aims=True),
    BoundMethod("all-paths", REWARDS, all_paths, order=8, aims=True),
    BoundMethod("path-potentials", of_family("uncertain-path"), path_potentials),
):
    BOUNDS.enter(_method)
