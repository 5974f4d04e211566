import itertools

import numpy as np
import pytest
from draws import draws
from task_problems import OBJECTIVES, best_partition_value, best_paths_value, drawn, line, parts

import waybound as wb
from waybound import BalancedPartition, RobotTasks, TaskAllocation
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.auctions.task_subsets import MOST_TASKS, PartSubsets, best_paths


def test_its_optimum_is_claimed_and_where_bounds_meet_it_verified():
    star = wb.solve(line([0, 10], [4, 6, 1, 9], "mini-max"), bound_time=60.0)
    assert (star.solver, star.status, star.objective) == ("task-subsets", "optimal", 4.0)
    proved = wb.solve(line([0, 10], [1, 9]), bound_time=60.0)
    assert (proved.objective, proved.bound_kind) == (2.0, "verified")


def test_other_solvers_agree():
    problem = wb.TaskAllocation(drawn(np.random.default_rng(1), tasks=4), "mini-ave")
    best = wb.solve(problem, "task-subsets", bound_time=0).objective
    for solver in ("highs", "cpsat", "pulp"):
        found = wb.solve(problem, solver, bound_time=0, time_limit=20)
        assert (found.status, found.objective) == ("optimal", pytest.approx(best, rel=1e-6))


def test_too_many_tasks_are_refused_with_who_can_take_them():
    with pytest.raises(wb.UnsupportedError, match=f"it does not handle more than {MOST_TASKS} tasks; can take it: .*highs"):
        wb.solve(line([0], np.arange(MOST_TASKS + 1)), "task-subsets")


def test_without_time_there_is_no_answer():
    assert wb.solve(line([0, 1], np.arange(MOST_TASKS)), "task-subsets", time_limit=1e-6, bound_time=0).status in ("unknown", "optimal")


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_it_finds_the_best_of_all_paths(objective):
    rng = np.random.default_rng(13)
    for k in range(draws(60)):
        team = drawn(rng, tasks=5, matrix=k % 2 == 1)
        problem = TaskAllocation(team, objective)
        paths, value = best_paths(problem, NEVER)
        verdict = problem.evaluate(paths)
        assert verdict.feasible
        assert verdict.values[0] == pytest.approx(value, rel=1e-13)
        assert value == pytest.approx(best_paths_value(team, objective), rel=1e-13)


@pytest.mark.parametrize(
    ("robots", "tasks", "best"),
    [([0, 10], [4, 6, 1, 9], (7, 4)), ([2, 5], [0, 3, 4], (4, 2)), ([1, 6], [0, 3, 10], (8, 4)), ([0], [10, 0, 10, 0], (10, 10))],
)
def test_optima_by_hand(robots, tasks, best):
    assert tuple(best_paths(line(robots, tasks, o), NEVER)[1] for o in ("mini-sum", "mini-max")) == best


def test_cut_short_it_has_no_answer():
    assert best_paths(line([0, 1], np.arange(MOST_TASKS)), Stop(0.0)) is None


KINDS = list(itertools.product(("min-max", "min-difference"), ("mst", "clique", "none")))


@pytest.mark.parametrize(("objective", "edges"), KINDS)
def test_it_finds_the_best_of_all_partitions(objective, edges):
    rng = np.random.default_rng(14)
    for _ in range(draws(40)):
        problem = BalancedPartition(drawn(rng, robots=4, tasks=5), objective, edges)
        found = PartSubsets().run(problem, Options(), Control())
        verdict = problem.evaluate(found.answer)
        assert verdict.feasible and found.status == "optimal"
        assert verdict.values[0] == pytest.approx(found.objective, abs=1e-12)
        assert found.objective == pytest.approx(best_partition_value(problem), abs=1e-12)


def test_the_two_objectives_have_different_optima():
    line = [0, 1, 2, 6, 7]
    best = {(o, e): wb.solve(parts(line, objective=o, edges=e), bound_time=0).objective for o, e in KINDS if e != "none"}
    assert best == {("min-max", "mst"): 2, ("min-max", "clique"): 4, ("min-difference", "mst"): 0, ("min-difference", "clique"): 3}


def test_weights_alone_are_halved():
    """8, 7, 6, 5, 4: two parts of 15."""
    problem = parts([0] * 5, weights=[8, 7, 6, 5, 4], edges="none", objective="min-difference")
    assert wb.solve(problem, bound_time=0).objective == 0.0


def test_sixteen_tasks_are_not_many():
    rng = np.random.default_rng(15)
    for objective in ("min-max", "min-difference"):
        problem = parts(rng.random((MOST_TASKS, 2)), 4, objective, weights=rng.random(MOST_TASKS))
        assert PartSubsets().run(problem, Options(time_limit=20.0), Control()).status == "optimal"
    with pytest.raises(wb.UnsupportedError, match=f"more than {MOST_TASKS} tasks"):
        wb.solve(parts(np.zeros(MOST_TASKS + 1)), "part-subsets")


def test_a_limit_leaves_an_answer_or_none():
    rng = np.random.default_rng(16)
    problem = parts(rng.random((MOST_TASKS, 2)), 5, "min-difference", weights=rng.random(MOST_TASKS))
    found = PartSubsets().run(problem, Options(time_limit=0.0), Control())
    assert found.limit == "time" and found.status in ("feasible", "unknown")


@pytest.mark.parametrize(
    ("weights", "objective", "status"),
    [
        ((0.1, 0.2, 0.3, 0.4), "min-difference", "feasible"), ((1.0, 2.0, 3.0, 4.0), "min-difference", "optimal"),
        ((0.1, 0.2, 0.3, 0.4), "min-max", "optimal"),
    ],
)  # fmt: skip
def test_a_least_spread_that_rounding_may_hide_is_not_claimed(weights, objective, status):
    between = 1e12 * (1.0 - np.eye(4))
    problem = BalancedPartition(RobotTasks.of_distances(np.zeros((4, 4)), between, weights=weights), objective, "clique")
    found = PartSubsets().run(problem, Options(), Control())
    assert found.status == status and found.objective == problem.evaluate(found.answer).values[0]
