"""The share of the optimum that greedy is proved to reach: promised, certified for free, and certified with one linear program.

Weighted coverage, random, under a cardinality limit and under a partition matroid with one element a group. "Marginal gains" is the bound
that comes with every answer (``solve(..., bound_time=0)``); "linear program" is what ``bound_time`` finds beside it. Both are derived again
by the checker, which needs no solver. Exit code 1 if a ratio stays below its target.
"""

from collections.abc import Sequence
from typing import Annotated

import numpy as np

import waybound as wb
from waybound.solving.request import Request
from waybound.solving.solve import solve

from ._harness import Option, command, met

CASES = ((1000, 100, 2000, 20), (1000, 100, 1000, 10), (10000, 100, 2000, 20), (2000, 40, 400, 12))
"""Elements, picks (and groups), items, items an element."""

FREE, WITH_LP = 0.67, 0.81
"""Targets for each of them."""


def random_coverage(rng: np.random.Generator, elements: int, items: int, each: int) -> wb.Coverage:
    """Each element covers ``each`` items drawn with replacement; weights of items are uniform in [0.5, 2]."""
    covered = np.sort(rng.integers(0, items, (elements, each)), axis=1)
    first = np.ones(covered.shape, dtype=bool)
    first[:, 1:] = covered[:, 1:] != covered[:, :-1]
    starts = np.concatenate([[0], np.cumsum(first.sum(axis=1))]).astype(np.int32)
    return wb.Coverage(starts, covered[first].astype(np.int32), rng.uniform(0.5, 2.0, items))


def generate(elements: int, picks: int, items: int, each: int, constraint: str, seed: int = 1) -> wb.SubmodularSelection:
    rng = np.random.default_rng(seed)
    function = random_coverage(rng, elements, items, each)
    rule = wb.Cardinality(picks) if constraint == "cardinality" else wb.PartitionMatroid.of(np.arange(elements) % picks)
    return wb.SubmodularSelection(function, rule, name=f"{elements} elements, {items} items")


def report(cases: Sequence[tuple[int, int, int, int]], seconds: float) -> tuple[str, bool]:
    """Solve and bound, and say what came out and whether the targets are met."""
    heading = f"{'elements':>8} {'picks':>5} {'items':>5}  {'constraint':12} {'greedy':>9}  {'promised':>8}"
    lines = [f"{heading} | {'marginal gains':>14} {'ratio':>6} | {'linear program':>14} {'ratio':>6} {'seconds':>8}"]
    good = True
    for case in cases:
        for constraint in ("cardinality", "partition"):
            problem = generate(*case, constraint)
            free = solve(problem, Request(heuristic="greedy", bound_time=0))
            bounded = solve(problem, Request(heuristic="greedy", bound_time=seconds))
            assert isinstance(free.objective, float) and isinstance(free.bound, float) and isinstance(bounded.bound, float)
            assert free.certificate.guarantee is not None
            promised, ratios = 1 / free.certificate.guarantee.ratio, (free.objective / free.bound, free.objective / bounded.bound)
            good &= ratios[0] >= FREE and ratios[1] >= WITH_LP
            lines.append(
                f"{case[0]:>8} {case[1]:>5} {case[2]:>5}  {constraint:12} {free.objective:>9.2f}  {promised:>8.3f} | {free.bound:>14.2f} "
                f"{ratios[0]:>6.3f} | {bounded.bound:>14.2f} {ratios[1]:>6.3f} {bounded.seconds['bound']:>8.1f}"
            )
    lines.append(f"targets: {FREE} for free, {WITH_LP} with the linear program: {met(good)}")
    return "\n".join(lines), good


@command
def main(seconds: Annotated[float, Option(help="budget for bounding an answer")] = 60.0) -> tuple[str, bool]:
    return report(CASES, seconds)
