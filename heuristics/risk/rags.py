"""Heuristic ``rags``: the path that risk-aware graph search takes where it observes nothing on the way."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...solvers.engines.risk.path_search.non_dominated_paths import non_dominated_paths
from ..heuristic import HEURISTICS, Context, Heuristic, Outcome
from .graph_policies.rags import RiskAware

if TYPE_CHECKING:
    from ...formulations.risk.uncertain_path import UncertainPath


def rags(
    problem: UncertainPath, context: Context, *, rule: str = "best", dominance: str = "weak", comparison: str = "independent",
    first_edges: str = "separate",
) -> Outcome:  # fmt: skip
    """RAGS without observations (Skeele 2016, Algorithm 5, corrected): docs/formulations/uncertain-path.md#risk-aware-graph-search.

    It looks for where the hindsight-cheapest path probably lies, which is not what the problem's value asks.

    Parameters
    ----------
    problem, context
        See ``Heuristic.run``.
    rule : str
        ``best`` or ``scan``.
    dominance : str
        Of the paths that are compared: ``weak``, ``pareto`` or ``strict``.
    comparison : str
        ``independent`` or ``joint``.
    first_edges : str
        ``separate`` or ``shared``.
    """
    stop = context.begin()
    paths = non_dominated_paths(problem.graph, dominance, stop)
    if not paths.paths:
        return Outcome(None, limit=stop.reached())
    path = RiskAware(problem.graph, paths, rule, comparison, first_edges).route()
    statistics = {"non_dominated": len(paths.paths), "labels": paths.labels}
    return Outcome(path, statistics=statistics, limit="none" if paths.complete else stop.reached())


HEURISTICS.add(
    "rags",
    Heuristic(
        "rags", ("uncertain-path",), frozenset({"normal-costs", "risk-aversion"}), rags,
        "risk-aware graph search, without observations on the way",
    ),
)  # fmt: skip
