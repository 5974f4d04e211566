from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from coded import coded
from draws import draws
from orchard_cases import random_jobs, retrievals

import waybound as wb
from waybound import InputError, OrchardJobs
from waybound.formulations.auctions.orchard_day import OrchardDay, in_order
from waybound.formulations.evidence import CHECKERS
from waybound.instances.auctions.orchard_grid import OrchardGrid

check = CHECKERS["retrievals"]


def test_steps_shared_by_robots_and_the_earliest_of_each_bin():
    assert check(retrievals(((0, 2), (1, 1), (0, 4)), (0, 0, 0)), {}) == 6.0  # (3 + 3 + 6) / 2
    assert check(retrievals(((0, 1), (0, 8), (4, 8)), (5, 0, 0)), {}) == 18.0  # the farthest
    assert check(retrievals(((0, 1),), (50,)), {}) == 51.0
    assert check(retrievals(((0, 2), (1, 1), (0, 4)), (0, 0, 0), objective="completion"), {}) == 15.0  # 3 + 3 + (3 + 6)


def test_a_robot_that_is_busy_for_long_shares_nothing():
    jobs = retrievals(((0, 2), (1, 1), (0, 4)), (0, 0, 0)).jobs
    busy = OrchardJobs(jobs.grid, jobs.robot_cells, np.array([0, 100]), jobs.bin_cells, jobs.after, jobs.standing, jobs.work)
    assert check(OrchardDay(busy), {}) == 12.0
    some = OrchardJobs(jobs.grid, jobs.robot_cells, np.array([0, 4]), jobs.bin_cells, jobs.after, jobs.standing, jobs.work)
    assert check(OrchardDay(some), {}) == 8.0
    assert wb.solve(OrchardDay(busy), bound_time=0).objective == 12.0


def test_a_robot_in_the_field_saves_a_way_once():
    assert check(retrievals(((0, 6), (0, 6)), (0, 0), ((0, 6),)), {}) == 15.0  # 6 + 9, not 9 + 9
    assert wb.solve(retrievals(((0, 6), (0, 6)), (0, 0), ((0, 6),)), bound_time=0).objective == 15.0


@pytest.mark.parametrize(("objective", "best"), [("makespan", 10.0), ("completion", 13.0)])
def test_robots_that_are_faster_with_a_full_bin_fetch_one_on_the_way(objective, best):
    grid = OrchardGrid(1, 8, 0, 1, 3)
    jobs = OrchardJobs(grid, np.array([5]), np.array([0]), np.array([3, 5]), np.array([-1, -1]), np.array([True, False]), np.array([0, 0]))
    problem = OrchardDay(jobs, objective)
    day = problem.evaluate((((-1, 0), (1, 1)),))
    assert day.feasible and day.values == (best,) and check(problem, {}) <= best


def test_no_day_is_over_sooner_whichever_speed_is_the_higher():
    rng = np.random.default_rng(8)
    for _ in range(draws(60)):
        jobs = random_jobs(rng, robots=2, bins=4)
        grid = OrchardGrid(jobs.grid.rows, jobs.grid.columns, 0, int(rng.integers(1, 4)), int(rng.integers(1, 5)))
        jobs = replace(jobs, grid=grid)
        days = [in_order(jobs, order) for order in permutations(range(4)) if all(order.index(k) > order.index(b) for k, b in chained(jobs))]
        for objective in ("makespan", "completion"):
            problem = OrchardDay(jobs, objective)
            assert check(problem, {}) <= min(problem.evaluate(day).values[0] for day in days)


def chained(jobs):
    return [(k, before) for k, before in enumerate(jobs.after.tolist()) if before >= 0]


def test_data_are_refused():
    with pytest.raises(InputError, check=coded("malformed")):
        check(retrievals(((0, 2),), (0,)), {"steps": 3})
