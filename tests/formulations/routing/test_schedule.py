import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from truth.routing import RoutingTruth

from waybound import Energy, Objective, Route, Routes, RoutingProblem, Shipment, Sites, VehicleType
from waybound.formulations.evaluation import Checklist
from waybound.formulations.routing.forms._all_routes import Walk
from waybound.formulations.routing.judge import check_route
from waybound.formulations.routing.schedule import closing, opening, schedule
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.reports.benchmarks.routing_variants import with_features

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
    assert (plan.departure, plan.begin.tolist(), plan.finish) == (27, [29, 30], 33)
    assert plan.duration == 6
    early = schedule(problem, Route((2, 3)), departure=0.0)
    assert (early.begin.tolist(), early.finish, early.duration) == ([2, 30], 33, 33)
    late = schedule(problem, Route((2, 3)), departure=10.0)
    assert (late.begin.tolist(), late.finish) == ([20, 30], 33)


TWO_DAYS = {"windows": {2: [(2, 5), (40, 60)], 3: [(30, 35), (42, 70)]}}  # early: back at 33 after 30; late: back at 45 after 6


@pytest.mark.parametrize(
    ("objective", "limits", "driven"),
    [
        ("total-cost", {}, (6, 45)),
        ("latest-return", {}, (30, 33)),
        ("latest-return", {"max_duration": 20}, (6, 45)),  # what returns first lasts too long
        ("total-cost", {"energy": Energy(40, charge="elapsed-fixed-start")}, (30, 33)),  # what is shortest returns too late
        ("latest-return", {"energy": Energy(20, charge="elapsed")}, (6, 45)),
    ],
)
def test_one_schedule_keeps_all_limits_and_is_the_best_by_the_objective(objective, limits, driven):
    problem = replace(line(VehicleType(**limits), **TWO_DAYS), objective=Objective.of(objective))
    plan = schedule(problem, Route((2, 3)))
    assert (plan.duration, plan.finish) == driven
    assert problem.evaluate(Routes((Route((2, 3)),))).quantities["waiting"] == plan.waiting
    assert not {v.check for v in problem.evaluate(Routes((Route((2, 3)),))).violations} & {"duration", "energy"}


def test_limits_that_no_one_schedule_keeps_are_not_kept():
    both = VehicleType(max_duration=20, energy=Energy(40, charge="elapsed-fixed-start"))
    verdict = line(both, **TWO_DAYS).evaluate(Routes((Route((2, 3)),)))
    assert [v.check for v in verdict.violations if v.check != "visits"] == ["energy"]


TWO_WANTS = (
    ("objective:latest-return",), ("objective:latest-return", "max-duration"), ("energy:elapsed-fixed-start", "max-duration"),
    ("energy:elapsed-fixed-start", "objective:total-duration"), ("energy:elapsed", "objective:latest-return"),
    ("duration-cost", "energy:elapsed-fixed-start"), ("objective:latest-return", "closing-moves", "max-duration"),
)  # fmt: skip
"""Features beside several windows that may want two schedules of one route."""


@pytest.mark.share(7)
@pytest.mark.parametrize("number", range(70))
def test_the_schedule_is_that_of_whole_numbers_and_of_the_forms_that_know_all_routes(number):
    problem = with_features(("several-windows", *TWO_WANTS[number % len(TWO_WANTS)]), number)
    if problem is None or len(problem.customers) > 5:
        pytest.skip("no such problem is drawn, or one too large to enumerate")
    truth, rng, customers = RoutingTruth(problem), np.random.default_rng(number), problem.customers
    for _ in range(12):
        order = rng.permutation(customers).tolist()[: int(rng.integers(1, len(customers) + 1))]
        cut, kinds = int(rng.integers(0, len(order))), rng.integers(len(problem.fleet), size=2)
        answer = Routes.of([Route(tuple(part), int(kind)) for part, kind in zip((order[:cut], order[cut:]), kinds, strict=True) if part])
        verdict, exact = problem.evaluate(answer), truth.value(answer)
        assert verdict.feasible == (exact is not None), answer
        assert exact is None or verdict.values == pytest.approx([float(value) for value in exact])
        for route in answer:
            priced, found = Walk(problem, route.vehicle).given(route.visits), Checklist()
            plan = check_route(problem, "it", route, found)
            assert (priced is None) == bool(found.violations)
            assert priced is None or (priced.duration, priced.finish) == pytest.approx((plan.duration, plan.finish))


def test_where_no_departure_saves_the_gap_it_is_waited_for():
    # b closes at 5, so that c is waited for whenever one leaves.
    plan = schedule(line(windows={2: [(0, 5), (50, 51)], 3: [(30, 35), (36, 37)]}), Route((2, 3)))
    assert plan.duration == 30  # leaves at 3, b at 5, c at 30, back at 33


def test_a_missed_last_window_is_not_waited_for():
    assert schedule(line(windows={2: [(0, 1), (1.5, 1.75)]}), Route((2,))).begin.tolist() == [2]


def test_energy_is_drawn_from_one_station_to_the_next():
    depots = {"depot": [True, False, True, False, False]}
    problem = line(VehicleType(energy=Energy(9, stations=(2,))), **depots)
    assert schedule(problem, Route((1, 2, 3, 2, 4))).stretches == (2, 2, 6)
    assert schedule(problem, Route((1, 3))).stretches == (6,)


def test_moves_begin_before_they_close():
    closes = np.full((5, 5), math.inf)
    closes[1, 3] = 4.0
    plan = schedule(line(closes=closes, service=[0, 2, 0, 0, 0], ready=[0, 3, 0, 0, 0]), Route((1, 3)))
    assert plan.leaves.tolist() == [2, 5, 7]
    assert plan.closing.tolist() == [math.inf, 4, math.inf]


def test_a_closing_move_ends_the_slack_of_those_before_it():
    assert schedule(line(ready=[0, 0, 0, 50, 0]), Route((1, 3))).duration == 6
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


def test_a_window_that_opens_after_the_next_move_has_closed_is_none():
    """a begins by 17, for its second window opens at 46 and the move to b closes at 39: it leaves by 7, b waits until 65."""
    matrix, closes = np.where(np.eye(3, dtype=bool), 0.0, 10.0), np.full((3, 3), math.inf)
    closes[1, 2] = 39.0
    sites = Sites.of("dab", windows={1: [(0, 17), (46, 94)]}, ready=[0, 0, 65])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix, closing=closes), [VehicleType(1, max_duration=60)])
    plan = schedule(problem, Route((1, 2)))
    assert (plan.duration, plan.departure) == (68, 7)
    assert [v.check for v in problem.evaluate(Routes.of([[1, 2]])).violations] == ["duration"]


LAST = 45  # of the clock that brute force looks at


@st.composite
def timed_routes(draw):
    """A route through all sites in turn, the last of them a depot to reload at now and then; all times are whole numbers."""
    n = draw(st.integers(1, 4))
    few, ends = st.integers(0, 4), st.integers(0, LAST)
    matrix = np.array(draw(st.lists(st.lists(few, min_size=n + 1, max_size=n + 1), min_size=n + 1, max_size=n + 1)), dtype=float)
    np.fill_diagonal(matrix, 0.0)
    closes = np.full((n + 1, n + 1), math.inf)
    for i, j in [*zip(range(n), range(1, n + 1), strict=True), (n, 0)]:
        closes[i, j] = draw(st.one_of(st.just(math.inf), st.just(math.inf), ends))
    depot = [True, *(n > 1 and k == n and draw(st.booleans()) for k in range(1, n + 1))]
    windows, ready, due = {}, [draw(st.integers(0, 9))], [draw(st.integers(10, LAST))]
    for site in range(1, n + 1):
        cuts = sorted(draw(st.lists(ends, min_size=2, max_size=6, unique=True)))
        if not depot[site] and draw(st.booleans()):
            windows[site] = list(zip(cuts[::2], cuts[1::2], strict=False))
        ready, due = [*ready, cuts[0]], [*due, cuts[-1]]
    service = [draw(few), *(draw(few) for _ in range(n))]
    sites = Sites.of("oabcd"[: n + 1], depot=depot, windows=windows, ready=ready, due=due, service=service)
    shift = (draw(st.integers(0, 9)), draw(st.integers(12, LAST)))
    vehicle = VehicleType(1, shift=shift, reloads=(n,) if depot[n] else (), max_duration=draw(st.integers(15, LAST)))
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix, closing=closes), [vehicle]), Route(tuple(range(1, n + 1)))


def driven(problem, route, departure):
    """When the route is back, None if somebody is late: stops begin at any moment, after any wait."""
    s, closes = problem.sites, problem.travel.closing
    begins, vehicle = {departure}, problem.fleet[0]
    stops = [vehicle.start, *route.visits, vehicle.end]
    for k, (i, j) in enumerate(itertools.pairwise(stops)):
        leaves = {t + (int(s.service[i]) if k else 0) for t in begins}
        arrivals = {t + int(problem.travel.durations[i, j]) for t in leaves if t <= closes[i, j]}
        if k == len(stops) - 2:
            return min((t for t in arrivals if t <= min(s.due[j], vehicle.shift[1])), default=None)
        listed = (s.windows and s.windows[j]) or [(s.ready[j], s.due[j])]
        begins = {t for t in range(LAST + 1) if any(a <= t <= b for a, b in listed) and any(t >= at for at in arrivals)}


@given(timed_routes())
def test_the_shortest_duration_is_the_least_over_all_departures(case):
    problem, route = case
    plan, vehicle = schedule(problem, route), problem.fleet[0]
    opens = int(opening(problem, vehicle))
    returns = {t: driven(problem, route, t) for t in range(opens, max(opens, int(problem.sites.due[0])) + 1)}
    lasts = {t: end - t for t, end in returns.items() if end is not None}
    broken = {v.check for v in problem.evaluate(Routes((route,))).violations}
    assert not broken & {"time-windows", "closing-moves"} or not lasts
    if not lasts:
        assert broken
        return
    assert plan.duration == min(lasts.values())
    assert ("duration" in broken) == (plan.duration > vehicle.max_duration)
    # The departure has it, and of those the first return.
    assert lasts[plan.departure] == plan.duration
    assert returns[plan.departure] == min(returns[t] for t, length in lasts.items() if length == plan.duration)
    late = schedule(problem, route, plan.departure)
    assert (late.departure, late.duration, late.finish) == (plan.departure, plan.duration, returns[plan.departure])


@pytest.mark.parametrize("departure", [0.0, 3.0])
def test_a_later_departure_moves_all_that_follows(departure):
    assert schedule(line(), Route((1, 2)), departure).begin.tolist() == [departure + 1, departure + 2]
