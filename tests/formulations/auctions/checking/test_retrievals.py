"""Evidence of retrievals."""

from __future__ import annotations

import numpy as np
import pytest
from orchard_cases import retrievals

import waybound as wb
from waybound.formulations.auctions.orchard_day import OrchardDay
from waybound.formulations.evidence import CHECKERS
from waybound.instances.auctions.orchard_jobs import OrchardJobs
from waybound.instances.errors import InputError

check = CHECKERS["retrievals"]


def test_steps_shared_by_robots_and_the_earliest_of_each_bin():
    assert check(retrievals(((0, 2), (1, 1), (0, 4)), (0, 0, 0)), {}) == 6.0  # (3 + 3 + 6) / 2
    assert check(retrievals(((0, 1), (0, 8), (4, 8)), (5, 0, 0)), {}) == 18.0  # the farthest
    assert check(retrievals(((0, 1),), (50,)), {}) == 51.0
    assert check(retrievals(((0, 2), (1, 1), (0, 4)), (0, 0, 0), objective="completion"), {}) == 15.0  # 3 + 3 + (3 + 6)


def test_a_robot_that_is_busy_for_long_shares_nothing():
    problem = retrievals(((0, 2), (1, 1), (0, 4)), (0, 0, 0))
    jobs = problem.jobs
    busy = OrchardJobs(jobs.grid, jobs.robot_cells, np.array([0, 100]), jobs.bin_cells, jobs.after, jobs.standing, jobs.work)
    assert check(OrchardDay(busy), {}) == 12.0
    some = OrchardJobs(jobs.grid, jobs.robot_cells, np.array([0, 4]), jobs.bin_cells, jobs.after, jobs.standing, jobs.work)
    assert check(OrchardDay(some), {}) == 8.0
    assert wb.solve(OrchardDay(busy), bound_time=0).objective == 12.0


def test_a_robot_in_the_field_saves_a_way_once():
    assert check(retrievals(((0, 6), (0, 6)), (0, 0), ((0, 6),)), {}) == 15.0  # 6 + 9, not 9 + 9
    assert wb.solve(retrievals(((0, 6), (0, 6)), (0, 0), ((0, 6),)), bound_time=0).objective == 15.0


def test_data_and_other_problems_are_refused():
    with pytest.raises(InputError, match="holds no data"):
        check(retrievals(((0, 2),), (0,)), {"steps": 3})
    with pytest.raises(InputError, match="orchard-day problems"):
        check(wb.generate("sata", seed=1), {})
