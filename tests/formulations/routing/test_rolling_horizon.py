"""Plans in progress: what is done, where vehicles start, and what they have left."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from small_routing import varied
from truth.routing import RoutingTruth

import waybound as wb
from waybound import Energy, Group, LatestReturn, Objective, Reward, Route, Routes, Sites, TotalCost, UsageError, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

LINE = np.abs(np.arange(6.0)[:, None] - np.arange(6.0)[None, :])


def line(vehicles=2, sites=None, **limits):
    return wb.min_cost_vrp(sites or Sites.of("oabcde"), Travel(EXPLICIT, matrix=LINE), vehicles=vehicles, **limits)


PLAN = Routes.of([[1, 2, 5], [3, 4]])


def test_vehicles_under_way_start_at_their_next_stop():
    after = line(max_duration=20, max_distance=30).continue_from(PLAN, 1.5)
    first, second = after.fleet
    ids = after.sites.ids
    assert ids == ("o", "b", "c", "d", "e")
    assert (ids[first.start], ids[first.end], first.shift[0], first.max_duration, first.max_distance) == ("b", "o", 2, 18, 28)
    assert (ids[second.start], second.shift[0], second.max_duration, second.max_distance) == ("c", 3, 17, 27)
    assert first.committed and second.committed
    assert after.sites.required.tolist() == [False, False, False, True, True]


def test_orders_that_come_in_on_the_way_are_planned_with_the_rest():
    """Also where they stand before the others, so that the sites of the plan have other numbers."""
    frame = pd.DataFrame({"id": list("oabc"), "x": [0.0, 1, 2, 3], "y": 0.0})
    plan = wb.solve(wb.RoutingProblem.from_frame(frame, vehicles=2), "highs", bound_time=0)
    late = pd.concat([frame[:1], pd.DataFrame([{"id": "new", "x": 2.5, "y": 0.5}]), frame[1:]], ignore_index=True)
    problem = wb.RoutingProblem.from_frame(late, vehicles=2)
    for given in (plan, plan.routes):
        after = problem.continue_from(given, 0.5)  # on the way to the first stop, whichever that is
        assert {after.sites.ids[k] for k in after.customers} == {"new", *plan.routes[0][1:]}
        assert after.sites.required[list(after.sites.ids).index("new")]
    with pytest.raises(UsageError, match="visits site 9, and there are 5"):
        problem.continue_from(Routes.of([[9]]), 1.0)


def test_the_rest_of_the_plan_costs_what_was_left_of_it():
    problem = line()
    after = problem.continue_from(PLAN, 1.5)
    rest = Routes((Route((4,), 0), Route((3,), 1)))
    assert problem.evaluate(PLAN).values == (18,) and after.evaluate(rest).values == (18 - 2 - 3,)


def test_a_vehicle_that_serves_nobody_drives_home():
    after = line().continue_from(PLAN, 1.5)
    verdict = after.evaluate(Routes((Route((3, 4), 0),)))
    assert verdict.feasible and verdict.values == (2 + 1 + 5 + 3,)
    assert verdict.quantities["vehicles"] == 1


def test_vehicles_at_home_are_free_and_those_on_their_way_home_are_gone():
    sites = Sites.of("oabcde", ready=[0, 0, 0, 0, 0, 50], required=[False, True, True, False, True, True])
    problem = line(3, sites)
    plan = Routes.of([[1, 2], [4], [5]])  # back at 4, back at 8, leaves at 45
    assert [(v.name, v.count) for v in problem.continue_from(plan, 3).fleet] == [("vehicle", 1), ("vehicle under way 1", 1)]
    assert [(v.name, v.count) for v in problem.continue_from(plan, 5).fleet] == [("vehicle", 2)]
    assert problem.continue_from(plan, 9).sites.ids == ("o", "c", "e")


def test_nobody_leaves_home_before_the_horizon():
    after = line(3).continue_from(PLAN, 1.5)
    assert after.sites.ready[0] == 1.5
    assert replace(after, objective=Objective.of(LatestReturn())).evaluate(Routes((Route((3, 4), 0),))).values == (1.5 + 10,)


@pytest.mark.parametrize(
    ("energy", "left"),
    [
        (Energy(20, 2), Energy(16, 2)),
        (Energy(20, charge="elapsed"), Energy(17, charge="elapsed-fixed-start")),
        (Energy(20, charge="elapsed-fixed-start"), Energy(17, charge="elapsed-fixed-start")),
        (Energy(20, initial=18), Energy(16)),
        (Energy(20, stations=(0,), initial=18), Energy(20, stations=(0,), initial=16)),
    ],
)
def test_what_is_left_of_the_store(energy, left):
    problem = line(sites=Sites.of("oabcde", service=[0, 0, 1, 0, 0, 0]), energy=energy)
    assert problem.continue_from(Routes.of([[2, 5], [1, 3, 4]]), 1.5).fleet[0].energy == left


def test_a_store_is_full_after_a_station():
    sites = Sites.of("oabcde", depot=[True, False, True, False, False, False])
    problem = wb.min_cost_vrp(
        sites, Travel(EXPLICIT, matrix=LINE), fleet=[VehicleType(1, energy=Energy(9, stations=(2,)), name="v"), VehicleType(1, name="w")]
    )
    plan = Routes((Route((1, 2, 3, 4), 0), Route((5,), 1)))
    station, beyond = (problem.continue_from(plan, time).fleet[0] for time in (1.5, 2.5))
    assert (station.start, station.energy.initial) == (1, 9)
    assert (beyond.shift[0], beyond.energy.initial) == (3, 8)


def test_only_what_is_on_board_can_be_delivered():
    sites = Sites.of("oabcde", demand=[0, 1, 2, 3, 4, 5])
    after = wb.cvrp(sites, Travel(EXPLICIT, matrix=LINE), capacity=10, vehicles=2).continue_from(PLAN, 1.5)
    assert [v.capacity for v in after.fleet] == [5, 4]


def test_a_group_that_is_decided_is_left_out():
    sites = Sites.of("oabcde", groups=[Group((2, 3)), Group((4, 5))])
    after = line(1, sites).continue_from(Routes.of([[1, 2, 4]]), 1.5)
    assert after.sites.ids == ("o", "b", "d", "e")
    assert [g.sites for g in after.sites.groups] == [(2, 3)]


def test_rewards_that_were_collected_count_no_more():
    sites = Sites.of("oabcde", reward=[0, 1, 2, 3, 4, 5])
    problem = wb.team_orienteering(sites, Travel(EXPLICIT, matrix=LINE), vehicles=2, max_duration=10)
    after = problem.continue_from(Routes.of([[1, 2, 5]]), 1.5)
    assert after.evaluate(Routes((Route((after.sites.index()["e"],), 1),))).values == (5,)
    assert not after.sites.required.any()


@pytest.mark.parametrize("seed", range(8))
def test_an_optimal_plan_can_be_continued_from_any_moment(seed):
    problem = varied("several-depots", seed)
    problem = replace(problem, objective=TotalCost() if seed % 2 else Reward().then(TotalCost()))
    truth = RoutingTruth(problem)
    if truth.best is None or problem.features() & {"pickups", "shipments", "several-loads"} or not len(truth.samples[0]):
        return
    plan = truth.samples[0]
    for time in (1.5, 6.5, 14.5):
        try:
            after = problem.continue_from(plan, time)
        except UsageError as error:
            assert "left" in str(error)
            continue
        found = RoutingTruth(after)
        assert found.best is not None, (seed, time)
        verdict = after.evaluate(found.samples[0])
        assert verdict.feasible and np.allclose(verdict.values, [float(v) for v in found.best])


@pytest.mark.parametrize(
    ("problem", "plan", "time", "message"),
    [
        (line(), Routes.of([[1, 2], [2]]), 1.0, "the plan that is to be continued breaks a constraint: b is visited 2 times"),
        (line(), PLAN, 99.0, "nothing is left to plan at 99"),
        (line(), PLAN, math.inf, "a horizon begins at a moment, not at inf"),
        (line(sites=Sites.of("oabcde", pickup=1.0)), PLAN, 1.0, "cannot be continued with pickups"),
        (
            line(fleet=[VehicleType(2, shift=(0, 20), committed=True)], vehicles=None), PLAN, 11.0, "is left",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_continued_is_said(problem, plan, time, message):
    with pytest.raises(UsageError, match=message):
        problem.continue_from(plan, time)
