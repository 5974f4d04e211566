import itertools
import math
from typing import Any

import numpy as np
import pytest

from waybound.heuristics.routing.insertion_steps import insertion_kernels as kernels

Case = tuple[tuple[Any, ...], float, tuple[float, ...], bool]


def case(seed: int, kind: str) -> Case:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 9))
    xy = rng.integers(0, 12, (n + 2, 2)).astype(float)
    distance = np.hypot(*(xy[:, None] - xy[None]).T).T
    if seed % 2:
        distance = distance * rng.uniform(0.8, 1.2, distance.shape)
    time = np.ceil(distance * rng.uniform(0.5, 1.5)) if kind == "durations" else distance
    service = np.r_[0, rng.integers(0, 3, n), 0].astype(float)
    ready, due = np.zeros(n + 2), np.full(n + 2, math.inf)
    if kind == "windows":
        ready[1:-1] = rng.integers(0, 40, n)
        due[1:-1] = ready[1:-1] + rng.integers(1, 40, n)
    demand = np.r_[0, rng.integers(0, 5, n), 0].astype(float)
    limits = (0.0, float(rng.choice([math.inf, 90.0])) if kind == "windows" else math.inf, *rng.choice([math.inf, 50.0, 70.0], 2).tolist())
    return (demand, service, ready, due, distance, time), float(rng.choice([math.inf, 15.0])), limits, kind == "windows"


def may_be_driven(route: list[int], given: Case) -> bool:
    (demand, service, ready, due, distance, time), capacity, (opening, closing, max_duration, max_distance), _ = given
    stops = [0, *route, len(demand) - 1]
    moves = list(itertools.pairwise(stops))
    if demand[route].sum() > capacity or sum(distance[m] for m in moves) > max_distance * (1 + 1e-12):
        return False
    clock, slack, waited = opening, closing - opening, 0.0
    for i, j in moves:
        reached = clock + service[i] + time[i, j]
        latest = closing if j == stops[-1] else due[j]
        clock = max(reached, ready[j])
        if clock > latest * (1 + 1e-12):
            return False
        waited += clock - reached
        slack = min(slack, waited + latest - clock)
    return bool(clock - opening - min(waited, slack) <= max_duration * (1 + 1e-12))


def one_by_one(given: Case, reward: Any, fleet: int, density: bool) -> list[list[int]]:
    (demand, _, _, _, d, _), _, _, _ = given
    end, routes = len(demand) - 1, [list[int]() for _ in range(fleet)]
    left = set(range(1, end))
    while True:
        found: list[tuple[float, float, int, int, int]] = []
        for r, route in enumerate(routes):
            if r and not routes[r - 1]:
                break
            for u in left:
                for k in range(len(route) + 1):
                    i, j = route[k - 1] if k else 0, route[k] if k < len(route) else end
                    extra = float(d[i, u] + d[u, j] - (d[i, j] if route else 0.0))
                    if may_be_driven([*route[:k], u, *route[k:]], given):
                        worth = reward[u] if not density else reward[u] / extra if extra > 0 else math.inf if reward[u] else 0.0
                        found.append((-worth, extra, u, r, k))
        if not found:
            return routes
        _, _, u, r, k = min(found)
        routes[r].insert(k, u)
        left.remove(u)


@pytest.mark.parametrize("density", [False, True])
@pytest.mark.parametrize("kind", ["distance", "durations", "windows"])
def test_every_customer_goes_where_it_adds_least(kind: str, density: bool) -> None:
    flag, visits = np.zeros(1, np.int64), 0
    for seed in range(30):
        given = case(seed, kind)
        data, capacity, limits, timed = given
        fleet, reward = 1 + seed % 4, np.r_[0, np.random.default_rng(seed).integers(0, 9, len(data[0]) - 2), 0].astype(float)
        inward, kept = np.ascontiguousarray(data[4].T), kind == "distance"
        route_of, place = kernels.best_insertion(flag, data, inward, reward, fleet, capacity, limits, timed, kept, density)
        routes = [sorted(np.nonzero(route_of == r)[0].tolist(), key=lambda u: int(place[u])) for r in range(fleet)]
        assert routes == one_by_one(given, reward, fleet, density), seed
        visits += sum(map(len, routes))
    assert visits > 60


def test_as_many_routes_as_customers() -> None:
    n = 133
    distance = np.where(np.eye(n + 2, dtype=bool), 0.0, 1.0)
    none, ever = np.zeros(n + 2), np.full(n + 2, math.inf)
    limits = (0.0, math.inf, math.inf, 2.0)
    data, reward = (none, none, none, ever, distance, distance), np.ones(n + 2)
    route_of, _ = kernels.best_insertion(np.zeros(1, np.int64), data, distance, reward, n, math.inf, limits, False, True, True)
    assert sorted(route_of[1:-1].tolist()) == list(range(n))
