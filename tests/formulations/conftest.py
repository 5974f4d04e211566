"""Small random problems, and the optimum of each."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from truth.routing import best_values

from waybound import Energy, Objective, RoutingProblem, Sites, TotalCost, Vehicles, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

CHARGES = ("travel", "elapsed", "elapsed-fixed-start", "windows")


def make_problem(seed: int, *, customers: int | None = None, plain: bool = False) -> RoutingProblem:
    """A random problem: asymmetric or Euclidean, with or without windows, loads, limits, energy, several depots and types."""
    rng = np.random.default_rng(seed)
    chance = lambda p: bool(rng.random() < p) and not plain  # noqa: E731
    m = customers or int(rng.integers(1, 6))
    depots = 2 if chance(0.25) else 1
    n = m + depots
    order = rng.permutation(n)
    depot = np.zeros(n, dtype=bool)
    depot[order[:depots]] = True
    xy = rng.integers(0, 12, (n, 2)).astype(float)
    convention = str(rng.choice(["exact", "trunc1", "round"]))
    if chance(0.4):
        matrix = rng.integers(1, 15, (n, n)).astype(float)  # asymmetric, without the triangle inequality
        durations = rng.integers(0, 10, (n, n)).astype(float) if chance(0.5) else None
        travel = Travel(EXPLICIT, matrix=matrix, duration_matrix=durations)
    else:
        travel = Travel("euclidean", coordinates=xy, convention=convention)
    ready, due = np.zeros(n), np.full(n, math.inf)
    if chance(0.6):
        ready = rng.integers(0, 20, n).astype(float)
        due = ready + rng.integers(2, 30, n)
        ready[depot], due[depot] = rng.integers(0, 3, depots), rng.integers(40, 80, depots)
    service = rng.integers(0, 4, n).astype(float) if chance(0.5) else np.zeros(n)
    sites = Sites.of([f"s{k}" for k in range(n)], depot=depot, demand=rng.integers(0, 6, n), ready=ready, due=due, service=service)
    fleet = []
    for kind in range(2 if chance(0.25) else 1):
        places = order[:depots]
        energy = Energy(float(rng.integers(15, 60)), float(rng.choice([0.5, 1.0, 2.0])), str(rng.choice(CHARGES))) if chance(0.3) else None
        fleet.append(
            VehicleType(
                count=None if rng.random() < 0.3 else int(rng.integers(1, 4)),
                capacity=float(rng.integers(5, 16)) if rng.random() < 0.7 else math.inf,
                start=int(rng.choice(places)),
                end=int(rng.choice(places)),
                max_duration=float(rng.integers(20, 60)) if chance(0.3) else math.inf,
                max_distance=float(rng.integers(20, 60)) if chance(0.3) else math.inf,
                energy=energy,
                fixed_cost=float(rng.integers(0, 9)) if chance(0.3) else 0.0,
                unit_cost=float(rng.choice([0.5, 2.0, 1.3])) if chance(0.3) else 1.0,
                name=f"kind{kind}",
            )
        )
    objective = [Objective.of(TotalCost()), Objective.of(TotalCost() + 7.0 * Vehicles()), Vehicles().then(TotalCost())][
        int(rng.integers(0, 3)) if chance(0.3) else 0
    ]
    limits = [v.count for v in fleet]
    most = m if None in limits else min(m, sum(c or 0 for c in limits))
    return RoutingProblem(sites, travel, tuple(fleet), objective, int(rng.integers(1, most + 1)) if chance(0.2) else 0)


def least_value(problem: RoutingProblem) -> float:
    """Least value of the first level; infinite if there is no answer."""
    found = best_values(problem)
    return math.inf if found is None else found[0]


@pytest.fixture(scope="session")
def random_problem() -> Callable[..., RoutingProblem]:
    return make_problem


@pytest.fixture(scope="session")
def optimum() -> Callable[[RoutingProblem], float]:
    return least_value


def climb(bound: Callable[[np.ndarray], float], size: int, rng: np.random.Generator, steps: int) -> list[float]:
    """Bounds at points that a random ascent visits: multipliers near the best ones are where a wrong bound shows."""
    point, seen, step = np.zeros(size), [], 4.0
    best = bound(point)
    seen.append(best)
    for _ in range(steps):
        trial = point + step * rng.normal(size=size) * (rng.random(size) < 0.4)
        value = bound(trial)
        seen.append(value)
        if value > best:
            point, best = trial, value
        else:
            step = max(0.05, step * 0.97)
    return seen


@pytest.fixture(scope="session")
def ascent() -> Callable[..., list[float]]:
    return climb
