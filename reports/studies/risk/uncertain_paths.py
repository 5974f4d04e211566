"""Paths of uncertain cost: the least mean against its guarantee at a risk of 1/2, and without one at smaller risks, beside RAGS."""

from typing import Any

from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import Configuration
from .families import uncertain_graphs as families

EVEN = 0.5
RISKS = (0.2, 0.05, 0.001)


def _of_risk(problem: Any) -> float | None:
    """At a risk of 1/2 the value is the mean, and a shortest path is optimal; below, variance counts and nothing is known."""
    return 1.0 if problem.risk == EVEN else None


LEAST_MEAN = Configuration("least mean", "least-mean", _of_risk)
RAGS = Configuration("rags", "rags", lambda problem: None)

guarantee_study(
    "least-mean", "the least mean at a risk of 1/2, where it is the value, stated 1", 1000, [LEAST_MEAN],
    [families.graphs(EVEN), families.graphs(EVEN, whole=True), families.roadmaps(EVEN), families.gambles(EVEN), families.long_ways(EVEN)],
)  # fmt: skip

guarantee_study(
    "uncertain-paths", "paths of the least mean, and of RAGS, at risks below 1/2, no ratio stated", 600, [LEAST_MEAN, RAGS],
    [
        *(family(risk) for family in (families.graphs, families.roadmaps, families.gambles) for risk in RISKS),
        families.graphs(0.05, whole=True), families.long_ways(0.05),
    ],
)  # fmt: skip
