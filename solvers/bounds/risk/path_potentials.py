"""Bound ``path-potentials``: the least cost at risk of any path, from shortest paths under weights of mean and variance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ...engines.risk.path_search.supported_paths import supported_paths
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.risk.uncertain_path import UncertainPath


def missing(problem: Any) -> frozenset[str]:
    """Nothing for paths of uncertain costs."""
    return frozenset() if problem.family == "uncertain-path" else frozenset({f"{problem.family} problems"})


def compute(problem: UncertainPath, stop: Stop, linear: LinearPrograms) -> Evidence:
    """The half-planes of ``supported_paths``; cut short, they prove less."""
    return supported_paths(problem, stop).evidence(problem)


BOUNDS.add("path-potentials", BoundMethod("path-potentials", missing, compute))
