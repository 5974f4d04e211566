import itertools
import math

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from truth.routing import best_values

from waybound import Routes, RoutingProblem, Sites, Travel, VehicleType
from waybound.heuristics.routing.tour_steps.splitting_kernels import best_split, cheapest_cut, even_split, linear_split
from waybound.instances.routing.travel import EXPLICIT

GO, HALT = np.zeros(1, np.int64), np.ones(1, np.int64)


def parts(last: np.ndarray) -> list[list[int]]:
    ends = [0, *(np.nonzero(last)[0] + 1).tolist()]
    return [list(range(a, b)) for a, b in itertools.pairwise(ends)]


def cost(costs: np.ndarray, part: list[int]) -> float:
    return float(costs[0, part[0]] + costs[1, part[:-1]].sum() + costs[2, part[-1]])


def ways(n: int) -> list[np.ndarray]:
    return [np.array([*cut, True]) for cut in itertools.product([False, True], repeat=n - 1)]


@settings(max_examples=draws(150), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 7), st.integers(1, 4))
def test_an_even_split_has_the_shortest_longest_route(seed: int, n: int, most: int) -> None:
    costs = np.random.default_rng(seed).integers(0, 20, (3, n)).astype(float)
    last = even_split(GO, costs, most)
    longest = [max(cost(costs, p) for p in parts(way)) for way in ways(n) if way.sum() <= most]
    assert last.sum() <= most and max(cost(costs, p) for p in parts(last)) == min(longest)


@settings(max_examples=draws(150), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 8), st.integers(2, 12), st.integers(0, 3))
def test_a_cut_is_the_cheapest_of_all_offsets(seed: int, n: int, segment: int, most: int) -> None:
    rng = np.random.default_rng(seed)
    costs, demand = rng.integers(0, 20, (3, n)).astype(float), rng.integers(0, segment + 1, n).astype(float)
    last = cheapest_cut(GO, demand, segment, 2.0 * segment, most, costs)
    until = np.r_[0, np.cumsum(demand)]

    def way(offset: int) -> np.ndarray:
        cuts = np.arange(offset, until[-1] + 1, segment)
        ends = [bool(((until[k] < cuts) & (cuts <= until[k + 1])).any()) for k in range(n)]
        return np.array([*ends[:-1], True])

    offsets = [way(k) for k in range(segment)]
    ranks = [(max(len(parts(w)) - most, 0), sum(cost(costs, p) for p in parts(w))) for w in offsets]
    assert (max(len(parts(last)) - most, 0), sum(cost(costs, p) for p in parts(last))) == min(ranks)


def timed(rng: np.random.Generator, n: int) -> RoutingProblem:
    matrix, times = rng.integers(0, 20, (n + 1, n + 1)), rng.integers(0, 20, (n + 1, n + 1))
    ready = rng.integers(0, 40, n + 1) * (rng.random(n + 1) < 0.5)
    due = ready + np.where(rng.random(n + 1) < 0.6, rng.integers(0, 60, n + 1), math.inf)
    sites = Sites.of(range(n + 1), demand=np.r_[0, rng.integers(0, 9, n)], ready=ready, due=due, service=rng.integers(0, 5, n + 1))
    limit = lambda most: float(rng.integers(1, most)) if rng.random() < 0.5 else math.inf  # noqa: E731
    vehicle = VehicleType(capacity=limit(30), max_duration=limit(120), max_distance=limit(80), fixed_cost=3.0, unit_cost=2.0)
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix, duration_matrix=times), (vehicle,))


@settings(max_examples=draws(200), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(1, 6))
def test_a_best_split_costs_least_of_all_that_keep_the_limits(seed: int, n: int, most: int) -> None:
    problem = timed(np.random.default_rng(seed), n)
    sites, v, d, t = problem.sites, problem.fleet[0], problem.travel.distances, problem.travel.durations
    rows = lambda m: np.stack([m[0, 1:], np.r_[np.diag(m, 1)[1:], 0.0], m[1:, 0]])  # noqa: E731
    limits = (float(sites.ready[0]), float(sites.due[0]), v.max_duration, v.max_distance)
    data = [values[1:] for values in (sites.demand, sites.service, sites.ready, sites.due)]
    last, broken, total = best_split(GO, *data, rows(d), rows(t), v.capacity, limits, v.unit_cost, v.fixed_cost, most)
    judged = [problem.evaluate(Routes.of([[k + 1 for k in p] for p in parts(w)])) for w in ways(n) if w.sum() <= most]
    values = [j.values[0] for j in judged if j.feasible]
    if values:
        found = problem.evaluate(Routes.of([[k + 1 for k in p] for p in parts(last)]))
        assert found.feasible and broken == 0
        assert found.values[0] == min(values) == total
    else:
        assert not last.any() or broken > 0
    best = best_values(problem)
    assert not values or (best is not None and min(values) >= best[0])


def test_asked_to_stop_they_end() -> None:
    n = 2_000
    rows, ones, zeros, free = np.ones((3, n)), np.ones(n), np.zeros(n), np.full(n, math.inf)
    limits = (0.0, math.inf, math.inf, math.inf)
    assert not best_split(HALT, ones, zeros, zeros, free, rows, rows, math.inf, limits, 1.0, 0.0, n)[0].any()
    assert not even_split(HALT, rows, 10).any()
    assert cheapest_cut(HALT, ones, 50.0, 50.0, n, rows).sum() <= n / 50 + 1


@settings(max_examples=draws(200), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 30), st.integers(1, 30))
def test_where_only_loads_limit_routes_the_linear_split_finds_the_same(seed: int, n: int, most: int) -> None:
    rng = np.random.default_rng(seed)
    costs, demand = rng.integers(0, 20, (3, n)).astype(float), rng.integers(0, 9, n).astype(float)
    capacity = float(rng.choice([5, 8, 20, math.inf]))  # of 5 some customers are too large
    none, ever = np.zeros(n), np.full(n, math.inf)
    limits = (0.0, math.inf, math.inf, math.inf)
    last, broken, value = linear_split(GO, demand, costs, capacity, 2.0, 3.0, most)
    expected = best_split(GO, demand, none, none, ever, costs, costs, capacity, limits, 2.0, 3.0, most)
    assert (broken, value) == (expected[1], pytest.approx(expected[2], rel=1e-9, abs=1e-9))
    assert last.any() == expected[0].any() and (not last.any() or last.sum() <= most)
    if last.any():
        assert sum(2.0 * cost(costs, p) + 3.0 for p in parts(last)) == pytest.approx(value, rel=1e-9)


def test_the_linear_split_ends_when_it_is_asked_to() -> None:
    assert not linear_split(HALT, np.ones(3), np.ones((3, 3)), 2.0, 1.0, 0.0, 3)[0].any()
