"""Bottleneck problems of divisible robots: random graphs, and those on which the local algorithm attains its bound."""

import math
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from .....formulations.sata.bottleneck_sata import BottleneckSATA
from .....formulations.sata.max_min_lp import MaxMinLP
from .....instances.sata.sensing_graph import SensingGraph, graph_of_edges
from ....ratios.families import Family, listed
from ....ratios.judged_runs import Case
from ....ratios.optimum import Optimum, attained
from .optima import best_shares

Rng = np.random.Generator
Sees = Mapping[int, float] | Sequence[int]


# -- random graphs ----------------------------------------------------------------------------------------------------


def weights(rng: Rng, kind: str, size: int) -> NDArray[np.float64]:
    """Weights > 0 of one kind: ``unit``, ``whole``, ``uniform`` or ``spread`` (log-normal, sigma 1.5)."""
    if kind == "unit":
        return np.ones(size)
    if kind == "whole":
        return rng.integers(1, 5, size).astype(np.float64)
    return rng.uniform(0.05, 2.0, size) if kind == "uniform" else rng.lognormal(0.0, 1.5, size)


def unequal_graph(rng: Rng, kind: str, name: str) -> SensingGraph:
    """Robots of 1 to 5 actions, some of which see nothing; every target is seen, some by one action only."""
    robots = int(rng.integers(1, 13))
    owner = np.repeat(np.arange(robots), rng.integers(1, int(rng.integers(2, 7)), robots))
    targets = int(rng.integers(1, max(2, len(owner)) + 1))
    sees = rng.random((len(owner), targets)) < rng.uniform(0.05, 0.5)
    lonely = ~sees.any(axis=0)
    sees[rng.integers(0, len(owner), int(lonely.sum())), np.nonzero(lonely)[0]] = True
    action, target = np.nonzero(sees)
    return graph_of_edges(owner, action, target, weights(rng, kind, len(action)), robots=robots, targets=targets, name=name)


def near_regular_graph(rng: Rng, kind: str, name: str) -> SensingGraph:
    """Two actions a robot, two edges an action, four a target, joined to targets of nearby numbers; repeated edges add up."""
    robots = int(rng.integers(2, 31))
    stubs = np.arange(4 * robots)
    order = np.argsort(stubs + rng.uniform(0.0, min(48.0, robots), len(stubs)), kind="stable")
    target = np.empty(len(stubs), dtype=np.int64)
    target[order] = stubs // 4
    return graph_of_edges(
        np.repeat(np.arange(robots), 2), stubs // 2, target, weights(rng, kind, len(stubs)), robots=robots, targets=robots,
        duplicates="sum", name=name,
    )  # fmt: skip


def ring_graph(rng: Rng, kind: str, name: str) -> SensingGraph:
    """Robots on a ring, two actions each, which see one to three targets of nearby numbers; every target is seen."""
    robots = int(rng.integers(3, 31))
    reach = int(rng.integers(1, 4))
    action = np.repeat(np.arange(2 * robots), rng.integers(1, 4, 2 * robots))
    target = (action // 2 + rng.integers(-reach, reach + 1, len(action))) % robots
    pairs = np.unique(np.stack([np.append(action, 2 * np.arange(robots)), np.append(target, np.arange(robots))]), axis=1)
    return graph_of_edges(
        np.repeat(np.arange(robots), 2), pairs[0], pairs[1], weights(rng, kind, pairs.shape[1]), robots=robots, targets=robots, name=name
    )


RANDOM = {
    "unequal": (unequal_graph, "robots of 1 to 5 actions, targets seen by any number of them", ("unit", "whole", "uniform", "spread")),
    "near-regular": (near_regular_graph, "two actions a robot, two edges an action, four a target", ("uniform", "spread")),
    "ring": (ring_graph, "robots on a ring that see near targets", ("unit", "spread")),
}
"""Random graphs by name: how one is drawn, what it is, and its kinds of weights."""


def _random_family(name: str, kind: str) -> Family:
    draw, summary, _ = RANDOM[name]

    def make(k: int, rng: Rng) -> Case:
        return Case(BottleneckSATA(draw(rng, kind, f"{name}-{kind}-{k}"), fractional=True))

    return Family(f"{name}-{kind}", f"{summary}; {kind} weights", make)


RANDOM_FAMILIES = tuple(_random_family(name, kind) for name, (_, _, kinds) in RANDOM.items() for kind in kinds)


def packing_rows(rng: Rng, kind: str, name: str) -> MaxMinLP:
    """A max-min LP whose variables stand in one packing row each, with coefficients of any size."""
    graph = unequal_graph(rng, kind, name)
    packing, covering = np.zeros((graph.num_robots, graph.num_actions)), np.zeros((graph.num_targets, graph.num_actions))
    packing[graph.robot_of_action, np.arange(graph.num_actions)] = weights(rng, kind, graph.num_actions)
    covering[graph.indices, graph.action_of_edge] = graph.weights
    return MaxMinLP(packing, covering, name=name)


def _random_program(k: int, rng: Rng) -> Case:
    kind = ("unit", "whole", "uniform", "spread")[k % 4]
    return Case(packing_rows(rng, kind, f"packing-rows-{kind}-{k}"))


RANDOM_PROGRAMS = Family("packing-rows", "max-min LPs with one packing row a variable and coefficients of any size", _random_program)


def side_by_side(graph: SensingGraph, times: float) -> SensingGraph:
    """A graph, and after it a copy of its own robots and targets with weights so many times as large."""
    robots, actions, targets = graph.num_robots, graph.num_actions, graph.num_targets
    return graph_of_edges(
        np.concatenate([graph.robot_of_action, graph.robot_of_action + robots]),
        np.concatenate([graph.action_of_edge, graph.action_of_edge + actions]),
        np.concatenate([graph.indices, graph.indices + targets]),
        np.concatenate([graph.weights, times * graph.weights]), robots=2 * robots, targets=2 * targets, name=f"{graph.name}-twice",
    )  # fmt: skip


def _whole(k: int, rng: Rng) -> Case:
    """Up to 5 robots of up to 4 actions, every target seen, some by one action only."""
    owner = np.repeat(np.arange(int(rng.integers(1, 6))), 4)
    owner = owner[np.append(True, rng.random(len(owner) - 1) < 0.7)]
    targets = int(rng.integers(1, 7))
    sees = rng.random((len(owner), targets)) < rng.uniform(0.2, 0.7)
    sees[rng.integers(0, len(owner), targets), np.arange(targets)] = True
    action, target = np.nonzero(sees)
    weight = weights(rng, ("unit", "whole", "uniform", "spread")[k % 4], len(action))
    return Case(BottleneckSATA(graph_of_edges(owner, action, target, weight, robots=5, targets=targets, name=f"whole-actions-{k}")))


WHOLE = Family("whole-actions", "up to 5 robots of up to 4 actions, undivided, every target seen", _whole)


# -- graphs by hand ---------------------------------------------------------------------------------------------------


def robots(rows: Sequence[Sequence[Sees]], name: str) -> BottleneckSATA:
    """A fractional bottleneck problem from robots x actions x what they see: targets from 0, or weights by target."""
    owner: list[int] = []
    edges: list[tuple[int, int, float]] = []
    for i, actions in enumerate(rows):
        for sees in actions:
            weighted = sees if isinstance(sees, Mapping) else dict.fromkeys(sees, 1.0)
            edges += [(len(owner), target, weight) for target, weight in weighted.items()]
            owner.append(i)
    action, target, weight = (np.array(column) for column in zip(*edges, strict=True))
    return BottleneckSATA(graph_of_edges(owner, action, target, weight, robots=len(rows), name=name), fractional=True)


def _known(problem: BottleneckSATA, value: float, shares: Sequence[float] | None = None) -> Case:
    """A case whose optimum is known as a number, and with ``shares`` as an answer; the enumeration-free solver must find the same."""
    best = attained(problem, np.array(shares, dtype=np.float64), "construction") if shares is not None else best_shares(problem)
    if not math.isclose(best.value, value, rel_tol=1e-9, abs_tol=1e-12):
        raise AssertionError(f"{problem.name}: the optimum is {value!r} by construction, {best.value!r} by {best.source}")
    return Case(problem, Optimum(best.value, best.answer, "construction"))


REFERENCES: dict[str, tuple[list[list[Sees]], float]] = {
    "A": ([[[0], [1]], [[1, 2], [2]], [[2], [0]]], 4 / 3),
    "C": ([[{0: 2.0, 1: 3.0}]], 2.0),
    "D": ([[[0], [1]], [[1], [2]]], 2 / 3),
    "E": ([[{0: 2.0}, {1: 1.0}], [{1: 3.0}, {2: 1.0}]], 8 / 9),
    "F": ([[[0, 1], {1: 1.0, 2: 2.0}, [2]], [[0], {1: 3.0}, [2, 3]]], 1.0),
    "G": ([[[0]], [[0, 1], [2]], [[1], [2], [3], [3, 0]]], 2 / 3),
    "S1w": ([[{0: 5.0}, {1: 3.0}], [{1: 3.0, 2: 3.0}, {2: 4.0}], [{2: 2.0}, {0: 4.0}]], 30 / 7),
    "S6": ([[[1, 2], [3]], [[3], [0, 1]], [[3], [0, 2]]], 6 / 5),
    "S7": ([[{2: 2.0}, {0: 3.0, 2: 1.0}], [{0: 3.0, 1: 1.0}, {1: 2.0}]], 12 / 7),
    "S8": ([[[0, 1], [1]]], 1.0),
    "S10": ([[{0: 4.0, 1: 2.0}, {2: 5.0}], [{0: 4.0}, {1: 3.0}], [{0: 3.0, 2: 1.0}, {1: 5.0}]], 4.661764705882353),
}
"""Small graphs with their optima: cases A to G, and S1w to S10 of docs/formulations/sensing.md#reference-cases; A is S1."""


def _reference(name: str) -> Case:
    rows, value = REFERENCES[name]
    return _known(robots(rows, name), value)


REFERENCE_GRAPHS = listed(
    "reference", "small graphs with known optima, weights and unequal robots among them", [partial(_reference, name) for name in REFERENCES]
)


WHOLE_REFERENCES = listed(
    "reference, whole actions", "the same, undivided",
    [partial(lambda name: Case(BottleneckSATA(robots(REFERENCES[name][0], name).graph)), name) for name in REFERENCES],
)  # fmt: skip


def tight_pair(h: int) -> BottleneckSATA:
    """The smallest unit graph on which the bound of h = 1 (ratio 2) or h = 2 (ratio 3/2) is attained."""
    if h == 1:
        return robots([[[0, 1], [0]]], "tight-h1")
    return robots([[[1]], [[0], [1]]], "tight-h2")


TIGHT = listed(
    "tight", "the bound is attained: ratio 2 at h = 1, 3/2 at h = 2", [partial(lambda h: _known(tight_pair(h), 1.0), h) for h in (1, 2)]
)
"""The two smallest graphs that attain the bound; the first one, continued, has 1 - 1/(2h) (S8)."""


def private_targets(n: int) -> BottleneckSATA:
    """One robot of n actions, each with a target of its own: 1/n for shares, 0 for whole actions."""
    return robots([[[j] for j in range(n)]], f"private-{n}")


PRIVATE = listed(
    "private-targets",
    "one robot of n actions with a target each: 1/n of shares, 0 of whole actions",
    [partial(lambda n: _known(private_targets(n), 1 / n, [1 / n] * n), n) for n in range(1, 9)],
)
"""The integrality gap 1/n, which the local algorithm meets exactly."""


def cycle(n: int) -> BottleneckSATA:
    """Robot i is at target i or at target i + 1 of a cycle of n."""
    return robots([[[i], [(i + 1) % n]] for i in range(n)], f"cycle-{n}")


CYCLES = listed(
    "cycle",
    "robot i sees target i or i + 1 of a cycle",
    [partial(lambda n: _known(cycle(n), 1.0, [1.0, 0.0] * n), n) for n in (2, 3, 4, 5, 8, 20, 40)],
)
"""Optimum 1, which is found for every h."""


def regular_tree(m: int, depth: int) -> BottleneckSATA:
    """A tree in which every target is seen by m actions and every robot joins two targets, except at the leaves.

    Robots of the targets at ``depth`` have one action. For depth much beyond h the inner robots see no end of the tree and divide
    themselves equally: value m/2, where the optimum tends to m - 1; no local algorithm does better.

    Source: Floréen et al. (2011), the lower bound Delta_R (1 - 1/Delta_T) for local algorithms.
    """
    rows: list[list[Sees]] = []
    level, targets = [(0, m)], 1  # targets of a level, with the actions that they still need
    for _ in range(depth):
        below = []
        for target, free in level:
            for _ in range(free):
                rows.append([[target], [targets]])
                below.append((targets, m - 1))
                targets += 1
        level = below
    rows += [[[target]] for target, free in level for _ in range(free)]
    return robots(rows, f"tree-{m}-{depth}")


def _regular_tree(m: int, depth: int) -> Case:
    problem = regular_tree(m, depth)
    return _known(problem, problem.graph.num_robots / problem.graph.num_targets)


REGULAR_TREES = listed(
    "regular-tree",
    "trees on which no local algorithm beats 2 (1 - 1/m)",
    [
        partial(_regular_tree, m, depth)
        for m, depths in ((2, (3, 8)), (3, (1, 2, 3, 4, 5)), (4, (2, 3, 4)), (5, (2, 3)))
        for depth in depths
    ],
)
"""Optimum robots/targets, local values of m/2 near the root."""
