"""Proofs that there is no answer hold only where there is none; and the vehicles that loads need."""

import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from small_routing import WHOLE_FAMILY, excludes, few, plane, varied

from waybound import InputError, Makespan, Objective, Reward, RoutingProblem, TotalCost, Vehicles
from waybound.formulations.evidence import CHECKERS
from waybound.formulations.routing.checking import no_answer as checks
from waybound.formulations.routing.checking.no_answer import check_infeasible_site, check_too_few_vehicles, check_vehicles_needed
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
    assert check_infeasible_site(one_site(vehicle, **site), {"site": "a"}) == math.inf


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


def test_for_max_the_signs_of_a_site_and_of_loads_change_places():
    sites = Sites.of("oa", demand=[0, 9], reward=1.0)
    travel = Travel(EXPLICIT, matrix=np.ones((2, 2)))
    for capacity, verdict in ((1.0, -math.inf), (9.0, math.inf)):
        problem = RoutingProblem(sites, travel, (VehicleType(count=1, capacity=capacity),), Reward().then(Reward()))
        assert problem.sense == "max"
        assert check_infeasible_site(problem, {"site": "a"}) == verdict
        assert check_too_few_vehicles(problem, {}) == verdict


KINDS = ("too-few-vehicles", "bin-packing", "too-little-range", "too-little-time", "sites-apart", "sites-beyond-fleet", "too-few-sites")


def unit(*vehicles: VehicleType, n: int = 3, min_vehicles: int = 0, **arrays) -> RoutingProblem:
    """A depot o and sites a, b, c, ... all 1 apart."""
    names = "oabcdefghijk"[: n + 1]
    made = {key: [math.inf if key == "due" else 0.0, *np.broadcast_to(value, n)] for key, value in arrays.items()}
    return RoutingProblem(Sites.of(names, **made), Travel(EXPLICIT, matrix=np.ones((n + 1, n + 1))), vehicles, min_vehicles=min_vehicles)


def proved(problem: RoutingProblem, kind: str, **data) -> bool:
    bound = CHECKERS[kind](problem, data)
    assert abs(bound) == math.inf
    return bound == math.inf


ABC, FOUR = {"sites": ["a", "b", "c"]}, {"n": 4, "service": 2.0}
MOMENTS = {"from": 1.0, "until": 3.9, "sites": list("abcd")}
BINS, CLOSE = unit(VehicleType(2, 10), demand=6), unit(VehicleType(2), due=1.0)
SMALL, LARGE = VehicleType(5, 2, name="small"), VehicleType(1, 4, name="large")
ROBOTS = [VehicleType(1, name=f"robot {k}", unit_cost=1.0 + k) for k in range(40)]
WAITS = {"n": 2, "ready": [10, 0], "due": [math.inf, 2]}  # a from 10 on and b by 2: a route over both lasts 8 and more
SHORT = unit(VehicleType(2), **FOUR, due=3.9)  # begun from 1 on, two a vehicle, served in 2 and driven to in 1: the last begins at 4


@pytest.mark.parametrize(
    ("problem", "kind", "data", "proof"),
    [
        (unit(VehicleType(2, 4), demand=3), "too-few-vehicles", {}, True),
        (unit(VehicleType(3, 3), demand=3), "too-few-vehicles", {}, False),
        (unit(VehicleType(None, 3), demand=3), "too-few-vehicles", {}, False),
        (BINS, "too-few-vehicles", {}, False),
        (BINS, "bin-packing", {"threshold": 5.0}, True),
        (BINS, "bin-packing", {"threshold": 7.0}, False),  # above half a capacity it says nothing
        (BINS, "bin-packing", {"threshold": -1.0}, False),
        (unit(VehicleType(2, 10), demand=[6, 5, 5]), "bin-packing", {"threshold": 5.0}, False),
        (unit(VehicleType(2), demand=6), "bin-packing", {"threshold": 5.0}, False),
        (SHORT, "too-little-time", MOMENTS, True),
        (unit(VehicleType(2), **FOUR, due=4.0), "too-little-time", MOMENTS | {"until": 4.0}, False),
        (unit(VehicleType(3), **FOUR, due=3.9), "too-little-time", MOMENTS, False),
        (unit(VehicleType(2), **FOUR, due=3.9, required=[True, True, True, False]), "too-little-time", MOMENTS, False),
        (SHORT, "too-little-time", MOMENTS | {"from": 1.1}, False),  # they begin before
        (SHORT, "too-little-time", MOMENTS | {"until": 3.8}, False),  # or after
        (SHORT, "too-little-time", MOMENTS | {"sites": ["a", "b"]}, False),
        (CLOSE, "sites-apart", ABC, True),
        (CLOSE, "sites-apart", {"sites": ["a", "b"]}, False),
        (unit(VehicleType(3), due=1.0), "sites-apart", ABC, False),
        (unit(VehicleType(2), due=[1.0, 1.0, 2.0]), "sites-apart", ABC, False),
        (unit(VehicleType(2), due=1.0, required=[True, True, False]), "sites-apart", ABC, False),
        # Only vehicles that can serve a named site count.
        (unit(SMALL, LARGE, demand=[3, 3, 1]), "sites-apart", {"sites": ["a", "b"]}, True),
        (unit(SMALL, LARGE, demand=[3, 2, 2]), "sites-apart", {"sites": ["a", "b"]}, False),
        (unit(VehicleType(1), due=2.0), "sites-beyond-fleet", ABC, True),
        (unit(VehicleType(1), due=2.0), "sites-beyond-fleet", {"sites": ["a", "b"]}, False),
        (unit(VehicleType(2), due=2.0), "sites-beyond-fleet", ABC, False),
        (unit(VehicleType(1), due=2.0, required=[True, True, False]), "sites-beyond-fleet", ABC, False),
        (unit(VehicleType(1, max_duration=8.9), **WAITS), "sites-beyond-fleet", {"sites": ["a", "b"]}, True),
        (unit(VehicleType(1, max_duration=10.0), **WAITS), "sites-beyond-fleet", {"sites": ["a", "b"]}, False),
        # Types that differ in price alone are one.
        (unit(*ROBOTS, n=7, due=1.0), "sites-beyond-fleet", {"sites": list("abcdefg")}, False),
        (unit(*ROBOTS[:6], n=7, due=1.0), "sites-beyond-fleet", {"sites": list("abcdefg")}, True),
        (unit(VehicleType(5), min_vehicles=4), "too-few-sites", {}, True),
        (unit(VehicleType(5), min_vehicles=3), "too-few-sites", {}, False),
        (unit(VehicleType(5), min_vehicles=3, due=[0.5, 1, 1], required=[False, True, True]), "too-few-sites", {}, True),
    ],
)
def test_a_proof_is_one_exactly_where_the_fleet_is_too_small(problem, kind, data, proof):
    assert proved(problem, kind, **data) == proof


@pytest.mark.parametrize(
    ("vehicle", "resource", "service"),
    [
        ({"max_distance": 3.0}, "distance", 0.0),
        ({"max_duration": 6.0}, "duration", 2.0),
        ({"energy": Energy(6.0, 2.0)}, "travel", 0.0),
        ({"energy": Energy(12.0, 2.0, "elapsed")}, "duration", 2.0),
        ({"energy": Energy(12.0, 2.0, "windows")}, "duration", 2.0),
        ({"energy": Energy(12.0, 2.0, "elapsed-fixed-start")}, "duration", 2.0),
    ],
)
def test_a_range_that_is_too_short_for_all_is_told(vehicle, resource, service):
    """Four sites, at least five moves of 1: 5 of driving, 13 with service."""
    need = 5.0 if resource != "duration" else 13.0
    enough = {
        key: replace(v, capacity=need * v.rate) if isinstance(v, Energy) else need for key, v in vehicle.items()
    }  # fmt: skip
    half = {key: replace(v, capacity=v.capacity * 0.99) if isinstance(v, Energy) else v for key, v in vehicle.items()}
    assert proved(unit(VehicleType(1, **half), n=4, service=service), "too-little-range", resource=resource)
    assert not proved(unit(VehicleType(1, **enough), n=4, service=service), "too-little-range", resource=resource)
    assert not proved(unit(VehicleType(None, **half), n=4, service=service), "too-little-range", resource=resource)


def test_the_hours_of_a_depot_are_a_range_too():
    sites = Sites.of("oab", due=[6.9, math.inf, math.inf], service=[0, 2, 2])
    asked = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(1),))
    assert proved(asked, "too-little-range", resource="duration")
    assert not proved(asked, "too-little-range", resource="travel")
    assert not proved(replace(asked, sites=replace(sites, due=np.array([7.0, 9, 9]))), "too-little-range", resource="duration")


def test_a_third_site_may_join_two():
    """From a to b it is 9, over c 2: with c they fit on one route."""
    matrix = np.array([[0, 1, 1, 1], [1, 0, 9, 1], [1, 9, 0, 1], [1, 1, 1, 0]], dtype=float)
    sites = Sites.of("oabc", due=[math.inf, 3, 3, 9])
    asked = RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), (VehicleType(1),))
    for named in (["a", "b"], ["a", "b", "c"]):
        assert not proved(asked, "sites-apart", sites=named)
        assert not proved(asked, "sites-beyond-fleet", sites=named)


def test_routes_asked_for_count_where_all_sites_are_named():
    """Site a is reached over b alone, so that there are two routes at most."""
    matrix = np.array([[0, 9, 1, 1], [1, 0, 1, 1], [1, 1, 0, 1], [1, 9, 1, 0]], dtype=float)
    sites = Sites.of("oabc", due=[math.inf, 2, 9, 9])
    asked = RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), (VehicleType(5),), min_vehicles=3)
    assert proved(asked, "sites-beyond-fleet", sites=["a", "b", "c"])
    assert not proved(asked, "sites-beyond-fleet", sites=["a", "b"])
    assert not proved(replace(asked, min_vehicles=2), "sites-beyond-fleet", sites=["a", "b", "c"])


def test_too_much_to_try_proves_nothing(monkeypatch):
    asked = unit(VehicleType(1), n=9, due=1.0)
    assert not proved(asked, "sites-beyond-fleet", sites=list("abcdefghi"))
    monkeypatch.setattr(checks, "MOST_COVERS", 0)
    assert not proved(unit(VehicleType(1), due=2.0), "sites-beyond-fleet", sites=["a", "b", "c"])
    monkeypatch.setattr(checks, "MOST_APART", 2)
    assert not proved(unit(VehicleType(2), due=1.0), "sites-apart", sites=["a", "b", "c"])


def test_for_max_the_signs_change_places():
    data = {"threshold": 0.5, "resource": "distance", "sites": ["a"], "from": 0, "until": 9}
    asked = replace(unit(VehicleType(1, 1), demand=9.0), objective=Reward())
    for kind in KINDS:
        bound = CHECKERS[kind](asked, data)
        assert bound == (-math.inf if kind in ("too-few-vehicles", "bin-packing", "sites-apart", "sites-beyond-fleet") else math.inf), kind


@pytest.mark.parametrize(
    ("kind", "data"),
    [
        *(("infeasible-site", data) for data in ({}, {"site": 1}, {"site": "z"}, {"site": ["a"]})),
        *(("bin-packing", data) for data in ({}, {"threshold": "a"}, {"threshold": math.nan}, {"threshold": True})),
        ("too-little-time", {}), ("too-little-time", {"from": 0}), ("too-little-time", {"from": 0, "until": math.inf}),
        ("too-little-time", {"from": 0, "until": 9}),
        ("too-little-range", {}), ("too-little-range", {"resource": ["distance"]}),
        *(
            (kind, {"sites": names})
            for kind in ("sites-apart", "sites-beyond-fleet")
            for names in (None, [], "ab", ["z"], [1], ["a", "a"], ["o"], {"a": 1})
        ),
    ],
)  # fmt: skip
def test_malformed_evidence_is_refused(kind, data):
    with pytest.raises(InputError):
        CHECKERS[kind](unit(VehicleType(1)), data)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "too-few-sites"])
def test_sums_that_may_overflow_prove_nothing(kind):
    asked = unit(VehicleType(1, 1.0, energy=Energy(1.0, 1e300)), demand=5.0)
    assert not proved(asked, kind, threshold=0.5, resource="distance", sites=["a", "b"], **{"from": 0, "until": 1})


@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_threshold_excludes_the_optimum(feature):
    for seed in range(2):
        goal = (Vehicles(), 5.0 * Vehicles() + TotalCost(), Vehicles() + Makespan())[seed % 3]
        problem = replace(varied(feature, seed, few(feature)), objective=Objective.of(goal))
        for threshold in (-1.0, 0.0, 1.0, 3.0, 5.5, 100.0):
            assert not excludes(problem, check_vehicles_needed(problem, {"threshold": threshold}), 0.0)


def test_large_loads_share_no_vehicle():
    problem = replace(plane(1, 4, 10.0), objective=Objective.of(Vehicles()))
    problem = replace(problem, sites=replace(problem.sites, demand=problem.sites.demand * 0 + [0, 6, 6, 6, 4]))
    assert check_vehicles_needed(problem, {"threshold": 0.0}) == 3.0
    problem = replace(problem, sites=replace(problem.sites, demand=problem.sites.demand * 0 + [0, 6, 6, 5, 5]))
    assert check_vehicles_needed(problem, {"threshold": 5.0}) == 3.0
    assert check_vehicles_needed(replace(problem, min_vehicles=4), {"threshold": 5.0}) == 4.0


def test_other_objectives_and_malformed_evidence():
    problem = plane(1, 4, 10.0)
    assert check_vehicles_needed(replace(problem, objective=Objective.of(Reward())), {"threshold": 0.0}) == math.inf
    with pytest.raises(InputError):
        check_vehicles_needed(problem, {"threshold": "x"})
