import math

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st

import waybound as wb
from waybound.formulations.arrays.exchange_schedule import Aloft, ExchangeCase, Sortie, faults, uncovered
from waybound.heuristics.arrays._exchanges import exchange_program, feasible, one_by_one, robots_for_ever, scheduled


def all_days(case, robot):
    """Coverage as a set of (place, step) with the fewest takeoffs of each day that a robot can fly."""
    last = int(case.end.max())
    best = {}

    def go_on(free, seen, takeoffs):
        best[seen] = min(best.get(seen, 99), takeoffs)
        for takeoff in range(free, last):
            for place, way in enumerate(case.travel[robot].tolist()):
                for leave in range(takeoff + way + 1, min(takeoff + case.flight - way, last) + 1):
                    steps = {(place, step) for step in range(takeoff + way, leave) if case.begin[place] <= step < case.end[place]}
                    if steps:
                        go_on(leave + way + case.charge, seen | frozenset(steps), takeoffs + 1)

    if robot not in case.aloft:
        go_on(int(case.ready[robot]), frozenset(), 0)
        return best
    place, takeoff, arrive = case.aloft[robot]
    way, here = int(case.travel[robot, place]), max(arrive, 0)
    for leave in range(here, max(here, min(takeoff + case.flight - way, last)) + 1):
        steps = {(place, step) for step in range(here, leave) if case.begin[place] <= step < case.end[place]}
        go_on(leave + way + case.charge, frozenset(steps), 0)
    return best


def fewest(case):
    """The fewest steps at which a place is alone, and the fewest takeoffs with these, over all schedules."""
    every = {(place, step) for place in range(len(case.end)) for step in range(int(case.begin[place]), int(case.end[place]))}
    team = {frozenset(): 0}
    for robot in range(len(case.ready)):
        days, joint = all_days(case, robot), {}
        for seen, takeoffs in team.items():
            for own, more in days.items():
                joint[seen | own] = min(joint.get(seen | own, 99), takeoffs + more)
        team = joint
    return min((len(every - seen), takeoffs) for seen, takeoffs in team.items())


@st.composite
def tiny_cases(draw):
    robots, places = draw(st.integers(1, 3)), draw(st.integers(1, 2))
    last, flight = draw(st.integers(3, 6)), draw(st.integers(3, 5))
    number = lambda low, high, size: np.array(draw(st.lists(st.integers(low, high), min_size=size, max_size=size)), dtype=np.int64)  # noqa: E731
    travel = np.minimum(number(1, 2, robots * places).reshape(robots, places), (flight - 1) // 2)
    begin = number(0, 3, places)
    aloft = {0: Aloft(draw(st.integers(0, places - 1)), -1, int(draw(st.integers(-1, 1))))} if draw(st.booleans()) else {}
    if aloft:  # it arrives after the way that it has
        aloft = {0: aloft[0]._replace(arrive=-1 + int(travel[0, aloft[0].place]))}
    return ExchangeCase(travel, flight, draw(st.integers(0, 3)), number(0, 2, robots), begin, np.maximum(begin, last), aloft)


@settings(max_examples=draws(60))
@given(tiny_cases())
def test_the_program_finds_the_fewest_and_one_by_one_is_no_better(case):
    program, columns = exchange_program(case)
    answer = wb.solve(program, solver="highs").answer
    exact, simple = scheduled(case, columns, np.asarray(answer)), one_by_one(case)
    assert faults(case, exact) == [] and faults(case, simple) == []
    alone, takeoffs = fewest(case)
    assert (uncovered(case, exact), len(exact) - len(case.aloft)) == (alone, takeoffs)
    assert (uncovered(case, simple), len(simple) - len(case.aloft)) >= (alone, takeoffs)


@pytest.mark.parametrize("solver", ["highs", "cpsat"])
def test_nearest_robots_are_not_the_fewest(solver):
    """The nearest robot is taken for the first place, though it alone reaches the second one."""
    case = ExchangeCase(
        np.array([[1, 1], [2, 5]]), 8, 50, np.array([0, 0]), np.array([2, 5]), np.array([6, 9]),
    )  # fmt: skip
    simple = one_by_one(case)
    assert simple[0] == Sortie(0, 0, 2, 6) and uncovered(case, simple) == 4
    program, columns = exchange_program(case)
    exact = scheduled(case, columns, np.asarray(wb.solve(program, solver=solver).answer))
    assert faults(case, exact) == [] and (uncovered(case, exact), len(exact)) == (0, 2)


def test_robots_needed_at_one_instant_are_matched_by_all_ways_together():
    """One after the other, the first place would take the robot next to it, and the second would wait for one far off."""
    case = ExchangeCase(np.array([[1, 2], [2, 5]]), 12, 9, np.array([0, 0]), np.array([5, 5]), np.array([9, 9]))
    assert sorted(one_by_one(case)) == [Sortie(0, 1, 5, 9), Sortie(1, 0, 5, 9)]


def test_exchanges_are_as_late_as_the_way_home_allows():
    case = ExchangeCase(np.full((4, 1), 2), 10, 100, np.zeros(4, dtype=np.int64), np.array([2]), np.array([20]))
    assert [(s.arrive, s.leave) for s in one_by_one(case)] == [(2, 8), (8, 14), (14, 20)]


@pytest.mark.parametrize(("charge", "flight", "robots"), [(34, 2, 18), (40, 2, 21), (10, 3, 5), (2, 2, 2), (0.5, 1, 2)])
def test_robots_that_sustain_a_job(charge, flight, robots):
    assert robots_for_ever(charge, flight) == robots


def test_the_demonstration_of_the_appendix():
    """30 robots, 2 min of flight, 34 of charging: one job for ever, no second one, and beside it one robot for 24 min."""
    fleet = np.zeros(30, dtype=np.int64)
    assert feasible(fleet, [(1, math.inf)], 2, 34)
    assert not feasible(fleet, [(1, math.inf)] * 2, 2, 34)
    assert feasible(fleet, [(1, math.inf), (1, 24)], 2, 34)
    assert not feasible(fleet, [(1, math.inf), (1, 26)], 2, 34)
    assert not feasible(fleet[:17], [(1, math.inf)], 2, 34)
    assert feasible(fleet[:2], [(2, 2)], 2, 34) and not feasible(fleet[:3], [(2, 4)], 2, 34)
    assert not feasible(np.array([0, 3]), [(1, 4)], 2, 34)  # charged a minute after the second bin begins


@pytest.mark.parametrize("spare", [0, -1])
def test_with_ways_a_job_for_ever_takes_more_robots_than_the_formula_says(spare):
    """A watch is the flight less both ways, so that ``ceil((flight + charge) / watch)`` robots are needed, one by one and in any way."""
    flight, charge, way = 12, 48, 1
    needed = math.ceil((flight + charge) / (flight - 2 * way))
    assert needed == 6 > robots_for_ever(charge, flight) == 5
    assert robots_for_ever(charge + 2 * way, flight - 2 * way) == needed
    robots = needed + spare
    case = ExchangeCase(np.full((robots, 1), way), flight, charge, np.zeros(robots, dtype=np.int64), np.array([1]), np.array([240]))
    assert (uncovered(case, one_by_one(case)) == 0) == (spare == 0)


def test_nothing_to_watch_is_an_empty_schedule():
    case = ExchangeCase(np.array([[1]]), 4, 1, np.array([0]), np.array([3]), np.array([3]))
    program, columns = exchange_program(case)
    assert one_by_one(case) == [] and len(columns) == 0 and program.num_rows == 3
