from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, few, plane, varied
from truth.routing import best_values

from waybound import Objective, TotalCost, Vehicles
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.vehicles_needed import fewest_routes, vehicles_needed


def test_large_loads_raise_the_number_beyond_the_sum():
    problem = replace(plane(1, 5, 10.0), objective=Objective.of(Vehicles().then(TotalCost())))
    problem = replace(problem, sites=replace(problem.sites, demand=np.array([0.0, 6, 6, 6, 5, 1])))
    evidence = vehicles_needed(problem)
    assert verified_bound(problem, evidence) == evidence.value == 4.0
    assert BOUNDS["vehicles-needed"].missing(plane(1, 5, 10.0))


def test_a_fleet_without_limit_of_load_needs_one() -> None:
    problem = replace(plane(1, 5, np.inf), objective=Objective.of(Vehicles().then(TotalCost())))
    evidence = vehicles_needed(problem)
    assert verified_bound(problem, evidence) == evidence.value == 1.0


def windows(count: int | None = None) -> object:
    """Five customers on a line who all want to be served at the same time, and could be carried by one vehicle."""
    problem = replace(plane(1, 5, 100.0, count), objective=Objective.of(Vehicles().then(TotalCost())))
    sites = replace(problem.sites, ready=np.array([0.0, *[500.0] * 5]), due=np.array([np.inf, *[500.0] * 5]))
    return replace(problem, sites=sites)


def test_sites_that_share_no_route_need_a_vehicle_each() -> None:
    problem = windows()
    evidence = fewest_routes(problem)
    assert evidence is not None and evidence.source == "vehicles needed, by sites of which no two share a route"
    assert verified_bound(problem, evidence) == evidence.value == 5.0 == best_values(problem)[0]


def test_weights_and_costs_beside_vehicles_are_counted_once() -> None:
    problem = replace(windows(), objective=Objective.of(3.0 * Vehicles()))
    evidence = fewest_routes(problem)
    assert evidence is not None and verified_bound(problem, evidence) == 15.0
    problem = replace(windows(), objective=Objective.of(1000.0 * Vehicles() + TotalCost()))
    evidence = fewest_routes(problem)
    assert evidence is not None and 4999.9 <= verified_bound(problem, evidence) <= best_values(problem)[0]


@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_answer_has_fewer_vehicles_than_is_proved(feature: str) -> None:
    for seed in range(2):
        problem = replace(varied(feature, seed, few(feature)), objective=Objective.of(Vehicles()))
        if BOUNDS["fewest-routes"].missing(problem):
            continue
        evidence, best = fewest_routes(problem), best_values(problem)
        if evidence is not None and best is not None:
            assert verified_bound(problem, evidence) <= best[0] + 1e-9


def test_where_bin_packing_says_as_much_there_is_nothing_to_add() -> None:
    assert fewest_routes(replace(plane(1, 5, 100.0), objective=Objective.of(Vehicles()))) is None


def test_other_objectives_are_left_alone() -> None:
    assert BOUNDS["fewest-routes"].missing(plane(1, 5, 10.0))
