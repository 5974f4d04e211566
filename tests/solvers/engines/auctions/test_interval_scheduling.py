import numpy as np
import pytest
from orchard_cases import random_jobs, retrievals

import waybound as wb
from waybound import OrchardDay, OrchardJobs, UnsupportedError
from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.solvers.backend import BACKENDS, Control, Options


def test_it_is_the_default_and_repeats():
    jobs = random_jobs(np.random.default_rng(3), robots=3, bins=8)
    first, second = (wb.solve(OrchardDay(jobs), seed=4, bound_time=0) for _ in range(2))
    assert first.solver == "interval-scheduling"
    assert first.answer == second.answer


def test_it_keeps_the_best_when_it_is_stopped():
    rng = np.random.default_rng(8)
    problem = OrchardDay(random_jobs(rng, robots=4, bins=40))
    control = Control()
    control.stop()
    made = BACKENDS["interval-scheduling"]().run(problem, Options(time_limit=60.0), control)
    assert made.limit in ("interrupt", "none")
    assert problem.evaluate(made.answer).feasible
    found = wb.solve(problem, time_limit=0.5, bound_time=0)
    assert found.status in ("feasible", "optimal")
    assert found.certificate.feasible
    assert found.objective <= problem.evaluate(problem.answer_at_hand()).objective


def test_a_robot_empty_that_is_slower_than_full():
    grid = OrchardGrid(1, 6, 0, 1, 3)
    jobs = OrchardJobs(grid, np.array([0, 0]), np.zeros(2, int), np.array([4]), np.array([-1]), np.array([False]), np.array([0]))
    assert wb.solve(OrchardDay(jobs), bound_time=0).objective == 6.0


def test_what_it_cannot_take_is_told():
    count = 201
    problem = retrievals(((0, 2),) * count, (0,) * count)
    with pytest.raises(UnsupportedError, match="more than 200 bins"):
        wb.solve(problem, "interval-scheduling")
    assert wb.solve(problem, heuristic="list-schedule").certificate.feasible
