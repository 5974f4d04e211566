"""Risk-aware graph search (RAGS): go where the cheapest of the non-dominated paths most probably lies."""

from typing import Self

import numpy as np

from ...formulations.risk.path_sets import FIRST_EDGES, PathSet, cheapest_set_probabilities
from ...formulations.risk.shared_edges import JointCosts, joint_probabilities
from ...formulations.risk.uncertain_path import UncertainPath
from ...formulations.tolerance import EQUAL
from ...instances.errors import UsageError
from ...instances.risk.uncertain_graph import Floats, UncertainGraph
from ...solvers.engines.risk.non_dominated_paths import NonDominated, non_dominated_paths
from ..heuristic import Context, Outcome, heuristic
from ._graph_policies import Following

RULES = ("best", "scan")
"""The next vertex of the largest probability, or the champion of pairwise comparisons in ascending order of the least mean."""

COMPARISONS = ("independent", "joint")
"""Paths as if they shared no edge, as the source has it, or by the joint distribution of their costs."""


class RiskAware(Following):
    """RAGS of Skeele (2016), Algorithm 5, over a given set of paths.

    At each vertex the paths that are left are grouped by where they go next; the probabilities of the groups to hold the cheapest path,
    the first edge at its observed cost, decide. They speak of who would be cheapest in hindsight, not of expected costs. ``rule`` is one of
    ``RULES``, ``comparison`` of ``COMPARISONS``; ``first_edges`` is for edges that are not observed, see ``cheapest_set_probabilities``.

    ``risks`` holds for each step so far the probability of each next vertex that the cheapest path lies elsewhere; under ``scan`` of the
    vertices that were compared with the champion, and lost or won, the risk of that comparison.

    Source: Skeele (2016), Algorithm 5 and (5.2), with the largest probability in place of one of at least 1/2, which need not exist;
    docs/formulations/uncertain-path.md#risk-aware-graph-search.
    """

    def __init__(
        self, graph: UncertainGraph, paths: NonDominated, rule: str = "best", comparison: str = "independent", first_edges: str = "separate"
    ) -> None:
        super().__init__(graph, paths)
        asked = {"rule": (rule, RULES), "comparison": (comparison, COMPARISONS), "first_edges": (first_edges, FIRST_EDGES)}
        for what, (name, choices) in asked.items():
            if name not in choices:
                raise UsageError(f"{what} must be one of {', '.join(choices)}, not {name!r}", "unknown-name")
        self.rule, self.comparison, self.first_edges = rule, comparison, first_edges
        self.risks: list[dict[int, float]] = []
        edges = [graph.edges_of(path) for path in paths.paths]
        self._ahead = [(_sums(graph.mean[used]), _sums(graph.variance[used])) for used in edges]

    def fresh(self) -> Self:
        policy = super().fresh()
        policy.risks = []
        return policy

    def next_vertex(self, at: int, known: Floats) -> int:
        ways = self.ways(at)
        chosen, risks = next(iter(ways)), dict.fromkeys(ways, 0.0)
        if len(ways) > 1:
            sets = {vertex: self._set(at, vertex, members, known) for vertex, members in ways.items()}
            chosen, risks = self._best(sets, ways, known) if self.rule == "best" else self._scan(sets, ways, known)
        self.risks.append(risks)
        return self.take(chosen, ways)

    def route(self) -> tuple[int, ...]:
        """The walk from start to goal where nothing is observed."""
        walk, known = self.fresh(), np.full(self.graph.num_edges, np.nan)
        while walk._walked[-1] != self.graph.goal:
            walk.next_vertex(walk._walked[-1], known)
        return tuple(walk._walked)

    def _set(self, at: int, vertex: int, members: list[int], known: Floats) -> PathSet:
        """Costs of the paths through ``vertex``, beyond it and of the edge that leads there."""
        step = len(self._walked)
        edge = int(self.graph.edges_of((at, vertex))[0])
        cost = float(known[edge])
        first = (cost, 0.0) if cost == cost else (float(self.graph.mean[edge]), float(self.graph.variance[edge]))
        means, variances = (np.array([self._ahead[k][moment][step] for k in members]) for moment in (0, 1))
        return PathSet(means, variances, *first)

    def _probabilities(self, sets: dict[int, PathSet], ways: dict[int, list[int]], known: Floats) -> Floats:
        if self.comparison == "independent":
            return cheapest_set_probabilities(list(sets.values()), self.first_edges)
        step = len(self._walked) - 1
        paths = [self.paths.paths[k][step:] for vertex in sets for k in ways[vertex]]
        costs = JointCosts.of_paths(self.graph, paths, known)
        groups = np.repeat(np.arange(len(sets)), [len(ways[vertex]) for vertex in sets])
        return joint_probabilities(costs.mean, costs.covariance, groups)[0]

    def _best(self, sets: dict[int, PathSet], ways: dict[int, list[int]], known: Floats) -> tuple[int, dict[int, float]]:
        chances = self._probabilities(sets, ways, known)
        chance = dict(zip(sets, chances.tolist(), strict=True))
        best = next(vertex for vertex in _ascending(sets) if chance[vertex] >= chances.max() - EQUAL)
        return best, {vertex: 1.0 - p for vertex, p in chance.items()}

    def _scan(self, sets: dict[int, PathSet], ways: dict[int, list[int]], known: Floats) -> tuple[int, dict[int, float]]:
        champion, *others = _ascending(sets)
        risks: dict[int, float] = {}
        for vertex in others:
            pair = {vertex: sets[vertex], champion: sets[champion]}
            chance = float(self._probabilities(pair, ways, known)[0])
            risks[vertex], risks[champion] = 1.0 - chance, chance
            champion = vertex if chance > 0.5 else champion
        return champion, risks


def _sums(values: Floats) -> Floats:
    """Rest of a path from each of its vertices on."""
    return np.append(np.cumsum(values[::-1])[::-1], 0.0)


def _ascending(sets: dict[int, PathSet]) -> list[int]:
    """Next vertices in ascending order of the least mean, then of their numbers."""
    return sorted(sets, key=lambda vertex: (float(sets[vertex].means.min()) + sets[vertex].first_mean, vertex))


@heuristic("rags", "uncertain-path", {"normal-costs", "risk-aversion"}, "risk-aware graph search, without observations on the way")
def rags(
    problem: UncertainPath, context: Context, *, rule: str = "best", dominance: str = "weak", comparison: str = "independent",
    first_edges: str = "separate",
) -> Outcome:  # fmt: skip
    """The path of RAGS without observations (Skeele 2016, Algorithm 5, corrected).

    It looks for where the hindsight-cheapest path probably lies, which is not what the problem's value asks. ``rule`` is ``best`` or
    ``scan``, ``dominance`` (of the paths that are compared) ``weak``, ``pareto`` or ``strict``, ``comparison`` ``independent`` or
    ``joint``, ``first_edges`` ``separate`` or ``shared``. See docs/formulations/uncertain-path.md#risk-aware-graph-search.
    """
    stop = context.begin()
    paths = non_dominated_paths(problem.graph, dominance, stop)
    if not paths.paths:
        return Outcome(None, limit=stop.reached())
    path = RiskAware(problem.graph, paths, rule, comparison, first_edges).route()
    statistics = {"non_dominated": len(paths.paths), "labels": paths.labels}
    return Outcome(path, statistics=statistics, limit="none" if paths.complete else stop.reached())
