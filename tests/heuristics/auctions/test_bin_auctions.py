"""Whether costs are like those of travel, assignments that are completed, and auctions that are cut short."""

from __future__ import annotations

import numpy as np
import pytest
from bin_assignments import random_costs, worked
from draws import draws

from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.auctions._bin_auctions import completed, quadrangle
from waybound.heuristics.heuristic import HEURISTICS, Context
from waybound.solvers.linear_programs import linear_programs


def test_the_quadrangle_inequality_is_told_from_all_four_corners() -> None:
    rng = np.random.default_rng(51)
    seen = set()
    for _ in range(draws(150)):
        n, m = rng.integers(1, 5, 2)
        costs = rng.integers(1, 8, (n, m)).astype(float)
        i, k, j, l = np.ix_(range(n), range(n), range(m), range(m))  # noqa: E741
        holds = bool((costs[i, j] <= costs[i, l] + costs[k, l] + costs[k, j]).all())
        assert quadrangle(BinAssignment.from_matrix(costs), NEVER) is holds
        seen.add(holds)
    assert seen == {True, False}


def test_points_of_a_line_keep_it_in_spite_of_rounding() -> None:
    points = np.cumsum(np.full(12, 0.1))
    assert quadrangle(BinAssignment.from_matrix(np.abs(points[::2, None] - points[1::2])), NEVER)


def test_as_many_pairs_as_possible_and_few_changes() -> None:
    rng = np.random.default_rng(52)
    for _ in range(draws(60)):
        problem = BinAssignment.from_matrix(random_costs(rng, 6))
        answer, changed = completed(problem, np.full(problem.num_robots, -1), NEVER)
        assert problem.evaluate(answer).feasible and changed == problem.pairs
        assert completed(problem, np.array(answer), NEVER) == (answer, 0)


@pytest.mark.parametrize("heuristic", ["auction", "bertsekas", "online-greedy"])
def test_who_is_cut_short_hands_over_as_many_pairs_as_there_can_be(heuristic: str) -> None:
    problem, stop = worked("K4"), Stop()
    stop.ask()
    context = Context(np.random.default_rng(1), 10.0, None, lambda answer: None, stop, linear_programs(None, 1, 1))
    found = HEURISTICS[heuristic].run(problem, context)
    assert problem.evaluate(found.answer).feasible and found.guarantee is None and "any of the most pairs" in found.message
    assert found.limit == "interrupt"
