"""Paths of uncertain cost whose optimum is known: random graphs and roadmaps at one risk each, and graphs made to mislead."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from .....formulations.risk.uncertain_path import UncertainPath
from .....instances.errors import CheckFailedError
from .....instances.generating import generate
from .....instances.risk.uncertain_graph import UncertainGraph
from .....solvers.engines.risk.non_dominated_paths import non_dominated_paths
from ....ratios.families import Family, listed
from ....ratios.judged_runs import Case
from ....ratios.optimum import attained

Rng = np.random.Generator
Edge = tuple[int, int, float, float]
"""Tail, head, mean, variance."""

VERTICES = 20
"""Vertices of a roadmap: some 20 of its paths are dominated by none."""


def graph_of(edges: Sequence[Edge], goal: int, name: str) -> UncertainGraph:
    """A graph from vertex 0 to ``goal``, which is the last."""
    tails, heads, mean, variance = zip(*edges, strict=True)
    return UncertainGraph(goal + 1, np.array(tails), np.array(heads), np.array(mean), np.array(variance), 0, goal, name=name)


def enumerated(problem: UncertainPath) -> Case:
    """A case with the best of all its simple paths."""
    graph = problem.graph
    ahead: list[tuple[int, ...]] = [(graph.start,)]
    best: tuple[float, tuple[int, ...]] | None = None
    while ahead:
        path = ahead.pop()
        if path[-1] == graph.goal:
            value = problem.evaluate(path).values[0]
            best = (value, path) if best is None or value < best[0] else best
            continue
        near = graph.heads[graph.indptr[path[-1]] : graph.indptr[path[-1] + 1]].tolist()
        ahead.extend((*path, vertex) for vertex in near if vertex not in path)
    assert best is not None
    return Case(problem, attained(problem, best[1], "enumeration of all paths"))


def from_non_dominated(problem: UncertainPath) -> Case:
    """A case with the best of all paths that none other dominates in mean and variance: the cost at risk grows in both."""
    front = non_dominated_paths(problem.graph)
    if not front.complete:
        raise CheckFailedError(f"the paths of {problem.name} were not searched to the end")
    values = [problem.value(mean, variance) for mean, variance in zip(front.means.tolist(), front.variances.tolist(), strict=True)]
    return Case(problem, attained(problem, front.paths[int(np.argmin(values))], "non-dominated paths"))


# -- random ------------------------------------------------------------------------------------------------------------


def random_graph(rng: Rng, name: str, *, whole: bool) -> UncertainGraph:
    """Five to seven vertices, the path through all of them and half of all other edges; whole moments make ties, and edges of no cost."""
    n = int(rng.integers(5, 8))
    tails, heads = np.nonzero((rng.random((n, n)) < 0.5) | np.eye(n, k=1, dtype=bool))
    tails, heads = tails[tails != heads], heads[tails != heads]
    moments = rng.integers(0, 4, (2, len(tails))).astype(float) if whole else rng.uniform(0.0, 10.0, (2, len(tails)))
    return UncertainGraph(n, tails, heads, moments[0], moments[1], 0, n - 1, name=name)


def _graph(k: int, rng: Rng, whole: bool, risk: float) -> Case:
    return enumerated(UncertainPath(random_graph(rng, f"graph-{k}-risk-{risk:g}", whole=whole), risk))


def graphs(risk: float, *, whole: bool = False) -> Family:
    """Small random graphs; all their paths are compared."""
    what = "ties" if whole else "graphs"
    moments = "moments from 0 to 3" if whole else "moments up to 10"
    return Family(f"{what}, risk {risk:g}", f"random graphs of 5 to 7 vertices, {moments}", partial(_graph, whole=whole, risk=risk))


def _roadmap(k: int, rng: Rng, risk: float) -> Case:
    roadmap = generate("prm-graph", int(rng.integers(0, 2**31)), vertices=VERTICES, variance=400.0, name=f"roadmap-{k}-risk-{risk:g}")
    assert isinstance(roadmap, UncertainGraph)
    return from_non_dominated(UncertainPath(roadmap, risk))


def roadmaps(risk: float) -> Family:
    """Random roadmaps, deviations of up to 20 on edges of some 20 to 150."""
    return Family(f"roadmaps, risk {risk:g}", f"random roadmaps of {VERTICES} vertices", partial(_roadmap, risk=risk))


# -- adversarial -------------------------------------------------------------------------------------------------------


def _gambles(stages: int, variance: float, risk: float) -> Case:
    """Stages, each with an edge of mean 1 and some variance, and a way round of mean 1.01 and none."""
    edges: list[Edge] = []
    for k in range(stages):
        edges += [(2 * k, 2 * k + 2, 1.0, variance), (2 * k, 2 * k + 1, 0.505, 0.0), (2 * k + 1, 2 * k + 2, 0.505, 0.0)]
    return enumerated(UncertainPath(graph_of(edges, 2 * stages, f"gambles-{stages}-{variance:g}-risk-{risk:g}"), risk))


def gambles(risk: float) -> Family:
    """The least mean takes every edge that varies, the least cost at risk few or none."""
    cases = [partial(_gambles, stages, variance, risk) for stages in (1, 3, 5) for variance in (0.01, 1.0, 100.0)]
    return listed(f"gambles, risk {risk:g}", "a mean less by 1 %, at any variance", cases)


def _long_ways(count: int, risk: float) -> Case:
    """One edge of mean 1.001 against a chain of ``count`` edges whose means add up to 1."""
    edges: list[Edge] = [(k, k + 1, 1.0 / count, 0.01) for k in range(count)]
    return enumerated(UncertainPath(graph_of([*edges, (0, count, 1.001, 0.0)], count, f"long-way-{count}-risk-{risk:g}"), risk))


def long_ways(risk: float) -> Family:
    """The path of the least mean has the most edges, and the most variance."""
    return listed(f"long ways, risk {risk:g}", "many edges of a mean less by 0.1 %", [partial(_long_ways, n, risk) for n in (2, 10, 100)])
