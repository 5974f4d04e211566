import numpy as np
import pytest
from task_problems import OBJECTIVES, drawn

import waybound as wb
from waybound.formulations.auctions.task_allocation import TaskAllocation
from waybound.formulations.stop import NEVER
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.solvers.engines.auctions.task_subsets import best_paths


def test_around_a_cluster_it_sends_everybody():
    cross = np.array([(1, 0), (-1, 0), (0, 1), (0, -1)], dtype=float)
    problem = TaskAllocation(wb.RobotTasks.of_positions(cross, 0.01 * cross))
    found = run_heuristic(problem, "parallel-auction", {}, 1)
    assert problem.value(found.answer) == pytest.approx(3.96, abs=1e-12)
    assert best_paths(problem, NEVER)[1] == pytest.approx(1.0324, abs=1e-4)
    together = run_heuristic(problem, "sequential-single-item", {}, 1)
    assert problem.value(together.answer) == pytest.approx(1.0324, abs=1e-4)
    assert found.guarantee is None and found.statistics == {"rounds": 1, "bids": 16}


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_its_answers_are_answers(objective):
    rng = np.random.default_rng(1)
    for k in range(20):
        problem = TaskAllocation(drawn(rng, robots=4, tasks=8, matrix=k % 2 == 1), objective)
        assert problem.evaluate(run_heuristic(problem, "parallel-auction", {}, 1).answer).feasible
