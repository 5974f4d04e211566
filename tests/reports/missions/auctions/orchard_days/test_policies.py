"""Which bins robots choose and where they bring new ones, step by step."""

import numpy as np
import pytest
from orchard_cases import SCHEDULES, retrievals

from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.auctions.orchard_rules import OrchardRules, Trip
from waybound.instances.auctions.worlds.orchard import OrchardObservation
from waybound.reports.missions.auctions.orchard_days.policies import CHOOSING, costs, trips


def observation(robots, bins, remaining, requests=(), wanting=(), rows=5):
    grid = OrchardGrid(rows, 10)
    wants = np.zeros(grid.size, bool)
    wants[grid.cells([*requests, *wanting])] = True
    return OrchardObservation(
        0, OrchardRules(grid, len(robots), 4), np.arange(len(robots)), grid.cells(robots), np.arange(len(bins)), grid.cells(bins),
        np.array(remaining), wants, grid.cells(requests), np.zeros(len(robots), int),
    )  # fmt: skip


def event_driven(problem, choice):
    """Retrievals alone: whenever a robot is idle, it chooses among the bins that nobody fetches; last step, and sum of all."""
    jobs = problem.jobs
    grid, robots = jobs.grid, jobs.num_robots
    cells, free = jobs.robot_cells.copy(), jobs.robot_free.copy()
    left, home, t = list(range(jobs.num_bins)), [], 0
    while left:
        idle = [r for r in range(robots) if free[r] <= t]
        if idle:
            o = OrchardObservation(
                t, OrchardRules(grid, robots, 1), np.array(idle), cells[idle], np.array(left), jobs.bin_cells[left],
                np.maximum(0, jobs.work[left] - t), np.zeros(grid.size, bool), np.zeros(0, int), free,
            )  # fmt: skip
            taken = CHOOSING[choice](o, "later")
            for robot, row in taken.items():
                k = left[row]
                picked = max(t + grid.empty_times[cells[robot], jobs.bin_cells[k]], jobs.work[k])
                free[robot], cells[robot] = picked + jobs.home[k], grid.home
                home.append(int(free[robot]))
            left = [k for row, k in enumerate(left) if row not in taken.values()]
        t += 1
    return max(home), sum(home)


@pytest.mark.parametrize(
    ("name", "nearest", "auction"),
    [
        ("S1", (9, 15), (9, 15)), ("S2", (18, 44), (24, 42)), ("S3", (32, 85), (32, 85)), ("S4", (8, 11), (8, 11)),
        ("S5", (19, 42), (19, 39)),
    ],
)  # fmt: skip
def test_schedules_of_the_reference(name, nearest, auction):
    problem = retrievals(*SCHEDULES[name][:3])
    assert event_driven(problem, "greedy") == nearest
    assert event_driven(problem, "auction") == auction


def test_costs_are_the_later_of_travel_and_filling_or_their_sum():
    o = observation([(0, 0), (0, 6)], [(0, 2), (1, 2)], [0, 3])
    assert costs(o, "later").tolist() == [[1, 3], [2, 5]]
    assert costs(o, "sum").tolist() == [[1, 5], [2, 8]]


def test_an_auction_may_cost_more_than_the_assignment():
    o = observation([(0, 0), (0, 6)], [(0, 2), (1, 2)], [0, 0])
    assert (CHOOSING["auction"](o, "later"), CHOOSING["assignment"](o, "later")) == ({0: 0, 1: 1}, {0: 1, 1: 0})


def test_the_greedy_prefers_full_bins_then_the_soonest_full():
    o = observation([(0, 0)] * 3, [(0, 1), (0, 8), (0, 7)], [1, 0, 2])
    assert CHOOSING["greedy"](o, "later") == {0: 1, 1: 0, 2: 2}


def test_the_baseline_brings_bins_only_without_one_to_fetch_and_to_the_earliest_request():
    o = observation([(0, 0), (0, 0), (0, 3)], [(0, 2)], [0], requests=[(4, 8), (0, 1)], wanting=[(0, 2)])
    assert trips(o, {0: 0}, "baseline") == {0: Trip(-1, 0), 1: Trip(48, -1), 2: Trip(-1, -1)}


def test_the_proposed_rule_brings_bins_to_where_it_fetches_or_near_there():
    o = observation([(0, 0), (0, 0), (0, 0)], [(0, 2), (0, 5)], [0, 0], requests=[(4, 8), (0, 7), (0, 1)], wanting=[(0, 2)])
    assert trips(o, {0: 0, 1: 1}, "proposed") == {0: Trip(2, 0), 1: Trip(7, 1), 2: Trip(1, -1)}


def test_robots_in_the_field_bring_nothing_and_stay_if_they_may():
    o = observation([(0, 3), (2, 2)], [(0, 2)], [4], requests=[(0, 1)])
    assert trips(o, {0: 0}, "proposed", returning=False) == {0: Trip(-1, 0)}
