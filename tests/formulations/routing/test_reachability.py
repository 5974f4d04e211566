import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hypothesis import HealthCheck, given, settings
from oracles import ASYM_5, SQUARE_4, TWO_INDEX, agrees, optimum, routing, small_problems, solved
from small_routing import at_risk, few, varied
from truth.routing import RoutingTruth, routes

from waybound import Energy, Evidence, InputError, Objective, RoutingProblem, Shipment, Sites, Travel, Vehicles, VehicleType
from waybound.formulations.routing.checking.no_answer import out_of_reach
from waybound.formulations.routing.reachability import minimum_vehicles, servable_alone, unreachable
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds.routing.infeasibility import infeasible_site_evidence

DRAWN = settings(max_examples=draws(200), deadline=None, suppress_health_check=[HealthCheck.too_slow])


@DRAWN
@given(problem=small_problems(most=3) | small_problems(most=3, hetero=True))
def test_no_feasible_route_visits_a_site_called_unreachable(problem: RoutingProblem) -> None:
    visited = {site for vehicle in problem.fleet for visits in routes(problem, vehicle) for site in visits}
    assert not visited & set(unreachable(problem))


@settings(DRAWN, max_examples=draws(300))
@given(problem=small_problems(most=3, hetero=True))
def test_sites_are_called_servable_alone_exactly_where_a_route_of_their_own_is_feasible(problem: RoutingProblem) -> None:
    for site, good in zip(problem.customers.tolist(), servable_alone(problem).tolist(), strict=True):
        assert good == any((site,) in routes(problem, vehicle) for vehicle in problem.fleet)


@DRAWN
@given(problem=small_problems(most=4))
def test_no_answer_has_fewer_routes_than_the_least_number(problem: RoutingProblem) -> None:
    counted = RoutingProblem(problem.sites, problem.travel, problem.fleet, Objective.of(Vehicles()), problem.min_vehicles)
    fewest = optimum(counted)
    assert fewest is None or fewest >= minimum_vehicles(problem)


@pytest.mark.parametrize(
    ("sites", "vehicle", "reason"),
    [
        ({"demand": [0, 1, 9, 1, 1]}, {"capacity": 5}, "its demand is 9, the capacity 5"),
        ({"due": [99, 9, 4, 9, 9]}, {}, "it is reached at 5 at the earliest, due 4"),
        ({"due": [9.5, 9, 9, 9, 9]}, {}, "the return from it is at 10 at the earliest, due 9.5"),
        ({"due": [11, 9, 9, 9, 9], "ready": [0, 0, 7, 0, 0]}, {}, "the return from it is at 12 at the earliest, due 11"),
        ({"service": [0, 0, 3, 0, 0]}, {"max_duration": 12}, "a route to it lasts 13 at least, the longest duration is 12"),
        ({}, {"max_distance": 9}, "a route to it is 10 long at least, the longest distance is 9"),
        ({}, {"energy": Energy(19, 2.0)}, "a route to it draws 20 of energy at least (travel), the store holds 19"),
        (
            {"service": [0, 0, 3, 0, 0]},
            {"energy": Energy(12, 1.0, "elapsed")},
            "a route to it draws 13 of energy at least (elapsed), the store holds 12",
        ),
        (
            {"ready": [0, 0, 8, 0, 0]},
            {"energy": Energy(12, 1.0, "elapsed-fixed-start")},
            "a route to it draws 13 of energy at least (elapsed-fixed-start), the store holds 12",
        ),
    ],
)
def test_reasons_name_the_limit_and_both_amounts(sites: dict[str, object], vehicle: dict[str, object], reason: str) -> None:
    problem = routing(xy=SQUARE_4, sites=sites, count=4, **vehicle)
    assert unreachable(problem) == {2: reason}
    for form in problem.forms():
        agrees(problem, form, None)


def test_a_detour_makes_a_site_reachable_where_the_triangle_inequality_fails() -> None:
    """Site 2 lies 7 away, but 6 through site 1; site 4 is 7 from home, and reached after 6."""
    assert unreachable(routing(matrix=ASYM_5, count=2, sites={"due": [99, 9, 6, 9, 9, 9]})) == {}
    assert unreachable(routing(matrix=ASYM_5, count=2, sites={"due": [99, 9, 5.9, 9, 9, 9]})) == {
        2: "it is reached at 6 at the earliest, due 5.9"
    }


def test_a_route_of_exactly_its_limit_is_reachable() -> None:
    assert unreachable(routing(matrix=np.array([[0, 0.1], [0.2, 0]]), max_distance=0.3)) == {}
    assert unreachable(routing(xy=SQUARE_4, max_distance=10.0)) == {}


def test_a_site_needs_one_vehicle_type_that_can_serve_it() -> None:
    small, slow = VehicleType(name="small", capacity=1), VehicleType(name="slow", max_distance=7.0)
    problem = routing(xy=SQUARE_4, sites={"demand": [0, 1, 2, 1, 2]}, fleet=(small, slow))
    assert unreachable(problem) == {
        2: "small: its demand is 2, the capacity 1; slow: a route to it is 10 long at least, the longest distance is 7"
    }


@pytest.mark.parametrize(
    ("demand", "fleet", "least"),
    [
        ([1, 1, 1, 1], (VehicleType(capacity=2),), 2),
        ([1, 1, 1, 1], (VehicleType(capacity=3),), 2),
        ([0.1, 0.1, 0.1, 0.0], (VehicleType(capacity=0.1),), 3),
        ([1, 1, 1, 1], (VehicleType(),), 1),
        ([3, 3, 3, 3], (VehicleType(count=1, capacity=9), VehicleType(count=9, capacity=2)), 3),
        ([9, 9, 9, 9], (VehicleType(count=2, capacity=9),), 3),
    ],
)
def test_least_number_of_routes_from_loads(demand: list[float], fleet: tuple[VehicleType, ...], least: int) -> None:
    assert minimum_vehicles(routing(xy=SQUARE_4, sites={"demand": [0, *demand]}, fleet=fleet)) == least


def test_least_number_of_routes_counts_only_required_sites() -> None:
    sites = {"demand": [0, 5, 5, 5, 5], "required": [False, True, False, False, False]}
    assert minimum_vehicles(routing(xy=SQUARE_4, sites=sites, capacity=5)) == 1
    assert minimum_vehicles(routing(xy=SQUARE_4, sites={**sites, "required": False}, capacity=5)) == 0
    assert minimum_vehicles(routing(xy=SQUARE_4, capacity=math.inf, min_vehicles=3)) == 3


def test_forms_agree_that_unreachable_optional_sites_are_left_out() -> None:
    problem = routing(xy=SQUARE_4, sites={"due": [99, 9, 4, 9, 9], "required": [False, True, False, True, True]}, count=4)
    assert unreachable(problem).keys() == {2}
    for form in ("three-index", *TWO_INDEX):
        assert solved(problem.compile(form).program)[0] == "optimal"


def test_where_direct_ways_will_do_no_others_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = RoutingProblem(
        Sites.of(range(100_000)),
        Travel("EUC_2D", np.random.default_rng(1).uniform(0, 100, (100_000, 2))),
        (VehicleType(max_distance=300.0),),
    )
    monkeypatch.setattr(Travel, "distances", property(lambda self: pytest.fail("all distances")))
    assert unreachable(problem) == {}
    tight = replace(problem, fleet=(VehicleType(max_distance=10.0),))
    assert unreachable(tight) == {}  # ways through others are too many to be looked at


ON_BOARD = {
    "several-loads": ({"demand": [[0, 0], [1, 9], [1, 2]]}, {"capacity": 5, "further_capacity": (4,)}, "its demand is 9, the capacity 4"),
    "pickups": ({"pickup": [0, 8, 1]}, {"capacity": 5}, "8 is collected there, the capacity is 5"),
    "several pickups": ({"pickup": [[0, 0], [0, 8], [0, 1]]}, {"further_capacity": (5,)}, "8 is collected there, the capacity is 5"),
    "initial-energy": ({}, {"energy": Energy(30, initial=7)}, "a route to it draws 8 of energy at least (travel), the store holds 7"),
    "skills": ({"skills": {1: ["tall", "cold"]}, "required": False}, {"skills": frozenset(["cold"])}, "the vehicle lacks tall"),
    "shipments": ({"shipments": [Shipment(2, 1, (6.0,))]}, {"capacity": 5}, "the shipment from b to a weighs 6, the capacity is 5"),
    "shifts": ({}, {"shift": (1, 8)}, "the return from it is at 9 at the earliest, due 8"),
    "vehicle-speeds": ({}, {"speed": 0.5, "max_duration": 15}, "a route to it lasts 16 at least, the longest duration is 15"),
    "vehicle-travel": (
        {}, {"travel": Travel("EXPLICIT", matrix=np.full((3, 3), 6.0)), "max_distance": 11},
        "a route to it is 12 long at least, the longest distance is 11",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", ON_BOARD)
def test_each_feature_has_its_words_which_the_checker_confirms(case):
    held, limits, told = ON_BOARD[case]
    xy = np.array([(0, 0), (4, 0), (3, 0)], dtype=float)
    problem = RoutingProblem(Sites.of("oab", **held), Travel("euclidean", xy), [VehicleType(2, **limits)])
    assert unreachable(problem)[1] == told
    assert all(1 not in visits for visits in routes(problem, problem.fleet[0]))
    required = problem.sites.required[1]
    assert verified_bound(problem, Evidence("infeasible-site", "", math.inf, {"site": "a"})) == (math.inf if required else -math.inf)
    assert [reason.where for reason in problem.infeasibility_reasons()][:1] == (["a"] if required else [])


@pytest.mark.share(2)
@pytest.mark.parametrize("feature", ["several-loads", "pickups", "shipments", "skills", "initial-energy", "shifts", "vehicle-travel"])
def test_who_is_out_of_reach_is_on_no_route(feature):
    found = 0
    for seed in range(40):
        try:
            problem = varied(feature, seed, few(feature))
        except InputError:  # a shipment that no vehicle can deliver in time is no problem
            continue
        store = Energy(60.0, initial=25.0) if feature == "initial-energy" else None
        tight = [replace(v, capacity=2.0, max_distance=40.0, skills=frozenset(), energy=store) for v in problem.fleet]
        nobody = replace(problem.sites, required=np.zeros(len(problem.sites), dtype=bool))
        problem = replace(problem, sites=nobody, fleet=tuple(tight), min_vehicles=0)
        for site in unreachable(problem):
            found += 1
            assert all(site not in visits for v in problem.fleet for visits in routes(problem, v)), (seed, site)
    assert found > 10


LINE = np.array([(0, 0), (10, 0), (15, 0), (30, 0), (17, 0)], dtype=float)
"""Home, a depot on the way, and sites at 15, 30 and 17."""

DRAWS = "a way to it from one filling of the store to the next draws {} of energy at least, the store holds {}"


@pytest.mark.parametrize(
    ("vehicle", "reason"),
    [
        ({"energy": Energy(20.0, stations=(1,))}, {3: DRAWS.format(40, 20)}),
        ({"energy": Energy(9.0, stations=(1,))}, {2: DRAWS.format(10, 9), 3: DRAWS.format(40, 9), 4: DRAWS.format(14, 9)}),
        ({"energy": Energy(40.0, stations=(1,))}, {}),
        (
            {"energy": Energy(40.0, stations=(1,)), "max_distance": 50.0},
            {3: "a route to it is 60 long at least, the longest distance is 50"},
        ),
        ({"capacity": 4.0, "reloads": (1,)}, {2: "its demand is 5, the capacity 4"}),
        ({"capacity": 5.0, "reloads": (1,), "max_duration": 50.0}, {3: "a route to it lasts 60 at least, the longest duration is 50"}),
    ],
)  # fmt: skip
def test_sites_out_of_reach_of_vehicles_that_stop_on_the_way_are_named(vehicle: dict[str, object], reason: dict[int, str]) -> None:
    sites = {"depot": [True, True, False, False, False], "demand": [0, 0, 5, 3, 2]}
    problem = routing(xy=LINE, sites=sites, count=3, **vehicle)
    assert unreachable(problem) == reason
    assert (infeasible_site_evidence(problem) is None) == (not reason)


@pytest.mark.parametrize("feature", ["reloads", "recharging"])
def test_no_site_of_any_route_is_named_where_vehicles_stop_on_the_way(feature: str) -> None:
    named = 0
    for seed in range(15):
        problem = varied(feature, seed, few(feature))
        weaker = [
            replace(v, max_distance=30.0, energy=v.energy and replace(v.energy, capacity=0.4 * v.energy.capacity, initial=None))
            for v in problem.fleet
        ]
        problem = replace(problem, fleet=tuple(weaker))
        visited = {site for _, route in RoutingTruth(problem).driven for site in route}
        beyond = {int(site) for site in np.nonzero(out_of_reach(problem))[0]}
        assert not visited & beyond
        assert beyond >= unreachable(problem).keys()
        named += len(unreachable(problem))
    assert named >= 3


@pytest.mark.parametrize(
    ("limits", "why"),
    [
        ({"max_duration": 18.0}, "to keep the risk of 0.05 a route to it needs 18.0772 of duration at least, the limit is 18"),
        (
            {"max_duration": math.inf, "energy": Energy(34.0, 2.0)},
            "to keep the risk of 0.05 a route to it needs 34.1545 of energy at least, the limit is 34",
        ),
    ],
)
def test_a_site_may_be_out_of_reach_for_its_risk_alone(limits: dict[str, object], why: str) -> None:
    for problem in (at_risk(0.05, **limits), at_risk(None, 0.05, **limits)):
        assert unreachable(problem) == {4: why}
        assert unreachable(replace(problem, fleet=(replace(problem.fleet[0], risk=None),), team_risk=0.06)) == {}
        evidence = infeasible_site_evidence(problem)
        assert evidence is not None and verified_bound(problem, evidence) == math.inf


def test_risks_are_never_said_to_be_beyond_a_route_that_keeps_them() -> None:
    for feature in ("route-risk", "team-risk"):
        for seed in range(10):
            problem = varied(feature, seed, 3)
            kept = [routes(problem, vehicle) for vehicle in problem.fleet]
            assert not {site for visits in itertools.chain(*kept) for site in visits} & set(unreachable(problem))
            if not problem.features() & {"pickups", "committed-vehicles"}:
                alone = [any((site,) in visits for visits in kept) for site in problem.customers.tolist()]
                assert servable_alone(problem).tolist() == alone
