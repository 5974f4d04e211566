import math

import numpy as np
import pytest
from city_corners import CITY, SHIPMENTS, STREETS
from programs import program
from small_routing import small
from truth.routing import best_values

import waybound as wb
from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.few_customers import all_routes_bound, customer_sets_bound


@pytest.mark.slow
def test_a_fleet_of_several_types_and_optional_sites_are_proved_optimal() -> None:
    for feature in ("heterogeneous-fleet", "prizes"):
        problem = next(p for p in (small(feature, seed, "exact") for seed in range(9)) if best_values(p) is not None)
        evidence, best = all_routes_bound(problem, Stop(10.0)), best_values(problem)
        assert verified_bound(problem, evidence) == pytest.approx(best[0])
        found = wb.solve(problem, "highs", bound_time=10.0)
        assert (found.status, found.bound_kind) == ("optimal", "verified")


def test_it_applies_to_few_customers() -> None:
    missing = BOUNDS["all-routes"].missing
    assert missing(small("capacity", 0, "exact")) == frozenset()
    assert missing(wb.generate("random", seed=1, customers=13)) == {"few customers"}
    assert missing(wb.generate("random", seed=1, customers=12)) == frozenset()
    assert missing(ArrayProblem(program([1.0], [[1.0]], 0, 1))) == {"arrays problems"}


def test_a_problem_without_answers_is_told() -> None:
    sites = Sites.of("oabc", demand=[0, 2, 2, 2])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(2, 3.0),))
    found = all_routes_bound(problem, Stop(60.0))
    assert found is not None and found.value == math.inf
    assert all_routes_bound(problem, Stop(0.0)) is None


SPAN = wb.TotalCost() + 100 * wb.LongestRoute()


@pytest.mark.parametrize("term", [wb.LongestRoute(), wb.Makespan()])
def test_costs_and_the_largest_route_are_proved_together(term) -> None:
    for seed in range(5):
        given = small("limited-fleet", seed, "exact")
        for weight in (0.5, 10.0):
            problem = RoutingProblem(given.sites, given.travel, given.fleet, wb.TotalCost() + weight * term)
            best = best_values(problem)
            evidence = customer_sets_bound(problem, Stop(10.0))
            assert evidence.value == verified_bound(problem, evidence) == pytest.approx(float(best[0]), rel=1e-9)


def test_shipments_over_a_city_are_solved_to_a_verified_optimum() -> None:
    """The tutorial's value with its search is 226116."""
    fleet = [{"count": 4, "max_distance": 3000}]
    problem = wb.RoutingProblem.from_frame(CITY, travel=STREETS, fleet=fleet, shipments=SHIPMENTS, objective=SPAN)
    evidence = customer_sets_bound(problem, Stop(20.0), target=210504.0)
    assert evidence is not None and evidence.value == pytest.approx(210504.0, rel=1e-9)


def test_it_applies_to_few_customers_and_needs_time() -> None:
    missing = BOUNDS["customer-sets"].missing
    problem = small("capacity", 0, "exact")
    assert missing(problem) == frozenset()
    assert missing(wb.generate("random", seed=1, customers=17)) == {"few customers"}
    assert missing(ArrayProblem(program([1.0], [[1.0]], 0, 1))) == {"arrays problems"}
    worse = RoutingProblem(problem.sites, problem.travel, problem.fleet, wb.TotalCost() - wb.LongestRoute())
    assert missing(worse) == {"objective:weights"}
    assert customer_sets_bound(problem, Stop(0.0)) is None
    found = customer_sets_bound(problem, Stop(60.0), target=math.inf)
    assert found is not None and found.data == {}
