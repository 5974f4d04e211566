"""The local algorithm by its definition, in exact arithmetic, and instances for it.

Written from the definition of the layered program alone: trees are sets of nodes, minima run over roots, nothing is shared between
levels or layers. Slow, and meant to be: it is what the compiled versions are measured against.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property

import numpy as np

from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges

Robots = Sequence[Sequence[Mapping[int, float | Fraction]]]
"""For each robot its actions, for each action the weights of the targets it sees."""

Node = tuple[str, int, int]


def graph_of(robots: Robots, targets: int | None = None) -> SensingGraph:
    """The robots as a sensing graph; actions are numbered robot after robot."""
    owner, action, target, weight = [], [], [], []
    for i, actions in enumerate(robots):
        for sees in actions:
            for k, c in sees.items():
                action.append(len(owner))
                target.append(k)
                weight.append(float(c))
            owner.append(i)
    return graph_of_edges(owner, action, target, weight, robots=len(robots), targets=targets)


def robots_of(graph: SensingGraph) -> list[list[dict[int, Fraction]]]:
    """Inverse of ``graph_of``, weights exact. Actions must be numbered robot after robot."""
    robots: list[list[dict[int, Fraction]]] = [[] for _ in range(graph.num_robots)]
    for v in range(graph.num_actions):
        edges = range(graph.indptr[v], graph.indptr[v + 1])
        robots[graph.robot_of_action[v]].append({int(graph.indices[e]): Fraction(float(graph.weights[e])) for e in edges})
    return robots


class ExactLocal:
    """The layered program of height h over a cleaned instance.

    Parameters
    ----------
    robots : Robots
        Weights that are floats are taken for the fractions that they are.
    h : int
    """

    def __init__(self, robots: Robots, h: int) -> None:
        self.h = h
        self.sees: list[dict[int, Fraction]] = []
        self.number: list[int] = []  # of each action among all, those that see nothing included
        self.mates: list[list[int]] = []
        place = 0
        for actions in robots:
            live = []
            for sees in actions:
                exact = {k: Fraction(c) for k, c in sees.items() if c}
                if exact:
                    live.append(len(self.sees))
                    self.sees.append(exact)
                    self.number.append(place)
                place += 1
            self.mates += [live for _ in live]
        self.all_actions = place
        self.size = len(self.sees)
        self.cap = [Fraction(2, len(self.mates[v])) for v in range(self.size)]
        self.part = [[w for w in self.mates[v] if w != v] or [v] for v in range(self.size)]
        self.viewers: dict[int, list[int]] = {}
        for v, sees in enumerate(self.sees):
            for k in sees:
                self.viewers.setdefault(k, []).append(v)
        self.delta_r = max(2, max((len(m) for m in self.mates), default=0))
        self.delta_t = max(2, max((len(v) for v in self.viewers.values()), default=0))

    def weight(self, k: int, v: int) -> Fraction:
        """Halved where v is the only viewer."""
        return self.sees[v][k] / (2 if len(self.viewers[k]) == 1 else 1)

    def others(self, k: int, v: int) -> list[int]:
        return [w for w in self.viewers[k] if w != v] or [v]

    @cached_property
    def trees(self) -> list[set[Node]]:
        """Nodes below each root R(v, 0)."""
        trees = []
        for root in range(self.size):
            tree, stack = set(), [("R", root, 0)]
            while stack:
                node = stack.pop()
                if node in tree:
                    continue
                tree.add(node)
                colour, v, layer = node
                if colour == "R":
                    stack += [("B", w, layer) for w in self.part[v]]
                elif layer < self.h:
                    stack += [("R", u, layer + 1) for k in self.sees[v] for u in self.others(k, v)]
            trees.append(tree)
        return trees

    def recursion(self, level: Callable[[int, int], Fraction]) -> dict[Node, Fraction]:
        """All copies, with the level ``level(v, layer)`` at each blue one."""
        z: dict[Node, Fraction] = {}
        for layer in range(self.h, -1, -1):
            for v in range(self.size):
                value = Fraction(0)
                if layer < self.h:
                    for k in self.sees[v]:
                        below = sum(self.weight(k, w) * z["R", w, layer + 1] for w in self.others(k, v))
                        value = max(value, (level(v, layer) - below) / self.weight(k, v))
                z["B", v, layer] = value
            for v in range(self.size):
                z["R", v, layer] = self.cap[v] - max(z["B", w, layer] for w in self.part[v])
        return z

    def tangents(self, level: Fraction) -> dict[Node, tuple[Fraction, Fraction]]:
        """All copies at one level, each with a slope of its own to the right of it."""
        z: dict[Node, tuple[Fraction, Fraction]] = {}
        for layer in range(self.h, -1, -1):
            for v in range(self.size):
                best = (Fraction(0), Fraction(0))
                if layer < self.h:
                    for k in self.sees[v]:
                        c, others = self.weight(k, v), self.others(k, v)
                        value = (level - sum(self.weight(k, w) * z["R", w, layer + 1][0] for w in others)) / c
                        slope = (1 - sum(self.weight(k, w) * z["R", w, layer + 1][1] for w in others)) / c
                        best = max(best, (value, slope))
                z["B", v, layer] = best
            for v in range(self.size):
                value, slope = max(z["B", w, layer] for w in self.part[v])
                z["R", v, layer] = (self.cap[v] - value, -slope)
        return z

    @cached_property
    def ceilings(self) -> list[Fraction]:
        """Per root the least value of a target's copy in its tree with all variables at their caps."""
        full = {k: sum(self.sees[v][k] * self.cap[v] for v in viewers) for k, viewers in self.viewers.items()}
        return [min(full[k] for c, v, layer in tree if c == "B" and layer < self.h for k in self.sees[v]) for tree in self.trees]

    def valid(self, root: int, z: Mapping[Node, Fraction]) -> bool:
        return all(z[node] >= 0 for node in self.trees[root] if node[0] == "R")

    def largest_levels(self) -> list[Fraction]:
        """The largest valid level of each root: reds are concave and piecewise linear, so Newton from the ceiling ends there."""
        levels = []
        for root in range(self.size):
            level = self.ceilings[root]
            while True:
                z = self.tangents(level)
                negative = [z[node] for node in self.trees[root] if node[0] == "R" and z[node][0] < 0]
                if not negative:
                    break
                level = min(level - value / slope for value, slope in negative)
            levels.append(level)
        return levels

    def stepped_levels(self, step: Fraction) -> list[Fraction]:
        """The first valid one of U, U - step, U - 2 step, ..., not below U/2."""
        levels = []
        for root in range(self.size):
            ceiling = level = self.ceilings[root]
            while level > ceiling / 2 and not self.valid(root, self.recursion(lambda v, layer, q=level: q)):
                level -= step
            levels.append(max(level, ceiling / 2))
        return levels

    def secant_levels(self, eps: float) -> list[Fraction]:
        """Between the last valid and the first invalid of the levels 2^(j/m), m the least with 2^(1/m) <= 1 + eps, the least root of a
        red copy's secant, which is the last valid level where the copy falls below -1024 caps at once."""
        levels, m = [], 1
        while 2.0 ** (1 / m) > 1 + eps:
            m += 1
        for root in range(self.size):
            j = math.floor(math.log2(self.ceilings[root] / 2) * m) - 1
            q = Fraction(2.0 ** (j / m))
            here = self.recursion(lambda v, layer, q=q: q)
            while True:
                q, p = Fraction(2.0 ** (j / m)), Fraction(2.0 ** ((j + 1) / m))
                there = self.recursion(lambda v, layer, p=p: p)
                if not self.valid(root, there):
                    break
                here, j = there, j + 1
            reds = [n for n in self.trees[root] if n[0] == "R" and there[n] < 0]
            levels.append(min(q if there[n] < -1024 * self.cap[n[1]] else q + (p - q) * here[n] / (here[n] - there[n]) for n in reds))
        return levels

    def smoothed(self, levels: Sequence[Fraction]) -> Callable[[int, int], Fraction]:
        """For each blue copy the least level over the roots above it."""
        least: dict[Node, Fraction] = {}
        for root, tree in enumerate(self.trees):
            for node in tree:
                if node[0] == "B":
                    least[node] = min(least.get(node, levels[root]), levels[root])
        return lambda v, layer: least["B", v, layer]

    def copies(self, levels: Sequence[Fraction]) -> dict[Node, Fraction]:
        """The layered solution for the levels of the roots."""
        return self.recursion(self.smoothed(levels))

    def shares(self, levels: Sequence[Fraction]) -> list[Fraction]:
        """Averages over all copies; one a cleaned action."""
        z = self.copies(levels)
        both = [sum((z["R", v, layer] + z["B", v, layer] for layer in range(self.h + 1)), Fraction(0)) for v in range(self.size)]
        return [total / (2 * (self.h + 1)) for total in both]

    def value(self, shares: Sequence[Fraction]) -> Fraction:
        """The least coverage of a target that somebody sees."""
        return min(sum((self.sees[v][k] * shares[v] for v in viewers), Fraction(0)) for k, viewers in self.viewers.items())

    def spread(self, values: Sequence[Fraction]) -> np.ndarray:
        """The values as floats over all actions, 0 for those that see nothing."""
        whole = np.zeros(self.all_actions)
        whole[self.number] = [float(x) for x in values]
        return whole


# -- instances -----------------------------------------------------------------------------------------------------------

FIGURE_33: Robots = [[{1: 1}, {2: 1}], [{2: 1, 3: 1}, {3: 1}], [{3: 1}, {1: 1}]]
"""Figure 3.3 of Sung (2019), case S1 of docs/formulations/sensing.md."""


def random_graph(rng: np.random.Generator, *, most_robots: int = 8, most_actions: int = 4, weights: str = "any") -> SensingGraph:
    """A small graph with idle actions, targets of one viewer, and robots of one action among others; every target is seen.

    ``weights``: unit, real, whole, spread (log-normal of deviation 1.5), or any of these; or decades (1e-4 to 1e4).
    """
    num_robots, num_targets = int(rng.integers(1, most_robots + 1)), int(rng.integers(1, most_robots + 2))
    owner = np.repeat(np.arange(num_robots), rng.integers(1, most_actions + 1, num_robots))
    pairs = {(int(rng.integers(len(owner))), k) for k in range(num_targets)}
    for _ in range(int(rng.integers(0, 2 * len(owner) + 1))):
        pairs.add((int(rng.integers(len(owner))), int(rng.integers(num_targets))))
    action, target = np.array(sorted(pairs)).T
    kind = str(rng.choice(["unit", "real", "whole", "spread"])) if weights == "any" else weights
    draws = {
        "unit": np.ones(len(action)),
        "real": rng.uniform(0.5, 1.5, len(action)),
        "whole": rng.integers(1, 6, len(action)).astype(float),
        "spread": np.exp(rng.normal(0.0, 1.5, len(action))),
        "decades": 10.0 ** rng.uniform(-4.0, 4.0, len(action)),
    }
    return graph_of_edges(owner, action, target, draws[kind], robots=num_robots, targets=num_targets)


def regular_tree(m: int, depth: int) -> SensingGraph:
    """Every target has m viewers, robots of two actions join a target to one a level lower, and leaves get m - 1 robots of one action."""
    robots: list[list[dict[int, float]]] = []
    level, targets = [0], 1
    for number in range(depth):
        lower = []
        for k in level:
            for _ in range(m if number == 0 else m - 1):
                robots.append([{k: 1.0}, {targets: 1.0}])
                lower.append(targets)
                targets += 1
        level = lower
    robots += [[{k: 1.0}] for k in level for _ in range(m - 1)]
    return graph_of(robots, targets)


def cycle(size: int) -> SensingGraph:
    """Robot i may see target i or the next one."""
    return graph_of([[{i: 1.0}, {(i + 1) % size: 1.0}] for i in range(size)], size)


def hops(graph: SensingGraph, robot: int) -> np.ndarray:
    """Distance of each robot from one of them; a hop joins robots that see a common target. Unreachable ones are far."""
    distance = np.full(graph.num_robots, 10**6)
    distance[robot] = 0
    front, near = {robot}, 0
    owner = graph.robot_of_action[graph.action_of_edge]
    while front:
        targets = np.unique(graph.indices[np.isin(owner, list(front))])
        reached = np.unique(owner[np.isin(graph.indices, targets)])
        near += 1
        front = {int(i) for i in reached if distance[i] == 10**6}
        distance[list(front)] = near
    return distance
