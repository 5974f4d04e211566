"""Engine ``supported-paths``: paths that are shortest under some weights of mean and variance, with potentials that prove the best.

The cost at risk mean + z sqrt(variance) is concave and grows in both, so it is least at a vertex of the lower left hull of all paths'
(mean, variance); each vertex is a shortest path under weights. Between two paths known, the weights under which they tie show
whether another lies below (Aneja and Nair 1979); where even the corner that the half-planes leave between them is no better than the
best path known, nobody asks.
"""

import math
from dataclasses import dataclass

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.problem import Problem
from ....formulations.risk.uncertain_path import Path, UncertainPath
from ....formulations.stop import Stop
from ....instances.risk.uncertain_graph import Floats, UncertainGraph
from ...backend import BACKENDS, Control, Engine, Options, RawResult

SAME = 1e-13
"""Relative: weighted sums closer than this are one."""


@dataclass(frozen=True)
class Supported:
    """A shortest path under ``weights`` of mean and variance, its moments and weighted sum, and the potentials that prove it."""

    path: Path
    mean: float
    variance: float
    weights: tuple[float, float]
    potentials: Floats
    least: float


@dataclass(frozen=True)
class SupportedPaths:
    """Paths that a search came to, one for each pair of weights asked about, and the one of the least cost at risk.

    ``complete`` says that this is the best of all paths.
    """

    best: Supported
    paths: tuple[Supported, ...]
    complete: bool

    def evidence(self, problem: UncertainPath) -> Evidence:
        """Evidence of a bound on the cost at risk: all weights with their potentials."""
        data = {"weights": [list(s.weights) for s in self.paths], "potentials": [s.potentials.tolist() for s in self.paths]}
        count = len(self.paths)
        source = f"potentials under {count} weight{'' if count == 1 else 's'} of mean and variance"
        return Evidence("path-potentials", source, problem.value(self.best.mean, self.best.variance), data)


def shortest_path(graph: UncertainGraph, weights: tuple[float, float]) -> Supported:
    """A shortest path under weights >= 0 of mean and variance (Dijkstra 1959).

    Its potentials are the distances from the start, no larger than the goal's.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import dijkstra

    cost = weights[0] * graph.mean + weights[1] * graph.variance
    matrix = csr_matrix((cost, graph.heads, graph.indptr), shape=(graph.num_vertices,) * 2)
    distance, before = dijkstra(matrix, indices=graph.start, return_predecessors=True)
    path = [graph.goal]
    while path[-1] != graph.start:
        path.append(int(before[path[-1]]))
    vertices = tuple(reversed(path))
    edges = graph.edges_of(vertices)
    moments = math.fsum(graph.mean[edges]), math.fsum(graph.variance[edges])
    potentials = np.minimum(distance, distance[graph.goal])
    return Supported(vertices, *moments, weights, potentials, weights[0] * moments[0] + weights[1] * moments[1])


def supported_paths(problem: UncertainPath, stop: Stop) -> SupportedPaths:
    """Search until the best path is proved the best, or ``stop``."""
    graph, z = problem.graph, problem.z

    def value(mean: float, variance: float) -> float:
        return mean + z * math.sqrt(max(variance, 0.0))

    steepest = shortest_path(graph, (1.0, 0.0))
    if z == 0.0:
        return SupportedPaths(steepest, (steepest,), True)
    flattest = shortest_path(graph, (0.0, 1.0))
    paths = [steepest, flattest]
    best = min(paths, key=lambda s: value(s.mean, s.variance))
    open_ = [(steepest, steepest, flattest, flattest)]  # two paths, and by which half-planes the region ends at each
    while open_ and not stop.reached():
        left, by_left, right, by_right = open_.pop()
        if value(*_corner(by_left, by_right)) >= value(best.mean, best.variance) * (1.0 - SAME):
            continue
        less, more = left.variance - right.variance, right.mean - left.mean
        if less <= 0.0 or more <= 0.0:  # but for rounding, one is no worse than the other
            continue
        most = max(less, more)
        middle = shortest_path(graph, (less / most, more / most))
        paths.append(middle)
        if value(middle.mean, middle.variance) < value(best.mean, best.variance):
            best = middle
        ends = min(_weighted(left, middle.weights), _weighted(right, middle.weights))
        if middle.least < ends * (1.0 - SAME):
            open_ += [(left, by_left, middle, middle), (middle, middle, right, by_right)]
    return SupportedPaths(best, tuple(paths), not open_)


def _corner(first: Supported, second: Supported) -> tuple[float, float]:
    """Mean and variance where both weighted sums are at their least."""
    (a, b), (c, d) = first.weights, second.weights
    size = a * d - b * c
    return (d * first.least - b * second.least) / size, (a * second.least - c * first.least) / size


def _weighted(path: Supported, weights: tuple[float, float]) -> float:
    return weights[0] * path.mean + weights[1] * path.variance


@BACKENDS.register("supported-paths")
class SupportedPathsEngine(Engine):
    """Shortest paths under weights that close in on the least cost at risk (Aneja and Nair 1979; Nikolova et al. 2006).

    Each weight asked about is one run of Dijkstra's algorithm, and a half-plane of the bound.
    """

    name = "supported-paths"
    package = "scipy"
    summary = "optimal paths of uncertain costs by shortest paths under weights, with a proof"
    interrupts = "keeps the best path and the bound so far"
    honours = frozenset()
    one_thread = bounds_itself = True
    order = 10
    family = "uncertain-path"
    features = frozenset({"normal-costs", "risk-aversion"})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        assert isinstance(problem, UncertainPath)
        search = supported_paths(problem, stop)
        value = problem.value(search.best.mean, search.best.variance)
        status, limit = ("optimal", "none") if search.complete else ("feasible", stop.reached())
        bound = value if search.complete else None
        return RawResult(
            status, limit, search.best.path, value, bound, statistics={"weights": len(search.paths)}, evidence=(search.evidence(problem),)
        )
