import itertools
from typing import Any

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from small_routing import small
from truth.routing import best_values, routes

from waybound import InputError, RoutingProblem
from waybound.formulations.routing.checking import enumerated_routes
from waybound.formulations.routing.checking.enumerated_routes import check_enumerated_routes

FEATURES = ("capacity", "time-windows", "service-times", "max-distance", "limited-fleet", "fixed-cost", "open-routes")


def drawn_case(problem: RoutingProblem, rng: np.random.Generator, scale: float) -> dict[str, Any]:
    customers, case = problem.customers, dict[str, Any]()
    if rng.random() < 0.8:
        case["visits"] = (rng.uniform(-0.2, 1.0, len(problem.sites)) * scale).tolist()
    if rng.random() < 0.6:
        size = int(rng.integers(3, len(customers) + 1))
        sites, weights = rng.choice(customers, size, replace=False).tolist(), rng.integers(1, 4, size).tolist()
        case["rows"] = [{"sites": sites, "weights": weights, "parts": int(rng.integers(2, 5)), "price": -scale * float(rng.random())}]
    if rng.random() < 0.6:
        sites = rng.choice(customers, int(rng.integers(1, len(customers) + 1)), replace=False).tolist()
        case["loads"] = [{"sites": sites, "price": scale * float(rng.random())}]
    return case


def drawn_tree(problem: RoutingProblem, rng: np.random.Generator, scale: float, depth: int = 0) -> list[dict[str, Any]]:
    case = drawn_case(problem, rng, scale)
    if depth == 3 or rng.random() < 0.4:
        return [case]
    case["branch"] = rng.choice(problem.customers, 2, replace=False).tolist()
    return [case, *drawn_tree(problem, rng, scale, depth + 1), *drawn_tree(problem, rng, scale, depth + 1)]


def prices_of(problem: RoutingProblem, rng: np.random.Generator, scale: float) -> dict[str, Any]:
    customers = problem.customers
    sites, near = rng.choice(customers, 3, replace=False).tolist(), rng.choice(customers, 2, replace=False).tolist()
    return {
        "visits": (rng.uniform(-0.2, 1.0, len(problem.sites)) * scale).tolist(),
        "memory": int(rng.integers(0, 5)),
        "rows": [{"sites": sites, "memory": sorted({*sites, *near}), "price": -scale * float(rng.random())}],
        "loads": [{"sites": near, "price": scale * float(rng.random())}],
    }


@settings(max_examples=draws(300), deadline=None)
@given(
    feature=st.sampled_from(FEATURES),
    seed=st.integers(0, 10**6),
    scale=st.sampled_from([0.3, 1.0, 3.0]),
    high=st.sampled_from([0.9, 1.0, 1.2]),
)
def test_no_tree_however_wrong_proves_more_than_the_optimum(feature: str, seed: int, scale: float, high: float) -> None:
    problem, rng = small(feature, seed, "exact"), np.random.default_rng(seed)
    best = best_values(problem)
    if best is None:
        return
    share = scale * best[0] / len(problem.customers)
    for _ in range(3):
        data = {"goal": high * best[0], "prices": prices_of(problem, rng, share), "nodes": drawn_tree(problem, rng, share)}
        assert check_enumerated_routes(problem, data) <= best[0] * (1.0 + 1e-9)


@pytest.mark.parametrize("feature", FEATURES)
@pytest.mark.parametrize("seed", range(3))
def test_it_lists_each_set_of_customers_with_its_cheapest_route(feature: str, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, listed = small(feature, seed, "exact"), list[Any]()
    if best_values(problem) is None:
        return

    def listed_routes(walks: Any, limit: int) -> Any:
        listed.append((walks.exponent, original(walks, limit)))
        return listed[-1][1]

    original = enumerated_routes.listed_routes
    monkeypatch.setattr(enumerated_routes, "listed_routes", listed_routes)
    nothing = {"visits": [0.0] * len(problem.sites), "memory": 0}
    check_enumerated_routes(problem, {"goal": 1e6, "prices": nothing, "nodes": [{}]})
    (exponent, (sets, cost)), vehicle, customers = listed[0], problem.fleet[0], problem.customers.tolist()
    truth = dict[frozenset[int], float]()
    for visits in routes(problem, vehicle):
        stops = [vehicle.start, *visits, vehicle.end]
        length = vehicle.fixed_cost + vehicle.unit_cost * sum(problem.travel.distances[i, j] for i, j in itertools.pairwise(stops))
        truth[frozenset(visits)] = min(length, truth.get(frozenset(visits), np.inf))
    found = {
        frozenset(np.array(customers)[having].tolist()): value * 2.0**-exponent for having, value in zip(sets.T, cost.tolist(), strict=True)
    }
    assert found == pytest.approx(truth)


def test_without_prices_a_tree_proves_what_stands_above_it_and_without_routes_the_goal() -> None:
    problem = small("capacity", 1, "exact")
    nothing = {"visits": [0.0] * len(problem.sites), "memory": 0}
    assert check_enumerated_routes(problem, {"goal": 1e6, "prices": nothing, "nodes": [{}]}) <= best_values(problem)[0]
    assert check_enumerated_routes(problem, {"goal": 1.0, "prices": nothing, "nodes": [{}]}) == pytest.approx(1.0)


def test_beyond_its_limits_nothing_is_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = small("capacity", 1, "exact")
    data = {"goal": 1e6, "prices": {"visits": [0.0] * len(problem.sites), "memory": 0}, "nodes": [{}]}
    for name in ("LABELS", "ROUTES", "WORK"):
        with monkeypatch.context() as patch:
            patch.setattr(enumerated_routes, name, 3)
            assert check_enumerated_routes(problem, data) == -np.inf


PRICES = {"visits": [0.0] * 6, "memory": 0}


@pytest.mark.parametrize(
    "data",
    [
        {"prices": PRICES, "nodes": [{}]},
        {"goal": 1.0, "prices": {**PRICES, "ray": True}, "nodes": [{}]},
        {"goal": 1.0, "prices": {**PRICES, "needed": []}, "nodes": [{}]},
        {"goal": 1.0, "prices": PRICES},
        {"goal": 1.0, "prices": PRICES, "nodes": []},
        {"goal": 1.0, "prices": PRICES, "nodes": [{}, {}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"branch": [1, 2]}, {}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"branch": [1]}, {}, {}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"branch": [0, 1]}, {}, {}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"sites": []}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"rows": [{"sites": [1, 2, 3], "price": 1.0}]}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"rows": [{"sites": [1, 2, 3], "weights": [1, 1], "price": -1.0}]}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"rows": [{"sites": [1, 2, 3], "parts": 1, "price": -1.0}]}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"rows": [{"sites": [1, 2, 3], "weights": [1, 1, 0], "price": -1.0}]}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"loads": [{"sites": [1], "price": -1.0}]}]},
        {"goal": 1.0, "prices": PRICES, "nodes": [{"loads": [{"sites": [], "price": 1.0}]}]},
    ],
)
def test_what_is_malformed_is_refused(data: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        check_enumerated_routes(small("capacity", 1, "exact"), data)
