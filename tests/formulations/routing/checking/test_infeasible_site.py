"""Proofs that there is no answer hold only where there is none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings
from hypothesis import strategies as st

from waybound.formulations.routing.checking.fleet_need import check_too_few_vehicles
from waybound.formulations.routing.checking.infeasible_site import check_infeasible_site
from waybound.formulations.routing.objective import Reward
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.errors import InputError
from waybound.instances.routing.instance import ENERGY_CHARGES, Energy, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel


@settings(max_examples=draws(60), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_a_proof_is_given_only_where_there_is_no_answer(random_problem, optimum, seed):
    problem = random_problem(seed, customers=seed % 4 + 1)
    best = optimum(problem)
    verdicts = [check_infeasible_site(problem, {"site": name}) for name in problem.sites.ids]
    verdicts.append(check_too_few_vehicles(problem, {}))
    assert best == math.inf or max(verdicts) == -math.inf


def one_site(vehicle: VehicleType, **site: float) -> RoutingProblem:
    """Depot o and site a, 5 apart, by way of b only 3 + 3 in distance but 9 + 9 in time."""
    matrix = np.array([[0, 8, 3], [8, 0, 3], [3, 3, 0]], dtype=float)
    times = np.array([[0, 5, 9], [5, 0, 9], [9, 9, 0]], dtype=float)
    arrays = {name: [0.0, value, 0.0] for name, value in site.items()}
    if "due" in arrays:
        arrays["due"] = [100.0, site["due"], 100.0]
    return RoutingProblem(Sites.of(["o", "a", "b"], **arrays), Travel(EXPLICIT, matrix=matrix, duration_matrix=times), (vehicle,))


@pytest.mark.parametrize(
    ("vehicle", "site"),
    [
        (VehicleType(capacity=4), {"demand": 4.5}),
        (VehicleType(), {"due": 4.5}),
        (VehicleType(max_distance=11.5), {}),
        (VehicleType(max_duration=12.5), {"service": 3.0}),
        (VehicleType(energy=Energy(9.5)), {}),
        (VehicleType(energy=Energy(12.5, charge="elapsed")), {"service": 3.0}),
        (VehicleType(energy=Energy(17.5, charge="elapsed-fixed-start")), {"ready": 10.0, "service": 3.0}),
        (VehicleType(energy=Energy(17.5, charge="windows")), {"ready": 10.0, "service": 3.0}),
    ],
)
def test_each_limit_alone_proves_a_site_out_of_reach(vehicle, site):
    problem = one_site(vehicle, **site)
    assert check_infeasible_site(problem, {"site": "a"}) == math.inf


@pytest.mark.parametrize(
    ("vehicle", "site"),
    [
        (VehicleType(capacity=4.5), {"demand": 4.5}),
        (VehicleType(), {"due": 5.0}),
        (VehicleType(max_distance=12), {}),  # by way of b, which is no customer's fault
        (VehicleType(max_duration=13), {"service": 3.0}),
        (VehicleType(energy=Energy(10)), {}),
        (VehicleType(energy=Energy(13, charge="elapsed")), {"ready": 10.0, "service": 3.0}),
        (VehicleType(energy=Energy(18, charge="elapsed-fixed-start")), {"ready": 10.0, "service": 3.0}),
        (VehicleType(energy=Energy(18, charge="windows")), {"ready": 10.0, "service": 3.0}),
    ],
)
def test_limits_that_are_just_met_prove_nothing(vehicle, site):
    assert check_infeasible_site(one_site(vehicle, **site), {"site": "a"}) == -math.inf


@pytest.mark.parametrize("unit", [2.0**-40, 1.0, 2.0**40])
@pytest.mark.parametrize("charge", ENERGY_CHARGES)
def test_energy_is_rounded_in_its_own_unit_whatever_that_of_the_clock(charge, unit):
    times = np.array([[0, 5], [5, 0]]) / unit
    sites, travel = Sites.of(["o", "a"]), Travel(EXPLICIT, matrix=np.ones((2, 2)), duration_matrix=times)
    for store, proof in ((9.9e-9, math.inf), (1.01e-8, -math.inf)):
        vehicle = VehicleType(energy=Energy(store, rate=1e-9 * unit, charge=charge))
        assert check_infeasible_site(RoutingProblem(sites, travel, (vehicle,)), {"site": "a"}) == proof


def test_one_vehicle_type_that_can_is_enough():
    problem = one_site(VehicleType(capacity=1), demand=2.0)
    both = RoutingProblem(problem.sites, problem.travel, (*problem.fleet, VehicleType(capacity=2, name="large")))
    assert check_infeasible_site(both, {"site": "a"}) == -math.inf


def test_sites_that_need_no_visit_prove_nothing():
    sites = Sites.of(["o", "a"], demand=[0, 9], required=[False, False])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((2, 2))), (VehicleType(capacity=1),))
    assert check_infeasible_site(problem, {"site": "a"}) == -math.inf
    assert check_infeasible_site(problem, {"site": "o"}) == -math.inf
    assert check_too_few_vehicles(problem, {}) == -math.inf


def test_for_max_the_signs_change_places():
    sites = Sites.of("oa", demand=[0, 9], reward=1.0)
    travel = Travel(EXPLICIT, matrix=np.ones((2, 2)))
    for capacity, verdict in ((1.0, -math.inf), (9.0, math.inf)):
        problem = RoutingProblem(sites, travel, (VehicleType(count=1, capacity=capacity),), Reward().then(Reward()))
        assert problem.sense == "max"
        assert check_infeasible_site(problem, {"site": "a"}) == verdict
        assert check_too_few_vehicles(problem, {}) == verdict


@pytest.mark.parametrize("data", [{}, {"site": 1}, {"site": "z"}, {"site": ["a"]}])
def test_malformed_evidence_is_refused(data):
    with pytest.raises(InputError):
        check_infeasible_site(one_site(VehicleType()), data)
