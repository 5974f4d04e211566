"""Routes through each set of customers bound every problem of the family; the truth is another enumeration's."""

import math
from dataclasses import replace

import numpy as np
import pytest
from city_corners import CITY, CORNERS, DEMAND, STREETS
from small_routing import WHOLE_FAMILY, excludes, few, small, varied
from truth.routing import best_values

import waybound as wb
from waybound import Energy, Group, InputError, RoutingProblem, Shipment, Sites, VehicleType
from waybound.formulations.routing.checking import customer_sets
from waybound.formulations.routing.checking.customer_sets import check_customer_sets
from waybound.formulations.routing.objective import LongestRoute, Makespan, Penalties, Reward, TotalCost, Weighted
from waybound.formulations.stop import Stop, until
from waybound.instances.routing.travel import EXPLICIT, Travel

EXACT = (
    "capacity", "max-distance", "travel", "limited-fleet", "heterogeneous-fleet", "fixed-cost", "multiple-depots", "open-routes",
    "vehicles", "prizes", "reward", "reward-then-cost",
)  # fmt: skip
"""Of which one level at most is limited beside what counts, so that nothing is lost by looking at one at a time."""


def beyond(problem: RoutingProblem, bound: float, best: float) -> float:
    """By how much a bound is beyond the optimum, which it must never be, in parts of it."""
    return (bound - best if problem.sense == "min" else best - bound) / max(1.0, abs(best))


@pytest.mark.share(2)
@pytest.mark.parametrize("feature", EXACT)
def test_the_optimum_of_simple_problems_is_proved(feature: str) -> None:
    for seed in range(4):
        problem = small(feature, seed, "exact")
        best, bound = best_values(problem), check_customer_sets(problem, {})
        if best is None:
            assert bound == (math.inf if problem.sense == "min" else -math.inf)
        else:
            assert -1e-9 <= beyond(problem, bound, float(best[0])) <= 1e-12


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_feature_of_the_family_is_bounded_beyond_the_optimum(feature: str) -> None:
    for seed in range(8):
        problem = varied(feature, seed, few(feature))
        assert not excludes(problem, check_customer_sets(problem, {}), 1e-12, 1e-12)


def weighed(problem: RoutingProblem, term, weight: float) -> RoutingProblem:
    return RoutingProblem(problem.sites, problem.travel, problem.fleet, TotalCost() + weight * term)


@pytest.mark.share(3)
@pytest.mark.parametrize("term", [LongestRoute(), Makespan()])
@pytest.mark.parametrize("feature", ["limited-fleet", "multiple-depots", "service-times"])
def test_any_limits_divide_answers_by_their_largest_route(feature: str, term) -> None:
    met = 0
    for seed in range(4):
        problem = weighed(small(feature, seed, "exact"), term, 5.0)
        best = best_values(problem)
        if best is None:
            continue
        rng = np.random.default_rng(seed)
        for count in (0, 1, 5, 40):
            limits = sorted(rng.uniform(0, 300, count).tolist())
            bound = check_customer_sets(problem, {term.name: limits})
            assert beyond(problem, bound, float(best[0])) <= 1e-12
        met += bound > check_customer_sets(problem, {}) * (1 + 1e-9)
    assert met


def test_pickups_come_before_deliveries_and_groups_exclude() -> None:
    line = np.abs(np.subtract.outer([0.0, 1.0, 5.0, -4.0], [0.0, 1.0, 5.0, -4.0]))
    travel = Travel(EXPLICIT, matrix=line)
    two = (VehicleType(2),)
    paired = RoutingProblem(Sites.of("oabc", shipments=[Shipment(2, 3, (1.0,)), Shipment(3, 1, (1.0,))]), travel, two)
    assert check_customer_sets(paired, {}) == pytest.approx(20.0) == pytest.approx(float(best_values(paired)[0]))  # type: ignore[index]
    grouped = RoutingProblem(Sites.of("oabc", groups=[Group((1, 3), True)], required=[False, False, True, False]), travel, two)
    assert check_customer_sets(grouped, {}) == pytest.approx(10.0) == pytest.approx(float(best_values(grouped)[0]))  # type: ignore[index]


def test_vehicles_reload_between_trips() -> None:
    line = np.abs(np.subtract.outer([0.0, 6.0, 1.0, 5.0, 7.0], [0.0, 6.0, 1.0, 5.0, 7.0]))
    sites = Sites.of("opabc", demand=[0, 0, 2, 2, 2], depot=[True, True, False, False, False])
    for most, loads in ((None, 2.0), (1, 4.0), (2, 2.0)):
        one = VehicleType(1, loads, reloads=(1,), max_reloads=most, fixed_cost=3.0)
        problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=line), (one,))
        best = best_values(problem)
        assert best is not None and check_customer_sets(problem, {}) == pytest.approx(float(best[0]))
    once = replace(problem, fleet=(replace(one, max_reloads=1),))
    assert best_values(once) is None and check_customer_sets(once, {}) == math.inf


def test_a_stop_a_large_problem_and_much_work_prove_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    corners = wb.RoutingProblem.from_frame(CITY.assign(demand=DEMAND), travel=STREETS, vehicles=4, capacity=15)
    assert len(CORNERS) == 17 and len(corners.customers) == customer_sets.CUSTOMERS
    stop = Stop(0.0)
    stop.ask()
    with until(stop):
        assert stop.reached() and check_customer_sets(small("capacity", 0, "exact"), {}) == -math.inf
        assert check_customer_sets(varied("reloads", 1, 3), {}) in (-math.inf, math.inf)
    monkeypatch.setattr(customer_sets, "WORK", 1000)
    assert check_customer_sets(corners, {}) == -math.inf
    many = RoutingProblem(Sites.of(range(18)), Travel(EXPLICIT, matrix=np.ones((18, 18))), (VehicleType(),), Reward())
    assert check_customer_sets(many, {}) == math.inf


@pytest.mark.parametrize("limits", [3.0, [1.0, "x"], [math.inf], [True], [0.0] * 65])
def test_limits_must_be_finite_numbers(limits) -> None:
    with pytest.raises(InputError, match="limits"):
        check_customer_sets(weighed(small("capacity", 0, "exact"), LongestRoute(), 2.0), {"longest-route": limits})


def on_a_line(places: list[float], fleet: VehicleType, weights: object = None, **columns: object) -> RoutingProblem:
    """A site a place, named a, b, ...; the first is a depot."""
    sites = Sites.of("abcdef"[: len(places)], **columns)
    travel = Travel(EXPLICIT, matrix=np.abs(np.subtract.outer(places, places)))
    return RoutingProblem(sites, travel, (fleet,), *(() if weights is None else (weights,)))


RELOADS = {"depot": [True, True, False, False], "demand": [0, 0, 1, 1], "due": [1000] * 4}


@pytest.mark.parametrize(
    ("problem", "route"),
    [
        (
            on_a_line(
                [0, 2, 1, 3], VehicleType(1, 1.0, reloads=(1,), energy=Energy(50.0, charge="elapsed-fixed-start")),
                ready=[100, 0, 125, 125], **RELOADS,
            ),
            (2, 1, 3),
        ),
        (on_a_line([0, 1, 5], VehicleType(), TotalCost() - 0.5 * Penalties(), penalty=[0, 4, 4]), (1, 2)),
        (on_a_line([0, 1, 5], VehicleType(), Reward() + 0.5 * Penalties(), penalty=[0, 4, 4]), (1, 2)),
        (on_a_line([0, 0, 0], VehicleType(unit_cost=1e20), Weighted(((1e308, TotalCost()),))), (1, 2)),
        (on_a_line([0, 1, 2], VehicleType(), Weighted(((1e308, LongestRoute()),) * 2)), (1, 2)),
    ],
)  # fmt: skip
def test_extreme_data_prove_nothing_false(problem: RoutingProblem, route: tuple[int, ...]) -> None:
    verdict = problem.evaluate(wb.Routes.of([route]))
    assert verdict.feasible
    bounds = [check_customer_sets(problem, {}), *([] if (b := wb.bound(problem, bound_time=60.0).bound) is None else [b])]
    for bound in bounds:
        assert beyond(problem, bound, verdict.values[0]) <= 1e-9 or verdict.values[0] == math.inf > bound


def test_more_routes_than_customers_are_no_work_for_it() -> None:
    problem = replace(small("capacity", 0, "exact"), min_vehicles=10**9, fleet=(VehicleType(),))
    assert check_customer_sets(problem, {}) == -math.inf
