"""The form of parts: its optimum is that of the problem, every partition is a point of it at its value, and back."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from task_problems import best_partition_value, drawn, parts

from waybound.formulations.auctions.balanced_partition import BalancedPartition
from waybound.instances.errors import InputError, UnsupportedError
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
    with pytest.raises(UnsupportedError, match="edges:mst"):
        parts([0, 1, 2]).compile("part-choice")
    with pytest.raises(InputError, match="nobody does task 3"):
        parts([0, 1, 2], edges="none").compile().encode(((0,), (1,)))
