import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from truth.routing import best_values

from waybound import Evidence, Routes, RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.routing.checking.one_route import MOST, beyond_one_route
from waybound.formulations.verified_bounds import verified_bound


def drawn(seed: int, customers: int = 5) -> RoutingProblem:
    """Narrow windows, ways that are no distances, so that a way over somebody may be shorter, and two types of vehicle."""
    rng = np.random.default_rng(seed)
    n = customers + 1
    ways = rng.integers(2, 20, (n, n)).astype(float)
    np.fill_diagonal(ways, 0.0)
    ready = np.append(0.0, rng.integers(0, 25, customers)).astype(float)
    due = np.append(60.0, ready[1:] + rng.integers(0, 12, customers))
    service = np.append(0.0, rng.integers(0, 4, customers)).astype(float)
    sites = Sites.of(range(n), ready=ready, due=due, service=service)
    return RoutingProblem(
        sites, Travel("EXPLICIT", matrix=ways), (VehicleType(customers, 100.0), VehicleType(customers, 100.0, max_duration=50.0))
    )


def served(problem: RoutingProblem, members: set[int]) -> bool:
    """Whether the judge finds nobody late on some route that visits all of these."""
    customers = [int(site) for site in problem.customers]
    orders = (order for size in range(len(members), len(customers) + 1) for order in itertools.permutations(customers, size))
    return any(
        next(c for c in problem.evaluate(Routes.of([list(order)])).checks if c.name == "time-windows").passed
        for order in orders if members <= set(order)
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(draws(8)))
def test_what_one_route_serves_is_never_beyond_one(seed: int) -> None:
    problem = drawn(seed)
    groups = [g for size in (2, 3) for g in itertools.combinations(range(1, 6), size)]
    beyond = beyond_one_route(problem, [np.array(g) for g in groups]).tolist()
    assert any(beyond)
    assert not any(told and served(problem, set(g)) for told, g in zip(beyond, groups, strict=True))


@pytest.mark.parametrize("seed", range(draws(8)))
def test_prices_of_any_sets_prove_no_more_than_the_optimum(seed: int) -> None:
    problem = replace(drawn(seed), fleet=(VehicleType(5, 100.0),))
    best, rng = best_values(problem), np.random.default_rng(seed)
    for _ in range(20):
        loads = [
            {"sites": rng.choice(np.arange(1, 6), int(rng.integers(1, 6)), replace=False).tolist(), "price": float(rng.integers(0, 30))}
            for _ in range(3)
        ]
        data = {"visits": [0.0, *rng.integers(-5, 15, 5).astype(float).tolist()], "memory": 5, "loads": loads}
        bound = verified_bound(problem, Evidence("set-partitioning-duals", "planted", 0.0, data))
        assert bound <= (math.inf if best is None else best[0] + 1e-9)


def test_a_set_beyond_one_route_is_worth_two_and_others_are_not() -> None:
    sites = Sites.of(range(3), ready=[0, 10, 10], due=[100, 11, 11])
    at = np.array([[0.0, 0.0], [4.0, 3.0], [4.0, -3.0]])
    problem = RoutingProblem(sites, Travel("euclidean", at), (VehicleType(2, 10.0),))
    data = {"visits": [0.0, 0.0, 0.0], "memory": 2, "loads": [{"sites": [1, 2], "price": 10.0}]}
    evidence = Evidence("set-partitioning-duals", "two routes of 10", 20.0, data)
    assert verified_bound(problem, evidence) == pytest.approx(20.0)
    together = replace(problem, sites=replace(sites, due=np.array([100.0, 11.0, 16.0])))
    assert verified_bound(together, evidence) == pytest.approx(10.0)


def test_large_sets_single_customers_and_vehicles_that_reload_are_not_looked_at() -> None:
    problem = drawn(1, MOST + 1)
    assert beyond_one_route(problem, [np.array([1]), np.arange(1, MOST + 2)]).tolist() == [False, False]
    pair = next(g for g in itertools.combinations(range(1, 6), 2) if beyond_one_route(problem, [np.array(g)])[0])
    reloading = replace(problem, fleet=(replace(problem.fleet[0], reloads=(0,)),))
    assert not beyond_one_route(reloading, [np.array(pair)])[0]
