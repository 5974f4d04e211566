"""The checkers' own list of moves that may follow each other, against a plain one."""

from __future__ import annotations

import math

import numpy as np
import pytest
import risky_cases as cases

from waybound.formulations.risk.checking import following_moves as module
from waybound.formulations.risk.checking.following_moves import following_moves
from waybound.formulations.risk.risky_path import hazard_of


@pytest.mark.parametrize("seed", range(3))
def test_all_pairs_with_the_hazard_of_the_second_move(seed):
    problem = cases.random_map(np.random.default_rng(seed))
    graph = problem.graph
    moves = list(zip(graph.tail.tolist(), graph.head.tolist(), strict=True))
    expected = {(-1, b): moves[b] for b in range(len(moves)) if moves[b][0] == 0}
    for a, (i, j) in enumerate(moves):
        for b, (k, z) in enumerate(moves):
            if j == k and z != i and 0 not in (j, z):
                expected[a, b] = i, j, z
    found = following_moves(graph)
    assert set(zip(found.earlier.tolist(), found.later.tolist(), strict=True)) == set(expected)
    for a, b, hazard in zip(found.earlier.tolist(), found.later.tolist(), found.hazard.tolist(), strict=True):
        last = [column[-1] for column in problem.risks(expected[a, b]).values()]
        assert hazard == pytest.approx(hazard_of(last))
    assert found.start_hazard == pytest.approx(hazard_of([column[0] for column in problem.risks((0,)).values()]))


def test_a_choice_of_elements_and_too_many_pairs(monkeypatch):
    problem = cases.mud()
    assert following_moves(problem.graph, ()).hazard.sum() == 0.0
    assert math.isfinite(following_moves(problem.graph).hazard.sum())
    monkeypatch.setattr(module, "MOST_PAIRS", 1)
    assert following_moves(problem.graph) is None
