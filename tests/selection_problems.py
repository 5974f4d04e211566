"""Small selection problems for tests: reference cases, random ones, and their optima by plain enumeration."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from truth.families import excess_of

from waybound import Coverage, DenseFacilityLocation, Evidence, Problem, SubmodularSelection
from waybound.formulations.stop import NEVER
from waybound.heuristics.heuristic import HEURISTICS, Context, Outcome
from waybound.instances.sata.constraints import Cardinality, Constraint, Knapsack, LimitRows, LinearConstraint, PartitionMatroid
from waybound.instances.sata.set_functions import FacilityLocation, ItemFunction, ItemWeights, SetFunction, UserFunction
from waybound.solvers.linear_programs import LinearPrograms

KINDS = ("coverage", "facility-location", "dense", "dense32", "user")
CONSTRAINTS = ("cardinality", "partition", "knapsack")
OWN_KINDS = ("own-items", "own-values")
OWN_CONSTRAINTS = ("own-rows", "own-oracle")
"""Classes of the tests' own, of which no module knows."""


@dataclass(frozen=True, eq=False)
class Weights(ItemFunction):
    """The largest weight for each item, from a table that is stored by item."""

    name: ClassVar[str] = "weights"
    kind: ClassVar[str] = "weights"
    table: NDArray[np.float64]

    @property
    def num_elements(self) -> int:
        return self.table.shape[1]

    def as_item_weights(self) -> ItemWeights:
        return ItemWeights.dense(np.ascontiguousarray(self.table.T))

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.table)


@dataclass(frozen=True, eq=False)
class Roots(SetFunction):
    """Roots of sums."""

    name: ClassVar[str] = "roots"
    worth: NDArray[np.float64]
    monotone = True
    submodular = True

    @property
    def num_elements(self) -> int:
        return len(self.worth)

    def values(self, masks: NDArray[np.bool_]) -> NDArray[np.float64]:
        return np.asarray(np.sqrt(masks @ self.worth).sum(axis=1))

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.worth)


@dataclass(frozen=True, eq=False)
class Budgets(LinearConstraint):
    """Several budgets at once."""

    name: ClassVar[str] = "budgets"
    costs: NDArray[np.float64]
    limits: NDArray[np.float64]

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.costs, self.limits)

    def rows(self, elements: int) -> LimitRows:
        row, element = np.nonzero(self.costs)
        return LimitRows("budget", row, element, self.costs[row, element], self.limits, lambda k: f"no. {k + 1}")


@dataclass(frozen=True, eq=False)
class Apart(Constraint):
    """No two elements that are neighbours on a ring."""

    name: ClassVar[str] = "apart"
    kind: ClassVar[str] = "apart"

    def parts(self) -> tuple[Any, ...]:
        return (self.name,)

    def allows(self, masks: NDArray[np.bool_]) -> NDArray[np.bool_]:
        return ~(masks & np.roll(masks, 1, axis=1)).any(axis=1) if masks.shape[1] > 1 else np.ones(len(masks), dtype=bool)


def context(seed: int = 1, seconds: float = 60.0) -> Context:
    """What a heuristic gets when nobody listens to it and no solver is at hand."""
    return Context(np.random.default_rng(seed), seconds, None, lambda a: None, NEVER, LinearPrograms())


def run(name: str, problem: Problem, seed: int = 1, **options: object) -> Outcome:
    """A heuristic by name; its answer must pass the problem's check."""
    outcome = HEURISTICS[name].run(problem, context(seed), **options)
    judged = problem.evaluate(outcome.answer)
    assert judged.feasible, judged.violations
    return outcome


def value(problem: Problem, outcome: Outcome) -> float:
    return problem.evaluate(outcome.answer).values[0]


def only_evidence(outcome: Outcome) -> Evidence:
    (found,) = outcome.evidence
    return found


# -- reference cases ---------------------------------------------------------------------------------------------------


def cover_tight() -> SubmodularSelection:
    """Greedy 62, optimum 80, at most 2 sets."""
    items = ["a1", "b1", "c1", "a2", "b2", "c2", "g", "h"]
    weights = [20, 10, 10, 20, 10, 10, 1, 1]
    sets = [("a1", "b1", "c1"), ("a2", "b2", "c2"), ("a1", "a2", "g"), ("b1", "b2", "h")]
    return SubmodularSelection(Coverage.from_sets([[items.index(i) for i in s] for s in sets], weights), Cardinality(2))


def cover_30_sets() -> list[set[int]]:
    return [{(7 * i + j * j * (1 + i % 3)) % 61 for j in range(8)} for i in range(30)]


def weight_of_cover_30(sets: list[int]) -> int:
    """Value of some sets of ``cover_30``, from its definition."""
    covered = set().union(*(cover_30_sets()[s] for s in sets)) if sets else set()
    return sum(1 + (e * e) % 5 for e in covered)


def cover_30(k: int) -> SubmodularSelection:
    return SubmodularSelection(Coverage.from_sets(cover_30_sets(), [1 + (e * e) % 5 for e in range(61)]), Cardinality(k))


def half_tight(copies: int = 1, excess: float = 0.01) -> SubmodularSelection:
    """Pairs of groups on which greedy reaches (1 + excess) / (2 + excess), its bound of 1/2."""
    sets, groups, weights = [], [], []
    for k in range(copies):
        sets += [[2 * k], [2 * k + 1], [2 * k]]
        groups += [2 * k, 2 * k, 2 * k + 1]
        weights += [1.0 + excess, 1.0]
    return SubmodularSelection(Coverage.from_sets(sets, weights), PartitionMatroid.of(groups))


# -- random problems ---------------------------------------------------------------------------------------------------


def random_function(rng: np.random.Generator, kind: str, n: int, *, whole: bool = False) -> SetFunction:
    """Whole weights make ties; others make sums that round."""
    items = int(rng.integers(1, 10))
    weights = rng.integers(0, 4, (n, items)).astype(float) if whole else rng.uniform(0, 3, (n, items)) * (rng.random((n, items)) < 0.5)
    if kind.startswith("dense"):
        return DenseFacilityLocation(weights.astype(np.float32 if kind == "dense32" else np.float64))
    if kind == "own-items":
        return Weights(np.ascontiguousarray(weights.T))
    if kind == "own-values":
        return Roots(weights)
    if kind == "user":
        concave = (lambda sums: np.minimum(sums, 4.0)) if whole else np.sqrt  # roots of whole numbers would round
        return UserFunction(lambda masks: concave(masks @ weights).sum(axis=1), n, monotone=True, submodular=True, label="concave of sums")
    starts = np.concatenate([[0], np.cumsum((weights > 0).sum(axis=1))]).astype(np.int32)
    indices = np.nonzero(weights)[1].astype(np.int32)
    if kind == "coverage":
        return Coverage(starts, indices, rng.integers(0, 4, items).astype(float) if whole else rng.uniform(0, 3, items))
    return FacilityLocation(starts, indices, weights[weights > 0], items)


def random_constraint(rng: np.random.Generator, kind: str, n: int) -> Constraint:
    if kind == "cardinality":
        return Cardinality(int(rng.integers(1, n + 2)))
    if kind == "partition":
        groups = rng.integers(0, int(rng.integers(1, n + 1)), n)
        return PartitionMatroid.of(groups, rng.integers(0, 3, int(groups.max()) + 1))
    if kind == "own-oracle":
        return Apart()
    if kind == "own-rows":
        table = rng.uniform(0.1, 2, (int(rng.integers(1, 4)), n)) * (rng.random(n) < 0.9)
        return Budgets(table, table.sum(axis=1) * rng.uniform(0, 1.1, len(table)))
    costs = rng.uniform(0.1, 2, n) * (rng.random(n) < 0.9)
    return Knapsack(costs, float(rng.uniform(0, costs.sum() + 0.5)))


def random_problem(rng: np.random.Generator, function: str, constraint: str, most: int = 8, *, whole: bool = False) -> SubmodularSelection:
    n = int(rng.integers(1, most + 1))
    return SubmodularSelection(random_function(rng, function, n, whole=whole), random_constraint(rng, constraint, n))


def feasible_sets(problem: SubmodularSelection) -> Iterator[tuple[int, ...]]:
    """All of them, the small ones first, judged by counting and adding up in exact arithmetic; with a set every subset is one."""
    level: list[tuple[int, ...]] = [()]
    while level:
        yield from level
        larger = ((*chosen, e) for chosen in level for e in range(chosen[-1] + 1 if chosen else 0, problem.num_elements))
        level = [chosen for chosen in larger if excess_of(problem, chosen) == 0]


def optimum(problem: SubmodularSelection) -> float:
    return max(problem.value(s) for s in feasible_sets(problem))


def greedy_by_hand(f: Callable[[list[int]], float], n: int, k: int, *, lazy: bool) -> tuple[list[int], int]:
    """Picks and evaluations of plain greedy, and of the accelerated one as its source words it: by falling old gain, until one is below
    the best new gain."""
    picks: list[int] = []
    old = dict.fromkeys(range(n), math.inf)
    evaluations = 0
    for _ in range(k):
        base, best, chosen = f(picks), -math.inf, -1
        for e in sorted(old, key=lambda e: (-old[e], e)):
            if lazy and old[e] < best:
                break
            evaluations += 1
            old[e] = f([*picks, e]) - base
            if old[e] > best or (old[e] == best and e < chosen):
                best, chosen = old[e], e
        picks.append(chosen)
        del old[chosen]
    return picks, evaluations
