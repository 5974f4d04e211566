"""Sites that no vehicle can serve, and fleets that are too small, are proved so before any search; others are not accused."""

import math

import numpy as np
import pytest

from waybound import Energy, RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing import infeasibility
from waybound.solvers.bounds.routing.infeasibility import fleet_need_evidence, infeasible_site_evidence, too_few_vehicles_evidence


def line(vehicle: VehicleType, **arrays) -> RoutingProblem:
    xy = np.array([[0.0, 0.0], [3.0, 0.0], [9.0, 0.0]])
    return RoutingProblem(Sites.of(["o", "near", "far"], **arrays), Travel("euclidean", coordinates=xy), (vehicle,))


def test_the_unreachable_site_is_named():
    problem = line(VehicleType(max_distance=17.0))
    found = infeasible_site_evidence(problem, Stop(60.0))
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
    assert verified_bound(problem, too_few_vehicles_evidence(problem, Stop(60.0))) == math.inf
    assert too_few_vehicles_evidence(line(VehicleType(count=2, capacity=5), demand=[0, 3, 3]), Stop(60.0)) is None
    assert too_few_vehicles_evidence(line(VehicleType(capacity=1), demand=[0, 3, 3]), Stop(60.0)) is None


def test_these_come_before_any_search():
    assert BOUNDS["infeasible-site"].order == 0
    assert min(BOUNDS[name].order for name in ("spanning-tree", "linear-relaxation")) > 0


def apart(count: int) -> RoutingProblem:
    """Four sites in four directions, all due when they can just be reached."""
    xy = np.array([[0, 0], [10, 0], [-10, 0], [0, 10], [0, -10]], dtype=float)
    return RoutingProblem(Sites.of(range(5), due=[math.inf, *[10] * 4]), Travel("euclidean", xy), (VehicleType(count),))


def test_sites_that_share_no_route_prove_a_fleet_too_small():
    problem = apart(3)
    found = fleet_need_evidence(problem, Stop(60.0))
    assert (found.kind, verified_bound(problem, found)) == ("sites-apart", math.inf)
    assert fleet_need_evidence(apart(4), Stop(60.0)) is None


def test_large_instances_are_left_alone(monkeypatch):
    monkeypatch.setattr(infeasibility, "MOST_SITES", 4)
    assert fleet_need_evidence(apart(3), Stop(60.0)) is None


@pytest.mark.parametrize("seconds", [0.0, -1.0])
def test_no_budget_means_no_look_at_the_fleet(seconds):
    assert fleet_need_evidence(apart(3), Stop(seconds)) is None


def test_it_comes_before_any_search_and_after_single_sites():
    assert BOUNDS["too-small-fleet"].order == 0
    names = [m.name for m in sorted(BOUNDS.values(), key=lambda m: m.order)]
    assert names.index("infeasible-site") < names.index("too-small-fleet")
