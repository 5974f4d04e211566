"""Random selection problems: each kind of function under each of the three constraints, sensing graphs, and good answers among decoys."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .....formulations.sata.submodular_selection import SubmodularSelection
from .....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from .....instances.sata.constraints import Cardinality, Constraint, Knapsack, PartitionMatroid
from .....instances.sata.sensing_graph import SensingGraph, graph_of_edges
from .....instances.sata.set_functions import Coverage, DenseFacilityLocation, FacilityLocation, Floats, SetFunction, UserFunction
from ....ratios.families import Family
from ....ratios.judged_runs import Case

Rng = np.random.Generator

RandomFunction = Callable[[Rng, int], SetFunction]
RandomConstraint = Callable[[Rng, int], Constraint]


# -- set functions ----------------------------------------------------------------------------------------------------


def coverage(rng: Rng, n: int) -> Coverage:
    """Coverage of items that count alike; sets overlap much or little."""
    items = int(rng.integers(3, 16))
    return Coverage.from_sets([np.nonzero(row)[0] for row in rng.random((n, items)) < rng.uniform(0.1, 0.6)], np.ones(items))


def weighted_coverage(rng: Rng, n: int) -> Coverage:
    """Coverage of items of whole, uniform or widely spread weights."""
    items = int(rng.integers(3, 16))
    weights = weights_of(rng, items)
    return Coverage.from_sets([np.nonzero(row)[0] for row in rng.random((n, items)) < rng.uniform(0.1, 0.6)], weights)


def facility_location(rng: Rng, n: int) -> FacilityLocation | DenseFacilityLocation:
    """Facility location, sparse or dense."""
    items = int(rng.integers(2, 13))
    matrix = weights_of(rng, n * items).reshape(n, items)
    if rng.random() < 0.3:
        return DenseFacilityLocation(matrix)
    matrix *= rng.random((n, items)) < rng.uniform(0.2, 0.9)
    starts = np.concatenate([[0], np.cumsum((matrix > 0).sum(axis=1))]).astype(np.int32)
    element, item = np.nonzero(matrix)
    return FacilityLocation(starts, item.astype(np.int32), matrix[element, item], items)


@dataclass(frozen=True)
class ConcaveOfSums:
    """``f(S) = sum_j (sum over e in S of a_ej) ** power``, 0 < power <= 1: monotone and submodular."""

    worth: Floats
    power: float

    def __call__(self, masks: NDArray[np.bool_]) -> Floats:
        return np.asarray(((masks.astype(np.float64) @ self.worth) ** self.power).sum(axis=1))


@dataclass(frozen=True)
class ProbableCoverage:
    """``f(S) = sum_j w_j (1 - product over e in S of (1 - p_ej))``: items that are covered with a probability."""

    missed: Floats
    weights: Floats

    def __call__(self, masks: NDArray[np.bool_]) -> Floats:
        # Logarithms turn the product over a set into one matrix product; certain coverage stays finite.
        logs = np.log(np.maximum(self.missed, 1e-300))
        return np.asarray((1.0 - np.exp(masks.astype(np.float64) @ logs)) @ self.weights)


def user_function(rng: Rng, n: int) -> UserFunction:
    """A function that is given as a program: concave of sums, or coverage by chance."""
    items = int(rng.integers(1, 7))
    if rng.random() < 0.5:
        worth = rng.random((n, items)) * (rng.random((n, items)) < 0.7)
        f: Callable[[NDArray[np.bool_]], Floats] = ConcaveOfSums(worth, float(rng.uniform(0.2, 1.0)))
        label = "concave of sums"
    else:
        f = ProbableCoverage(1.0 - rng.random((n, items)) * (rng.random((n, items)) < 0.7), weights_of(rng, items))
        label = "coverage by chance"
    return UserFunction(f, n, monotone=True, submodular=True, label=label)


FUNCTIONS: dict[str, RandomFunction] = {
    "coverage": coverage,
    "weighted-coverage": weighted_coverage,
    "facility-location": facility_location,
    "user-function": user_function,
}


def weights_of(rng: Rng, size: int) -> Floats:
    """Weights >= 0: small whole numbers (ties, zeros), uniform ones, or some a hundred times as large as others."""
    kind = int(rng.integers(3))
    if kind == 0:
        return rng.integers(0, 6, size).astype(np.float64)
    return rng.random(size) if kind == 1 else rng.lognormal(0.0, 1.5, size)


# -- constraints ------------------------------------------------------------------------------------------------------


def cardinality(rng: Rng, n: int) -> Cardinality:
    """A number of elements, from one to nearly all."""
    return Cardinality(int(rng.integers(1, n)))


def partition(rng: Rng, n: int) -> PartitionMatroid:
    """Groups of unequal sizes, mostly with one element each to choose."""
    groups = rng.integers(0, int(rng.integers(1, max(2, n // 2) + 1)), n)
    groups = np.unique(groups, return_inverse=True)[1]
    limits = np.where(rng.random(int(groups.max()) + 1) < 0.7, 1, rng.integers(1, 4, int(groups.max()) + 1))
    return PartitionMatroid.of(groups, limits)


def knapsack(rng: Rng, n: int) -> Knapsack:
    """Whole, uniform or widely spread costs; some elements may cost nothing, or more than the budget."""
    costs = weights_of(rng, n)
    return Knapsack(costs, float(costs.sum() * rng.uniform(0.05, 0.8)))


CONSTRAINTS: dict[str, RandomConstraint] = {"cardinality": cardinality, "partition": partition, "knapsack": knapsack}


def random_families(constraint: str, largest: int = 12) -> tuple[Family, ...]:
    """One family for each kind of set function, with ``constraint`` and ground sets of 4 to ``largest`` elements."""

    def family(kind: str) -> Family:
        def make(k: int, rng: Rng) -> Case:
            n = int(rng.integers(4, largest + 1))
            chosen = CONSTRAINTS[constraint](rng, n)
            return Case(SubmodularSelection(FUNCTIONS[kind](rng, n), chosen, name=f"{kind}-{constraint}-{k}"))

        return Family(f"{kind}", f"random {kind.replace('-', ' ')}, 4 to {largest} elements", make)

    return tuple(family(kind) for kind in FUNCTIONS)


# -- robots and targets -----------------------------------------------------------------------------------------------


def random_graph(rng: Rng, k: int, *, robots: int = 5, actions: int = 4, targets: int = 10, most: int = 14) -> SensingGraph:
    """Robots of 1 to ``actions`` actions, ``most`` in all; an action may see nothing, a target may be seen by nobody."""
    owner: list[int] = []
    for robot in range(int(rng.integers(1, robots + 1))):
        owner += [robot] * min(int(rng.integers(1, actions + 1)), most - len(owner))
    count = int(rng.integers(1, targets + 1))
    sees = rng.random((len(owner), count)) < rng.uniform(0.1, 0.7)
    action, target = np.nonzero(sees)
    weight = weights_of(rng, len(action)) + (rng.random() < 0.5)
    return graph_of_edges(owner, action, target, weight, robots=max(owner) + 1, targets=count, name=f"graph-{k}")


RANDOM_ASSIGNMENTS = Family(
    "sensing-graphs",
    "winner takes all, up to 5 robots of up to 4 actions",
    lambda k, rng: Case(WinnerTakesAllSATA(random_graph(rng, k))),
)


# -- good answers planted among decoys that each look a little better when greed meets them ---------------------------

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
        open_weight = np.where(free, weights, 0.0)[good].sum(axis=1).max()
        decoys.append(_decoy(rng, weights, LURE * open_weight, free))
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
        open_weight = weights[own[robot]][free[own[robot]]].sum()
        decoy = _decoy(rng, weights, LURE * open_weight, others)
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


PLANTED_ASSIGNMENTS = Family(
    "planted-assignment",
    "robots that do better apart, and actions that take from the others",
    lambda k, rng: Case(planted_assignment(rng, int(rng.integers(2, 8)), f"planted-assignment-{k}")),
)
"""``planted_assignment`` with 2 to 7 robots."""
