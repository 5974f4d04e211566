"""Bounds from prices of visits: never above the optimum, and exactly what the cheapest route leaves, found by trying all of them."""

from __future__ import annotations

import itertools
import math
import threading
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings
from hypothesis import strategies as st
from patience import HANG
from small_routing import small
from truth.routing import best_values, routes

from waybound.formulations.routing.checking import set_partitioning_duals
from waybound.formulations.routing.checking.relaxation import relax
from waybound.formulations.routing.checking.set_partitioning_duals import check_set_partitioning_duals
from waybound.formulations.routing.objective import Makespan
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import Stop, until
from waybound.instances.errors import InputError
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

SEEDS = st.integers(0, 10**6)
ALL = 99


def evidence(prices: Any, memory: int = ALL, **more: Any) -> dict[str, Any]:
    return {"visits": [float(p) for p in prices], "memory": memory, **more}


@settings(max_examples=draws(60), deadline=None)
@given(seed=SEEDS, scale=st.sampled_from([0.1, 1.0, 10.0, 1e3, 1e9]))
def test_no_prices_however_wrong_prove_more_than_the_optimum(random_problem, optimum, seed, scale):
    problem = random_problem(seed, customers=seed % 4 + 1)
    best, rng, n = optimum(problem), np.random.default_rng(seed), len(problem.sites)
    for ray in (False, True):
        for _ in range(6):
            data = evidence(scale * rng.normal(size=n), int(rng.integers(0, n)), ray=ray)
            assert check_set_partitioning_duals(problem, data) <= best + 1e-9 * max(1.0, abs(best))


@settings(max_examples=draws(30), deadline=None)
@given(seed=SEEDS, memory=st.integers(0, 4))
def test_bounds_stay_below_the_optimum_on_the_way_to_the_best_prices(random_problem, optimum, ascent, seed, memory):
    problem = random_problem(seed, customers=seed % 3 + 2)
    best, n = optimum(problem), len(problem.sites)
    seen = ascent(lambda v: check_set_partitioning_duals(problem, evidence(10.0 * v, memory)), n, np.random.default_rng(seed), 120)
    assert max(seen) <= best + 1e-9 * max(1.0, abs(best))


def expected(problem: RoutingProblem, prices: np.ndarray) -> float:
    """The bound, from all routes one by one."""
    vehicle, far = problem.fleet[0], problem.travel.distances
    reduced = []
    for visits in routes(problem, vehicle):
        stops = [vehicle.start, *visits, vehicle.end]
        way = sum(float(far[i, j]) for i, j in itertools.pairwise(stops))
        reduced.append(vehicle.fixed_cost + vehicle.unit_cost * way - float(prices[list(visits)].sum()))
    relaxed = relax(problem)
    assert relaxed is not None
    return float(prices[problem.customers].sum()) + min(k * min(reduced) for k in range(relaxed.fewest, relaxed.most + 1))


@pytest.mark.share(5)
@pytest.mark.parametrize("feature", ["capacity", "time-windows", "service-times", "depot-windows", "max-distance", "limited-fleet",
                                     "fixed-cost", "travel", "open-routes"])  # fmt: skip
@pytest.mark.parametrize("seed", range(6))
def test_where_all_are_remembered_the_bound_is_that_of_the_cheapest_route(feature: str, seed: int) -> None:
    problem, rng = small(feature, seed, "exact"), np.random.default_rng(seed)
    for scale in (5.0, 40.0, 200.0):
        prices = rng.uniform(-0.2, 1.0, len(problem.sites)) * scale
        found = check_set_partitioning_duals(problem, evidence(prices))
        if found == math.inf:  # some site is out of reach
            assert best_values(problem) is None
            continue
        assert found == pytest.approx(expected(problem, prices), rel=1e-9)
        for memory in range(5):
            assert check_set_partitioning_duals(problem, evidence(prices, memory)) <= found + 1e-9 * abs(found)


def circle(n: int, **fleet: Any) -> RoutingProblem:
    """Customers around a depot, a unit of demand each."""
    angle = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    xy = np.vstack([[0.0, 0.0], 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])])
    return RoutingProblem(Sites.of(range(n + 1), demand=[0, *np.ones(n)]), Travel("euclidean", xy), (VehicleType(**fleet),))


@pytest.mark.parametrize("n", [63, 64, 65, 130])
def test_more_customers_than_a_word_has_bits(n: int) -> None:
    # Two visits a route: the cheapest goes to the pair of the largest savings and prices.
    problem, prices = circle(n, capacity=2.0), np.random.default_rng(n).uniform(0.0, 30.0, n + 1)
    far = problem.travel.distances
    pairs = far[0, 1:, None] + far[1:, 1:] + far[1:, 0] - prices[1:, None] - prices[None, 1:] + np.where(np.eye(n), math.inf, 0.0)
    least = min(float(pairs.min()), float((2.0 * far[0, 1:] - prices[1:]).min()))
    bound = prices[1:].sum() + min(k * least for k in (-(-n // 2), n))
    assert check_set_partitioning_duals(problem, evidence(prices)) == pytest.approx(bound, rel=1e-9)


def test_a_walk_that_forgets_earns_the_same_price_again() -> None:
    problem = circle(4, capacity=4.0, count=1)
    prices = [0.0, 100.0, 0.0, 0.0, 0.0]
    forgetful, mindful = (check_set_partitioning_duals(problem, evidence(prices, memory)) for memory in (0, 4))
    # To 1, elsewhere, and to 1 again; against once.
    assert mindful == pytest.approx(100.0 + 2 * 10.0 - 100.0)
    assert forgetful == pytest.approx(100.0 + 2 * 10.0 + 2 * 10.0 * math.sqrt(2.0) - 200.0)


def test_bounds_are_lifted_to_what_costs_can_be() -> None:
    travel = Travel(EXPLICIT, matrix=np.array([[0.0, 2, 4], [2, 0, 4], [4, 4, 0]]))
    problem = RoutingProblem(Sites.of("abc", demand=[0, 1, 1]), travel, (VehicleType(capacity=2.0),))
    assert check_set_partitioning_duals(problem, evidence([0.0, 4.0, 5.5])) == 10.0


def test_a_ray_proves_that_one_vehicle_does_not_suffice() -> None:
    problem = circle(3, capacity=2.0)
    assert check_set_partitioning_duals(problem, evidence([0.0, 1.0, 1.0, 1.0], ray=True)) == -math.inf
    sites = Sites.of(range(4), due=[math.inf, 10.0, 10.0, 10.0])  # too far from one to the next
    short = RoutingProblem(sites, problem.travel, (VehicleType(count=2),))
    assert check_set_partitioning_duals(short, evidence([0.0, 1.0, 1.0, 1.0], ray=True)) == math.inf
    more = replace(short, fleet=(VehicleType(count=3),))
    assert check_set_partitioning_duals(more, evidence([0.0, 1.0, 1.0, 1.0], ray=True)) == -math.inf


def test_a_customer_whom_no_move_reaches_has_no_answer() -> None:
    problem = circle(3, capacity=2.0)
    alone = problem.restricted([({"arc": [a, "2"]}, False) for a in "0123"])
    assert check_set_partitioning_duals(alone, evidence(np.zeros(4))) == math.inf
    apart = problem.restricted([({"routes": 2}, True), *(({"arc": [a, b]}, False) for a in "123" for b in "123" if a != b)])
    assert check_set_partitioning_duals(apart, evidence(np.zeros(4))) == math.inf


def test_other_objectives_and_sites_that_may_be_left_out_are_not_bounded() -> None:
    problem = circle(3, capacity=2.0)
    assert check_set_partitioning_duals(replace(problem, objective=Makespan()), evidence(np.ones(4))) == -math.inf
    sites = replace(problem.sites, required=np.array([False, True, True, False]))
    assert check_set_partitioning_duals(replace(problem, sites=sites), evidence(np.ones(4))) == -math.inf


@pytest.mark.parametrize("name", ["LABELS", "WORK", "CUSTOMERS"])
def test_beyond_its_limits_nothing_is_proved(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = circle(8, capacity=4.0)
    assert math.isfinite(check_set_partitioning_duals(problem, evidence(np.ones(9))))
    monkeypatch.setattr(set_partitioning_duals, name, 7)
    assert check_set_partitioning_duals(problem, evidence(np.ones(9))) == -math.inf


def test_it_gives_up_when_it_is_asked_to() -> None:
    problem, stop = circle(100, capacity=50.0), Stop(HANG)
    clock = threading.Timer(0.3, stop.ask)
    clock.start()
    with until(stop):
        assert check_set_partitioning_duals(problem, evidence(np.full(101, 30.0))) == -math.inf
    assert stop.reached() == "interrupt"
    with until(Stop(0.0)):
        assert check_set_partitioning_duals(circle(5, capacity=2.0), evidence(np.ones(6))) == -math.inf
    assert math.isfinite(check_set_partitioning_duals(circle(5, capacity=2.0), evidence(np.ones(6))))


@pytest.mark.parametrize(
    "data",
    [
        {}, {"visits": [0.0] * 4}, evidence([0.0] * 3), evidence([0.0] * 5), evidence([0.0, math.nan, 0.0, 0.0]),
        evidence([0.0, math.inf, 0.0, 0.0]), evidence([0.0] * 4, -1), evidence([0.0] * 4, True), evidence([0.0] * 4, 2.0),  # type: ignore[arg-type]
        evidence([0.0] * 4, "8"), evidence([0.0] * 4, None), evidence([0.0] * 4, ray=1), {"visits": "0000", "memory": 1},  # type: ignore[arg-type]
        {"visits": {"at": [4], "values": [1.0]}, "memory": 1},
    ],
)  # fmt: skip
def test_what_is_malformed_is_refused(data: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        check_set_partitioning_duals(circle(3), data)


def test_prices_that_overflow_prove_nothing() -> None:
    assert check_set_partitioning_duals(circle(3), evidence([0.0, 1e308, -1e308, 1e308])) == -math.inf
    assert check_set_partitioning_duals(circle(3), evidence([0.0, 1e18, -1e18, 1e18])) <= 0.0


def test_memories_beyond_all_customers_are_all_of_them() -> None:
    problem, prices = circle(6, capacity=4.0), np.full(7, 20.0)
    assert check_set_partitioning_duals(problem, evidence(prices, 5)) == check_set_partitioning_duals(problem, evidence(prices, 10**30))
