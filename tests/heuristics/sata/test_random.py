from collections import Counter

import numpy as np
import pytest
from hypothesis import given, strategies as st
from selection_problems import CONSTRAINTS, KINDS, cover_30, random_problem, run

from waybound import BottleneckSATA, Coverage, Knapsack, PartitionMatroid, Selection, SensingGraph, SubmodularSelection, WinnerTakesAllSATA


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from(CONSTRAINTS))
def test_answers_are_feasible_and_nothing_more_fits(seed: int, kind: str, constraint: str) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, constraint)
    outcome = run("random", problem, seed=seed)
    assert outcome.guarantee is None
    for other in set(range(problem.num_elements)) - set(outcome.answer):
        if not (isinstance(problem.constraint, Knapsack) and problem.constraint.costs[other] <= 1e-6):
            assert not problem.evaluate(Selection((*outcome.answer.elements, other))).feasible


@pytest.mark.parametrize("make", [BottleneckSATA, WinnerTakesAllSATA])
def test_each_robot_takes_each_of_its_actions_equally_often(make: type) -> None:
    graph = SensingGraph.from_edges([0, 0, 0, 1, 1], range(5), [0] * 5)
    counts: Counter[int] = Counter()
    for seed in range(600):
        chosen = run("random", make(graph), seed=seed).answer
        assert [int(graph.robot_of_action[a]) for a in chosen] == [0, 1]
        counts.update(chosen)
    assert all(abs(counts[a] - 200) < 60 for a in (0, 1, 2))
    assert all(abs(counts[a] - 300) < 60 for a in (3, 4))


def test_full_sets_of_a_group_come_equally_often() -> None:
    problem = SubmodularSelection(Coverage.from_sets([[0]] * 4, [1.0]), PartitionMatroid.of([0, 0, 0, 0], [2]))
    counts = Counter(frozenset(run("random", problem, seed=seed).answer) for seed in range(600))
    assert len(counts) == 6 and all(abs(n - 100) < 45 for n in counts.values())


def test_the_seed_decides() -> None:
    answers = {seed: run("random", cover_30(6), seed=seed).answer for seed in range(5)}
    assert answers == {seed: run("random", cover_30(6), seed=seed).answer for seed in range(5)}
    assert len(set(answers.values())) > 1
