"""Ratios of Christofides, iterated tour partitioning, optimal split and tour splitting, and of heuristics that state none."""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np

from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import Configuration
from .families import routing as families


def metric(problem: Any) -> bool:
    """Whether the triangle inequality holds."""
    d = problem.travel.distances
    return bool((d[:, :, None] + d[None] >= d[:, None] * (1 - 1e-12)).all())


Ratio = float | tuple[float, float]


def _where_metric(ratio: float, problem: Any) -> Ratio:
    """The ratio itself; any larger one where the triangle inequality fails, as the instance asks for."""
    return ratio if metric(problem) else (ratio, math.inf)


def tour_ratio(of_tour: float) -> Callable[[Any], Ratio]:
    """The ratio that the tour states."""
    return lambda problem: _where_metric(of_tour, problem)


def partition_ratio(of_tour: float) -> Callable[[Any], Ratio]:
    """1 + (1 - 1/Q) a for demands of 1, 2 + (1 - 2/Q) a for positive whole ones and an even Q, 2 + a for others.

    Source: Haimovich and Rinnooy Kan (1985); Altinkemer and Gavish (1987, 1990).
    """

    def ratio(problem: Any) -> float:
        demand, capacity = problem.sites.demand[problem.customers], problem.fleet[0].capacity
        if demand.sum() <= capacity:
            return of_tour
        if np.ptp(demand) == 0:
            return 1.0 + (1.0 - 1.0 / int(capacity / demand[0])) * of_tour
        if any(value % 1 or value == 0 for value in demand):
            return 2.0 + of_tour
        whole = int(Fraction(capacity) / math.gcd(*(int(value) for value in demand)))
        return float(2.0 + (1.0 - 2.0 / (whole if whole % 2 == 0 else 2 * whole)) * of_tour)

    return lambda problem: _where_metric(ratio(problem), problem)


def splitting_ratio(of_tour: float) -> Callable[[Any], Ratio]:
    """a + 1 - 1/k for k vehicles (Frederickson, Hecht and Kim 1978)."""
    return lambda problem: _where_metric(of_tour + 1.0 - 1.0 / min(len(problem.customers), problem.vehicle_limit), problem)


def _ways(heuristic: str, ratio: Callable[[float], Callable[[Any], Ratio]]) -> list[Configuration]:
    return [
        Configuration("christofides", heuristic, ratio(1.5), {"improve": False}),
        Configuration("christofides, improved", heuristic, ratio(1.5)),
        Configuration("double tree", heuristic, ratio(2.0), {"tour": "double-tree", "improve": False}),
    ]


guarantee_study(
    "christofides", "tree and matching, stated 3/2", 1000,
    [
        Configuration("as built", "christofides", tour_ratio(1.5), {"improve": False}),
        Configuration("improved", "christofides", tour_ratio(1.5)),
    ],
    (*families.random_families("salesman"), families.strips()),
)  # fmt: skip
LOADS = (*families.random_families("loads"), *families.load_traps())
guarantee_study(
    "tour-partitioning", "a tour cut after each full vehicle, stated 5/2 - 3/(2Q) and 7/2 - 3/Q", 1000,
    _ways("tour-partitioning", partition_ratio), LOADS,
)  # fmt: skip
guarantee_study("split", "a tour cut in the best way, stated as tour-partitioning", 1000, _ways("split", partition_ratio), LOADS)
guarantee_study(
    "tour-splitting", "a tour cut evenly among k vehicles, stated 5/2 - 1/k", 1000, _ways("tour-splitting", splitting_ratio),
    (*families.random_families("shared"), *families.share_traps()),
)  # fmt: skip


def _none(problem: Any) -> None:
    """No ratio is known."""


REWARDS = (*families.random_families("rewarded"), *families.reward_traps())
SHARED = (*families.random_families("shared"), *families.share_traps(), *families.nearest_traps())
guarantee_study("savings", "routes joined at their ends, no ratio stated", 1000, [Configuration("savings", "savings", _none)], LOADS)
guarantee_study("insertion", "one customer after the other, no ratio stated", 1000, [Configuration("I1", "insertion", _none)], LOADS)
guarantee_study(
    "greedy-assignment", "the first to be free takes the nearest, no ratio stated", 1000,
    [Configuration("nearest", "greedy-assignment", _none), Configuration("largest reward", "pure-greedy", _none)], SHARED,
)  # fmt: skip
guarantee_study(
    "greedy-orienteering", "the largest reward, or for its distance, no ratio stated", 1000,
    [
        Configuration("density or reward", "greedy-orienteering", _none),
        Configuration("density", "greedy-orienteering", _none, {"by": "density"}),
        Configuration("reward", "greedy-orienteering", _none, {"by": "reward"}),
        Configuration("nearest", "greedy-assignment", _none),
        Configuration("largest reward", "pure-greedy", _none),
    ],
    REWARDS,
)  # fmt: skip
guarantee_study(
    "safety-margins", "uncertain durations with a margin, no ratio stated", 1000, [Configuration("PyVRP", "safety-margins", _none)],
    families.random_families("risky"),
)  # fmt: skip
