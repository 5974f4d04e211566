import numpy as np
import pytest
from draws import draws
from orchard_cases import SCHEDULES, random_jobs, retrievals

import waybound as wb
from waybound import OrchardDay, OrchardJobs
from waybound.instances.auctions.orchard_grid import OrchardGrid


@pytest.mark.parametrize(("name", "nearest"), [("S1", 9), ("S3", 32)])
def test_schedules_of_the_reference(name, nearest):
    places, full, _, _, longest, total = SCHEDULES[name]
    for order, value in (("nearest", nearest), ("longest", longest)):
        found = wb.solve(retrievals(places, full), heuristic="list-schedule", order=order)
        assert found.objective == value
        assert found.certificate.observed_ratio <= found.certificate.guarantee.ratio + 1e-12
    assert wb.solve(retrievals(places, full, objective="completion"), heuristic="list-schedule").objective == total


@pytest.mark.parametrize("name", ["S2", "S4", "S5"])
def test_the_longest_first_is_at_the_optimum_of_other_schedules_of_the_reference(name):
    places, full, robots, _, last, _ = SCHEDULES[name]
    assert wb.solve(retrievals(places, full, robots), heuristic="list-schedule", order="longest", bound_time=0).objective == last


def test_guarantees_hold():
    rng = np.random.default_rng(2)
    for _ in range(draws(40)):
        count, robots = int(rng.integers(1, 8)), int(rng.integers(1, 4))
        places = np.column_stack([rng.integers(0, 5, count), rng.integers(1, 9, count)])
        for objective, orders in (("makespan", ("nearest", "longest")), ("completion", ("nearest",))):
            problem = retrievals(places, np.zeros(count, int), ((0, 0),) * robots, objective)
            best = wb.solve(problem, bound_time=0).objective
            for order in orders:
                found = wb.solve(problem, heuristic="list-schedule", order=order, bound_time=0)
                assert found.objective <= found.certificate.guarantee.ratio * best * (1 + 1e-12)


@pytest.mark.parametrize(
    ("robots", "cells", "objective", "order", "best"),
    [
        (1, (10, 1), "completion", "nearest", 19.0), (2, (1, 1, 1, 1, 1, 10), "makespan", "longest", 15.0),
        (2, (1, 1, 1, 1, 1, 10), "makespan", "nearest", 15.0),
    ],
)  # fmt: skip
def test_guarantees_hold_where_full_bins_were_filled_one_after_the_other(robots, cells, objective, order, best):
    grid, count = OrchardGrid(1, 12), len(cells)
    jobs = OrchardJobs(
        grid, np.full(robots, grid.home), np.zeros(robots, int), np.array(cells), np.arange(-1, count - 1), np.ones(count, bool),
        np.zeros(count, int),
    )  # fmt: skip
    found = wb.solve(OrchardDay(jobs, objective), heuristic="list-schedule", order=order, bound_time=0)
    assert best <= found.objective <= found.certificate.guarantee.ratio * best


def test_two_thirds_more_is_attained():
    found = wb.solve(retrievals(((0, 2), (1, 1), (0, 4)), (0, 0, 0)), heuristic="list-schedule")
    assert found.certificate.observed_ratio == pytest.approx(2 - 1 / 2)


def test_nothing_is_guaranteed_where_robots_wait_or_bring_bins():
    assert wb.solve(retrievals(((0, 1), (0, 8)), (5, 0)), heuristic="list-schedule").certificate.guarantee is None
    rng = np.random.default_rng(9)
    for _ in range(draws(20)):
        problem = OrchardDay(random_jobs(rng, robots=2, bins=6))
        for order in ("nearest", "longest"):
            assert wb.solve(problem, heuristic="list-schedule", order=order).certificate.feasible
