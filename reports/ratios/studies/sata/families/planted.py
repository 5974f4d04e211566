"""Random selection problems with a good answer planted in them, and decoys that each look a little better when greed meets them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ......formulations.sata.submodular_selection import SubmodularSelection
from ......formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from ......instances.sata.constraints import Cardinality, Constraint, Knapsack, PartitionMatroid
from ......instances.sata.sensing_graph import graph_of_edges
from ......instances.sata.set_functions import Coverage
from ....families import Family
from ....judging import Case

Rng = np.random.Generator
Floats = NDArray[np.float64]

LURE = 1.01
"""Weight of a decoy, against the best that is left when it is met."""


def _decoy(rng: Rng, weights: Floats, wanted: float, free: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Random items out of ``free`` that weigh ``wanted`` or just more; all of them if they weigh less."""
    order = rng.permutation(np.nonzero(free)[0])
    enough = int(np.searchsorted(np.cumsum(weights[order]), wanted)) + 1
    return np.asarray(order[:enough])


def _item_weights(rng: Rng, size: int) -> Floats:
    return np.ones(size) if rng.random() < 0.5 else rng.uniform(0.5, 1.5, size)


def planted_cover(rng: Rng, k: int, name: str, constraint: str) -> SubmodularSelection:
    """k sets that share all items out among them, and k decoys, each made of what the decoys before it left."""
    block = int(rng.integers(3, 8))
    weights = _item_weights(rng, k * block)
    good = np.arange(k * block).reshape(k, block)
    free, decoys = np.ones(k * block, dtype=bool), []
    for _ in range(k):
        left = np.where(free, weights, 0.0)[good].sum(axis=1).max()
        decoys.append(_decoy(rng, weights, LURE * left, free))
        free[decoys[-1]] = False
    sets = [*decoys, *good]
    order = rng.permutation(len(sets))
    f = Coverage.from_sets([sets[i] for i in order], weights)
    rule: Constraint = Cardinality(k)
    if constraint == "partition":
        rule = PartitionMatroid.of(np.zeros(2 * k), k)
    elif constraint == "knapsack":
        costs = np.where(order < k, 1.0, rng.uniform(0.8, 1.0, 2 * k))  # a decoy costs a little more
        rule = Knapsack(costs, float(costs[order >= k].sum()) + 1e-9)
    return SubmodularSelection(f, rule, name=name)


def planted_assignment(rng: Rng, robots: int, name: str) -> WinnerTakesAllSATA:
    """Each robot has an action for targets of its own, and one that takes as much, and a little more, from the others."""
    block = int(rng.integers(1, 5))
    weights = _item_weights(rng, robots * block)
    own = np.arange(robots * block).reshape(robots, block)
    free, sees = np.ones(robots * block, dtype=bool), []
    for robot in rng.permutation(robots).tolist():
        others = free.copy()
        others[own[robot]] = False
        left = weights[own[robot]][free[own[robot]]].sum()
        decoy = _decoy(rng, weights, LURE * left, others)
        free[decoy] = False
        sees.append((robot, own[robot], 1.0))
        sees.append((robot, decoy, LURE))
    owner = [robot for robot, _, _ in sees]
    action = np.repeat(np.arange(len(sees)), [len(targets) for _, targets, _ in sees])
    target = np.concatenate([targets for _, targets, _ in sees])
    weight = weights[target] * np.repeat([lure for _, _, lure in sees], [len(targets) for _, targets, _ in sees])
    return WinnerTakesAllSATA(graph_of_edges(owner, action, target, weight, robots=robots, targets=robots * block, name=name))


def planted_covers(constraint: str) -> Family:
    """``planted_cover`` with 2 to 6 sets to choose."""

    def make(k: int, rng: Rng) -> Case:
        return Case(planted_cover(rng, int(rng.integers(2, 7)), f"planted-cover-{k}", constraint))

    return Family("planted-cover", "a partition of the items, and decoys that greed prefers", make)


def planted_assignments() -> Family:
    """``planted_assignment`` with 2 to 7 robots."""

    def make(k: int, rng: Rng) -> Case:
        return Case(planted_assignment(rng, int(rng.integers(2, 8)), f"planted-assignment-{k}"))

    return Family("planted-assignment", "robots that do better apart, and actions that take from the others", make)
