"""Schedules by hand: what is on board, several windows, recharging, closing moves, travel of one's own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Route
from waybound.formulations.routing.schedule import closing, opening, schedule
from waybound.instances.routing.instance import Energy, Shipment, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

LINE = np.abs(np.arange(5.0)[:, None] - np.arange(5.0)[None, :])  # sites at 0, 1, 2, 3, 4


def line(vehicle: VehicleType | None = None, closes=None, **sites) -> RoutingProblem:
    return RoutingProblem(Sites.of("oabcd", **sites), Travel(EXPLICIT, matrix=LINE, closing=closes), [vehicle or VehicleType()])


def test_what_is_delivered_leaves_and_what_is_collected_stays_on_board():
    plan = schedule(line(demand=[0, 3, 2, 1, 0], pickup=[0, 0, 4, 1, 2]), Route((1, 2, 3, 4)))
    assert plan.on_board.tolist() == [[6, 3, 5, 5, 7]]
    assert plan.peak == (7,)


def test_no_route_takes_less_than_its_moves_however_far_from_zero_its_clock_is():
    matrix, far = np.array([[0.0, 6.8e-6], [6.8e-6, 0.0]]), 1e9  # where clocks are 1.2e-7 apart
    problem = RoutingProblem(Sites.of("oa", ready=[far, 0.0]), Travel(EXPLICIT, matrix=matrix), [VehicleType()])
    assert schedule(problem, Route((1,))).duration == 13.6e-6


def test_a_reload_changes_what_is_collected_for_what_is_delivered_next():
    depots = {"depot": [True, False, False, False, True]}
    plan = schedule(line(VehicleType(reloads=(4,)), demand=[0, 3, 2, 4, 0], pickup=[0, 1, 1, 1, 0], **depots), Route((1, 2, 4, 3)))
    assert plan.on_board.tolist() == [[5, 3, 2, 4, 1]]
    assert plan.total_load == 9


def test_shipments_are_on_board_from_pickup_to_delivery_across_reloads():
    depots = {"depot": [True, False, False, False, True]}
    problem = line(VehicleType(reloads=(4,)), shipments=[Shipment(1, 3, (5.0,))], demand=[0, 0, 2, 0, 0], **depots)
    assert schedule(problem, Route((1, 2, 4, 3))).on_board.tolist() == [[2, 7, 5, 5, 0]]


def test_each_load_dimension_has_its_own_peak():
    problem = line(demand=[[0, 0], [3, 1], [2, 1], [0, 0], [0, 0]], pickup=[[0, 0], [0, 5], [0, 0], [0, 0], [0, 0]])
    assert schedule(problem, Route((1, 2))).peak == (5, 6)


def test_several_windows_are_waited_for_in_turn_and_the_shortest_day_is_found():
    # From 0 at 0 the first window of b is met and c waited for from 3 to 30; leaving at 27 meets the second one of b.
    problem = line(windows={2: [(0, 5), (20, 40)], 3: [(30, 35), (60, 70)]})
    plan = schedule(problem, Route((2, 3)))
    assert plan.begin.tolist() == [2, 30] and plan.finish == 33
    assert plan.duration == 6
    late = schedule(problem, Route((2, 3)), departure=10.0)
    assert (late.begin.tolist(), late.finish) == ([20, 30], 33)


def test_where_no_departure_saves_the_gap_it_is_waited_for():
    # b closes at 5, so that c is waited for whenever one leaves.
    plan = schedule(line(windows={2: [(0, 5), (50, 51)], 3: [(30, 35), (36, 37)]}), Route((2, 3)))
    assert plan.duration == 30  # leaves at 3, b at 5, c at 30, back at 33


def test_a_missed_last_window_is_not_waited_for():
    plan = schedule(line(windows={2: [(0, 1), (1.5, 1.75)]}), Route((2,)))
    assert plan.begin.tolist() == [2]


def test_energy_is_drawn_from_one_station_to_the_next():
    depots = {"depot": [True, False, True, False, False]}
    problem = line(VehicleType(energy=Energy(9, stations=(2,))), **depots)
    assert schedule(problem, Route((1, 2, 3, 2, 4))).stretches == (2, 2, 6)
    assert schedule(problem, Route((1, 3))).stretches == (6,)


def test_moves_begin_before_they_close():
    closes = np.full((5, 5), math.inf)
    closes[1, 3] = 4.0
    plan = schedule(line(closes=closes, service=[0, 2, 0, 0, 0], ready=[0, 3, 0, 0, 0]), Route((1, 3)))
    assert plan.leaves.tolist() == [0, 5, 7]
    assert plan.closing.tolist() == [math.inf, 4, math.inf]


def test_a_closing_move_ends_the_slack_of_those_before_it():
    problem = line(ready=[0, 0, 0, 50, 0])
    assert schedule(problem, Route((1, 3))).duration == 6
    closes = np.full((5, 5), math.inf)
    closes[1, 3] = 11.0
    assert schedule(line(closes=closes, ready=[0, 0, 0, 50, 0]), Route((1, 3))).duration == 53 - 10


def test_shifts_narrow_the_windows_of_the_depots():
    problem = line(VehicleType(shift=(5, 30)), ready=[2, 0, 0, 0, 0], due=[25, 99, 99, 99, 99])
    assert (opening(problem, problem.fleet[0]), closing(problem, problem.fleet[0])) == (5, 25)
    assert schedule(problem, Route((1,))).departure == 5


def test_a_vehicle_has_its_own_way_and_speed():
    own = Travel(EXPLICIT, matrix=3 * LINE, duration_matrix=8 * LINE)
    problem = replace(line(), fleet=(VehicleType(speed=2, name="fast"), VehicleType(travel=own, speed=4, name="other")))
    fast, other = schedule(problem, Route((2,))), schedule(problem, Route((2,), 1))
    assert (fast.total_distance, fast.duration) == (4, 2)
    assert (other.total_distance, other.duration) == (12, 8)


@pytest.mark.parametrize("departure", [0.0, 3.0])
def test_a_later_departure_moves_all_that_follows(departure):
    assert schedule(line(), Route((1, 2)), departure).begin.tolist() == [departure + 1, departure + 2]
