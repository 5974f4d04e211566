"""Additive risk: the conventional planner, which adds up the risks of places and sees neither moves nor history."""

import numpy as np
from numpy.typing import NDArray

from ...formulations.risk.risky_path import Path, RiskyPath
from ..heuristic import Context, Outcome, heuristic


@heuristic(
    "additive-risk", "risky-path", {"objective:risk", "objective:hazard", "goals", "locale-risk", "action-risk", "traverse-risk"},
    "least sum of the risks of places, as planners without history have it",
)  # fmt: skip
def run(problem: RiskyPath, context: Context, *, normalised: bool = False) -> Outcome:
    """A path of least sum of the locale risks of its states, of these one of few moves, judged by its true risk like any other.

    With ``normalised`` the risks of each locale element are first spread over [0, 1], from the least to the largest, and weigh the same. No
    guarantee: a sum prefers one state of risk 0.5 to two of 0.26, which together are at 0.4524, and what moves and histories cost is not in
    it. Source: Xiao (2019), (4.1), with the sum from the start on; docs/formulations/risky-path.md#sums-of-risks.
    """
    context.begin()
    graph = problem.graph
    total, none = np.zeros(graph.num_states), np.full(graph.num_states, -1)
    locale = [element for element in graph.elements if element.category == "locale"]
    for element in locale:
        risk = graph.least_risks(element, none, none, np.arange(graph.num_states))
        width = float(np.ptp(risk))
        total += (risk - risk.min()) / (width * len(locale)) if normalised and width > 0.0 else 0.0 if normalised else risk
    path = _shortest(problem, total)
    return Outcome(path, statistics={"sum": float(total[list(path)].sum())} if path else {}, message="" if path else "no goal was reached")


def _shortest(problem: RiskyPath, cost: NDArray[np.float64]) -> Path | None:
    import scipy.sparse as sp
    from scipy.sparse.csgraph import breadth_first_order, dijkstra

    graph = problem.graph
    n, tail, head = graph.num_states, graph.tail, graph.head
    reach = dijkstra(sp.csr_matrix((cost[head], (tail, head)), shape=(n, n)), indices=graph.start)
    ends = [goal for goal in graph.goals if np.isfinite(reach[goal])]
    if not ends:
        return None
    tight = np.isfinite(reach[tail]) & (reach[tail] + cost[head] == reach[head])
    among = sp.csr_matrix((np.ones(int(tight.sum())), (tail[tight], head[tight])), shape=(n, n))
    before = breadth_first_order(among, graph.start, return_predecessors=True)[1]
    at = min(ends, key=lambda goal: float(reach[goal]))
    path = [at]
    while path[-1] != graph.start:
        path.append(int(before[path[-1]]))
    return tuple(reversed(path))
