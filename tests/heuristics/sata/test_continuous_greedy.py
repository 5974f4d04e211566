import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from selection_problems import KINDS, context, cover_30, cover_tight, half_tight, only_evidence, optimum, random_problem, run, value

from waybound import Cardinality, Coverage, DenseFacilityLocation, PartitionMatroid, SubmodularSelection, UsageError
from waybound.formulations.verified_bounds import verified_bound
from waybound.heuristics.heuristic import HEURISTICS


@given(st.integers(0, 10**6), st.sampled_from(KINDS[:4]), st.sampled_from(["cardinality", "partition"]), st.sampled_from([1, 2, 7, 40]))
def test_answers_keep_the_guarantee_of_their_steps_and_rounding_loses_nothing(seed: int, kind: str, constraint: str, steps: int) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, constraint)
    outcome, best = run("continuous-greedy", problem, steps=steps), optimum(problem)
    reached, expected = value(problem, outcome), outcome.statistics["fractional_value"]
    share = 1 - (1 + 1 / steps) ** -steps
    assert outcome.guarantee is not None and outcome.guarantee.ratio == pytest.approx(1 / share)
    assert expected >= share * best * (1 - 1e-9)
    assert reached >= expected * (1 - 1e-9)
    assert verified_bound(problem, only_evidence(outcome)) >= best * (1 - 1e-9)
    assert len(outcome.answer) == sum(1 for _ in run("greedy", problem).answer)


@pytest.mark.parametrize("copies", [1, 4])
def test_it_passes_one_minus_one_over_e_where_greedy_stays_at_half(copies: int) -> None:
    problem = half_tight(copies=copies, excess=1e-6)
    best = copies * (2 + 1e-6)
    assert value(problem, run("greedy", problem)) / best < 0.5001
    outcome = run("continuous-greedy", problem)
    assert outcome.statistics["fractional_value"] / best > 1 - math.exp(-1)
    assert value(problem, outcome) / best > 1 - math.exp(-1)


def test_one_step_is_greedy() -> None:
    for problem in (cover_tight(), cover_30(6), half_tight(3)):
        once = run("continuous-greedy", problem, steps=1)
        assert set(once.answer.elements) == set(run("greedy", problem).answer.elements)
        assert once.statistics["trades"] == 0
        assert once.guarantee is not None and once.guarantee.ratio == pytest.approx(2.0)


def test_the_statement_tells_what_the_steps_cost() -> None:
    guarantee = run("continuous-greedy", cover_tight(), steps=100).guarantee
    assert guarantee is not None and "0.6302 f(OPT)" in guarantee.statement and "less 0.0018 for steps of 1/100" in guarantee.statement
    assert guarantee.ratio > 1 / (1 - math.exp(-1))


def test_it_is_deterministic() -> None:
    assert run("continuous-greedy", cover_30(6), seed=1).answer == run("continuous-greedy", cover_30(6), seed=2).answer


def test_without_time_there_is_an_answer_but_no_guarantee() -> None:
    outcome = HEURISTICS["continuous-greedy"].run(cover_30(6), context(seconds=0.0), steps=1_000_000)
    assert cover_30(6).evaluate(outcome.answer).feasible and len(outcome.answer) == 6
    assert outcome.guarantee is None
    assert "the time was up" in outcome.message


def test_groups_without_room_and_empty_ground_sets() -> None:
    closed = SubmodularSelection(Coverage.from_sets([[0], [1]], [1.0, 2.0]), PartitionMatroid.of([0, 1], [0, 1]))
    assert run("continuous-greedy", closed).answer.elements == (1,)
    nothing = SubmodularSelection(Coverage.from_sets([], []), Cardinality(3))
    assert run("continuous-greedy", nothing).answer.elements == ()


def test_a_matrix_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("waybound.heuristics.sata.continuous_greedy.MOST_ENTRIES", 5)
    with pytest.raises(UsageError, match="at most 5 positive weights, not 6"):
        run("continuous-greedy", SubmodularSelection(DenseFacilityLocation(np.ones((3, 2))), Cardinality(1)))
