import itertools
from pathlib import Path

import numpy as np
import pytest
from file_cases import check_refused
from program_text import expected, program_text
from task_problems import best_partition_value, drawn, parts

from waybound import BalancedPartition, InputError, UnsupportedError
from waybound.formulations.problem import problem_from_instance
from waybound.instances.reading import read_instance
from waybound.solvers.backend import Control, Options, solver_named

KINDS = list(itertools.product(("min-max", "min-difference"), ("clique", "none")))


@pytest.mark.parametrize(("objective", "edges"), KINDS)
def test_every_partition_is_a_point_at_its_value(objective, edges):
    rng = np.random.default_rng(10)
    for _ in range(8):
        problem = BalancedPartition(drawn(rng), objective, edges)
        owners = rng.integers(0, problem.num_robots, problem.num_tasks)
        answer = tuple(tuple(np.nonzero(owners == r)[0].tolist()) for r in range(problem.num_robots))
        made = problem.compile("part-choice")
        vector = made.encode(answer)
        assert made.program.residual(vector) <= 1e-12
        assert made.program.value(vector) == pytest.approx(problem.evaluate(answer).values[0], rel=1e-12, abs=1e-12)
        assert made.decode(vector) == answer


@pytest.mark.parametrize(("objective", "edges"), KINDS)
def test_its_optimum_is_that_of_the_problem(objective, edges):
    rng = np.random.default_rng(11)
    for _ in range(3):
        problem = BalancedPartition(drawn(rng, tasks=5), objective, edges)
        made = problem.compile()
        found = solver_named("highs").run(made.program, Options(time_limit=20.0), Control())
        assert found.status == "optimal"
        assert problem.evaluate(made.decode(found.answer)).values[0] == pytest.approx(best_partition_value(problem), abs=1e-6)


def test_trees_are_not_its_matter_and_no_partition_is_no_point():
    check_refused(UnsupportedError, "edges:mst", parts([0, 1, 2]).compile, "part-choice")
    check_refused(InputError, "nobody does task 3", parts([0, 1, 2], edges="none").compile().encode, ((0,), (1,)))


def test_part_choice_from_text_to_text(tmp_path: Path) -> None:
    """Two tasks in two parts, their pair of distance 2, and costs in parts of the largest weight, 4."""
    (tmp_path / "t.csv").write_text("role,name,x,y,weight\nrobot,r,0,0,\nrobot,s,9,0,\ntask,a,0,0,4\ntask,b,2,0,-1\n")
    instance = read_instance(tmp_path / "t.csv")
    problem = problem_from_instance(instance, "balanced-partition", edges="clique", objective="min-difference")
    assert program_text(problem.compile("part-choice").program) == expected("""
        min 4 t - 4 s
        share[a]: y[a,r] + y[a,s] = 1
        share[b]: y[b,r] + y[b,s] = 1
        most[r]: y[a,r] - 0.25 y[b,r] + 0.5 z[a,b,r] - t <= 0
        most[s]: y[a,s] - 0.25 y[b,s] + 0.5 z[a,b,s] - t <= 0
        pair[a,b,r]: y[a,r] + y[b,r] - z[a,b,r] <= 1
        pair[a,b,s]: y[a,s] + y[b,s] - z[a,b,s] <= 1
        least[r]: y[a,r] - 0.25 y[b,r] + 0.5 z[a,b,r] - s >= 0
        least[s]: y[a,s] - 0.25 y[b,s] + 0.5 z[a,b,s] - s >= 0
        first[a,b,r]: - y[a,r] + z[a,b,r] <= 0
        first[a,b,s]: - y[a,s] + z[a,b,s] <= 0
        second[a,b,r]: - y[b,r] + z[a,b,r] <= 0
        second[a,b,s]: - y[b,s] + z[a,b,s] <= 0
        y[a,r], y[a,s], y[b,r], y[b,s], z[a,b,r], z[a,b,s] binary
        -0.25 <= t, s <= 1.5
    """)
