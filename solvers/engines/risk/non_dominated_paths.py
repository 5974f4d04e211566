"""Engine ``non-dominated-paths``: all simple paths that none other dominates in mean and variance, by label setting.

Labels, partial paths from the start, are settled in the order of their mean plus the least mean from their end to the goal, so at each
vertex their means ascend: whether one is dominated there needs but the least variance settled so far. One whose variance, with the least
variance to the goal added, is dominated at the goal leads nowhere. A dominated label loses no path: whatever follows adds the
same to both, and a loop that this closes can be cut out.
"""

import heapq
import math
from dataclasses import dataclass

import numpy as np

from ....formulations.problem import Problem
from ....formulations.risk.uncertain_path import Path, UncertainPath
from ....formulations.stop import NEVER, Stop
from ....instances.errors import UsageError
from ....instances.risk.uncertain_graph import Floats, UncertainGraph
from ...backend import BACKENDS, Control, Engine, Options, RawResult

DOMINANCE = ("weak", "pareto", "strict")
"""One path dominates another if neither moment is larger (of equals, the first found stays); if one is smaller besides; if both are."""

_EACH = 100
"""Labels between two looks at the clock."""


@dataclass(frozen=True)
class NonDominated:
    """Simple paths from one start to one goal, in ascending order of mean, then variance.

    ``complete`` says that the search came to its end: else further paths, of larger means, may be missing. ``labels`` counts those settled.
    """

    paths: tuple[Path, ...]
    means: Floats
    variances: Floats
    complete: bool = True
    labels: int = 0


def non_dominated_paths(graph: UncertainGraph, dominance: str = "weak", stop: Stop = NEVER) -> NonDominated:
    """All simple paths from start to goal that no other one dominates in (mean, variance).

    ``dominance`` is a name of ``DOMINANCE``, else UsageError is raised; under ``strict``, a graph without variances has every simple path
    in the set. Source: Hansen (1980), Bicriterion path problems; Skeele (2016), (5.6) and Algorithm 5, corrected:
    docs/formulations/uncertain-path.md#non-dominated-paths.
    """
    if dominance not in DOMINANCE:
        raise UsageError(f"dominance must be one of {', '.join(DOMINANCE)}, not {dominance!r}", "unknown-name")
    mean_left, variance_left = (graph.costs_to(graph.goal, moments) for moments in (graph.mean, graph.variance))
    useful = np.isfinite(mean_left[graph.heads])
    tails, heads = graph.tails[useful], graph.heads[useful].tolist()
    mean, variance = graph.mean[useful], graph.variance[useful]
    leaving = np.searchsorted(tails, np.arange(graph.num_vertices + 1)).tolist()
    mean_to, variance_to = mean_left[graph.heads[useful]], variance_left[graph.heads[useful]]
    ahead = variance_left.tolist()
    fronts = [_Front(dominance) for _ in range(graph.num_vertices)]
    at_goal = fronts[graph.goal]
    settled: list[tuple[int, int]] = []  # vertex, and the label before
    accepted: list[tuple[float, float, int]] = []
    heap: list[tuple[float, float, float, int, int]] = [(float(mean_left[graph.start]), 0.0, 0.0, graph.start, -1)]
    complete = True
    while heap:
        key, m, v, vertex, before = heapq.heappop(heap)
        if fronts[vertex].dominates(m, v) or at_goal.dominates(key, v + ahead[vertex]) or _passes(settled, before, vertex, dominance):
            continue
        if len(settled) % _EACH == _EACH - 1 and stop.reached():
            complete = False
            break
        fronts[vertex].add(m, v)
        settled.append((vertex, before))
        label = len(settled) - 1
        if vertex == graph.goal:
            accepted.append((m, v, label))
            continue
        here = slice(leaving[vertex], leaving[vertex + 1])
        sums, spreads = m + mean[here], v + variance[here]
        keys = sums + mean_to[here]
        worth = np.nonzero(spreads + variance_to[here] <= at_goal.most)[0]
        for k in worth.tolist():
            head = heads[here.start + k]
            if not fronts[head].dominates(s := float(sums[k]), w := float(spreads[k])):
                heapq.heappush(heap, (float(keys[k]), s, w, head, label))
    accepted.sort(key=lambda entry: entry[:2])
    paths = tuple(_traced(settled, label) for _, _, label in accepted)
    moments = np.array([entry[:2] for entry in accepted], dtype=np.float64).reshape(-1, 2)
    return NonDominated(paths, moments[:, 0], moments[:, 1], complete, len(settled))


class _Front:
    """Labels settled at one vertex, in ascending order of mean: the least variance, and the least of smaller means than the last."""

    __slots__ = ("dominance", "least", "mean", "smaller")

    def __init__(self, dominance: str) -> None:
        self.dominance = dominance
        self.mean, self.least, self.smaller = -math.inf, math.inf, math.inf

    @property
    def most(self) -> float:
        """Variance beyond which any label is dominated."""
        return self.smaller if self.dominance == "strict" else self.least

    def dominates(self, mean: float, variance: float) -> bool:
        """True if a settled label dominates one of ``mean``, which is at least that of all settled ones."""
        below = self.least if mean > self.mean else self.smaller  # least variance of smaller means
        if self.dominance == "strict":
            return below < variance
        if self.dominance == "weak":
            return self.least <= variance
        return below <= variance or self.least < variance

    def add(self, mean: float, variance: float) -> None:
        if mean > self.mean:
            self.smaller, self.mean = self.least, mean
        self.least = min(self.least, variance)


def _passes(settled: list[tuple[int, int]], label: int, vertex: int, dominance: str) -> bool:
    """True if the partial path of a label already visits a vertex; under ``weak`` dominance never, for loops are dominated before."""
    if dominance == "weak":
        return False
    while label >= 0:
        here, label = settled[label]
        if here == vertex:
            return True
    return False


def _traced(settled: list[tuple[int, int]], label: int) -> Path:
    path: list[int] = []
    while label >= 0:
        vertex, label = settled[label]
        path.append(vertex)
    return tuple(reversed(path))


@BACKENDS.register("non-dominated-paths")
class NonDominatedPaths(Engine):
    """Label setting over (mean, variance): the cost at risk grows in both, so an optimal path is not dominated.

    Its optimum is a claim of its own, without evidence: a second opinion on what ``supported-paths`` proves.
    """

    name = "non-dominated-paths"
    package = "scipy"
    summary = "optimal paths of uncertain costs by label setting over mean and variance"
    interrupts = "keeps the best of the paths found so far"
    honours = frozenset()
    one_thread = bounds_itself = True
    order = 20
    family = "uncertain-path"
    features = frozenset({"normal-costs", "risk-aversion"})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        assert isinstance(problem, UncertainPath)
        search = non_dominated_paths(problem.graph, stop=stop)
        statistics = {"paths": len(search.paths), "labels": search.labels}
        if not search.paths:
            return RawResult("unknown", stop.reached(), statistics=statistics)
        values = [problem.value(m, v) for m, v in zip(search.means.tolist(), search.variances.tolist(), strict=True)]
        best = min(range(len(values)), key=values.__getitem__)
        if not search.complete:
            return RawResult("feasible", stop.reached(), search.paths[best], values[best], statistics=statistics)
        return RawResult("optimal", "none", search.paths[best], values[best], values[best], statistics=statistics)
