"""Limits on the largest route that prove the optimum of objectives in which it is weighed against costs."""

from __future__ import annotations

import math

import pytest
from city_corners import CITY, SHIPMENTS, STREETS
from programs import program
from small_routing import small
from truth.routing import best_values

import waybound as wb
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import verified_bound
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import Stop
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.customer_sets import customer_sets_bound

SPAN = wb.TotalCost() + 100 * wb.LongestRoute()


@pytest.mark.parametrize("term", [wb.LongestRoute(), wb.Makespan()])
def test_costs_and_the_largest_route_are_proved_together(term) -> None:
    for seed in range(5):
        given = small("limited-fleet", seed, "exact")
        for weight in (0.5, 10.0):
            problem = RoutingProblem(given.sites, given.travel, given.fleet, wb.TotalCost() + weight * term)
            best = best_values(problem)
            evidence = customer_sets_bound(problem, Stop(10.0))
            assert best is not None and evidence is not None
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
