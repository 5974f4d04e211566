"""Sites that no vehicle can serve are found and proved; others are not accused."""

from __future__ import annotations

import math

import numpy as np

from waybound.formulations.certificate import verified_bound
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import Stop
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.infeasible_site import infeasible_site_evidence, too_few_vehicles_evidence


def line(vehicle: VehicleType, **arrays) -> RoutingProblem:
    xy = np.array([[0.0, 0.0], [3.0, 0.0], [9.0, 0.0]])
    return RoutingProblem(Sites.of(["o", "near", "far"], **arrays), Travel("euclidean", coordinates=xy), (vehicle,))


def test_the_unreachable_site_is_named():
    problem = line(VehicleType(max_distance=17.0))
    found = infeasible_site_evidence(problem, Stop(60.0))
    assert found is not None
    assert found.data == {"site": "far"}
    assert "far" in found.source
    assert verified_bound(problem, found) == math.inf


def test_a_site_within_reach_is_not_accused():
    for vehicle in (VehicleType(max_distance=18.0), VehicleType(energy=Energy(18.0, charge="windows")), VehicleType()):
        assert infeasible_site_evidence(line(vehicle), Stop(60.0)) is None


def test_a_site_that_only_a_detour_reaches_is_not_accused():
    matrix = np.array([[0, 9, 2], [9, 0, 2], [2, 2, 0]], dtype=float)
    problem = RoutingProblem(Sites.of("oab"), Travel(EXPLICIT, matrix=matrix), (VehicleType(max_distance=8.0),))
    assert infeasible_site_evidence(problem, Stop(60.0)) is None


def test_sites_that_may_be_left_out_are_not_accused():
    assert infeasible_site_evidence(line(VehicleType(max_distance=17.0), required=[False, True, False]), Stop(60.0)) is None


def test_no_budget_means_no_search():
    assert infeasible_site_evidence(line(VehicleType(max_distance=17.0)), Stop(0.0)) is None


def test_a_fleet_too_small_for_the_load_is_proved_so():
    problem = line(VehicleType(count=1, capacity=5), demand=[0, 3, 3])
    found = too_few_vehicles_evidence(problem, Stop(60.0))
    assert found is not None
    assert verified_bound(problem, found) == math.inf
    assert too_few_vehicles_evidence(line(VehicleType(count=2, capacity=5), demand=[0, 3, 3]), Stop(60.0)) is None
    assert too_few_vehicles_evidence(line(VehicleType(capacity=1), demand=[0, 3, 3]), Stop(60.0)) is None


def test_these_come_before_any_search():
    assert BOUNDS["infeasible-site"].order == 0
    assert min(BOUNDS[name].order for name in ("spanning-tree", "linear-relaxation")) > 0
