"""Small selection problems for tests: reference cases, random ones, and their optima by plain enumeration."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator

import numpy as np

from waybound.formulations.evidence import Evidence
from waybound.formulations.problem import Problem
from waybound.formulations.selection.submodular_selection import SubmodularSelection, UserFunction
from waybound.formulations.stop import NEVER
from waybound.heuristics.heuristic import HEURISTICS, Outcome, Setting
from waybound.instances.selection.instance import (
    Cardinality,
    Constraint,
    Coverage,
    DenseFacilityLocation,
    FacilityLocation,
    Knapsack,
    PartitionMatroid,
    SetFunction,
)
from waybound.solvers.linear_programs import LinearPrograms

KINDS = ("coverage", "facility-location", "dense", "dense32", "user")
CONSTRAINTS = ("cardinality", "partition", "knapsack")


def setting(seed: int = 1, seconds: float = 60.0) -> Setting:
    """What a heuristic gets when nobody listens to it and no solver is at hand."""
    return Setting(np.random.default_rng(seed), seconds, None, lambda a: None, NEVER, LinearPrograms())


def run(name: str, problem: Problem, seed: int = 1, **options: object) -> Outcome:
    """A heuristic by name; its answer must pass the problem's check."""
    outcome = HEURISTICS[name].run(problem, setting(seed), **options)
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


def random_function(rng: np.random.Generator, kind: str, n: int, *, whole: bool = False) -> SetFunction | UserFunction:
    """Whole weights make ties; others make sums that round."""
    items = int(rng.integers(1, 10))
    weights = rng.integers(0, 4, (n, items)).astype(float) if whole else rng.uniform(0, 3, (n, items)) * (rng.random((n, items)) < 0.5)
    if kind.startswith("dense"):
        return DenseFacilityLocation(weights.astype(np.float32 if kind == "dense32" else np.float64))
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
    costs = rng.uniform(0.1, 2, n) * (rng.random(n) < 0.9)
    return Knapsack(costs, float(rng.uniform(0, costs.sum() + 0.5)))


def random_problem(rng: np.random.Generator, function: str, constraint: str, most: int = 8, *, whole: bool = False) -> SubmodularSelection:
    n = int(rng.integers(1, most + 1))
    return SubmodularSelection(random_function(rng, function, n, whole=whole), random_constraint(rng, constraint, n))


def feasible_sets(problem: SubmodularSelection) -> Iterator[tuple[int, ...]]:
    """All of them, judged by counting and adding up."""
    c, n = problem.constraint, problem.num_elements
    for size in range(min(n, c.limit if isinstance(c, Cardinality) else n) + 1):
        for chosen in itertools.combinations(range(n), size):
            if isinstance(c, Cardinality):
                fits = True
            elif isinstance(c, Knapsack):
                fits = sum(float(c.costs[e]) for e in chosen) <= c.budget
            else:
                fits = all(sum(int(c.groups[e]) == g for e in chosen) <= limit for g, limit in enumerate(c.limits.tolist()))
            if fits:
                yield chosen


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
