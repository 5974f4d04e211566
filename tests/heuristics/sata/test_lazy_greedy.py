import numpy as np
import pytest
from coded import coded
from hypothesis import example, given, strategies as st
from selection_problems import KINDS, cover_30, greedy_by_hand, random_problem, run, value, weight_of_cover_30

from waybound import Cardinality, PartitionMatroid, SubmodularSelection, UsageError, UserFunction


def test_cover_30_takes_less_than_half_of_the_evaluations() -> None:
    """The source's rule takes 76 of 165: it evaluates an old gain equal to the best new one although its element comes later. The heap
    leaves these out."""
    picks, by_hand = greedy_by_hand(weight_of_cover_30, 30, 6, lazy=True)
    assert by_hand == 76
    outcome = run("lazy-greedy", cover_30(6))
    assert outcome.answer.elements == (9, 8, 15, 2, 3, 26) == tuple(picks)
    assert outcome.statistics["evaluations"] == 71
    assert outcome.statistics["plain_evaluations"] == 165
    assert outcome.guarantee is not None


def test_a_plan_is_extended_over_what_it_has() -> None:
    """Three and three more are the six at once, if what was chosen first is kept (133; 118 where it is forgotten)."""
    first = run("lazy-greedy", cover_30(3)).answer
    both = run("lazy-greedy", cover_30(6), base=first.elements)
    assert both.answer.elements == (9, 8, 15, 2, 3, 26)
    assert value(cover_30(6), both) == 133
    assert both.guarantee is None
    assert run("lazy-greedy", cover_30(6), base="10, 9,16").answer == both.answer
    assert both.statistics["plain_evaluations"] == 27 + 26 + 25
    assert both.statistics["evaluations"] <= both.statistics["plain_evaluations"]


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from(["cardinality", "partition"]), st.booleans())
@example(181869, "user", "cardinality", False)  # two elements whose gains differ by rounding, and by how many are valued at once
def test_the_answer_is_greedys_and_the_evaluations_are_no_more(seed: int, kind: str, constraint: str, whole: bool) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, constraint, 12, whole=whole)
    plain, lazy = run("greedy", problem, evaluation="plain"), run("lazy-greedy", problem)
    assert lazy.answer == plain.answer and lazy.guarantee == plain.guarantee
    assert lazy.statistics["evaluations"] <= plain.statistics["evaluations"] == lazy.statistics["plain_evaluations"]


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from(["cardinality", "partition"]))
def test_cut_anywhere_and_continued_it_comes_out_the_same(seed: int, kind: str, constraint: str) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, constraint, 8, whole=True)
    whole = run("greedy", problem, evaluation="plain").answer.elements
    for cut in range(len(whole) + 1):
        assert run("lazy-greedy", problem, base=list(whole[:cut])).answer.elements == whole


def test_few_evaluations_on_many_elements() -> None:
    rng = np.random.default_rng(2)
    weights = rng.random(1000)
    groups = rng.integers(0, 1000, (700, 6))
    masks_weights = np.zeros((700, 1000))
    np.put_along_axis(masks_weights, groups, 1.0, axis=1)

    def covered(masks):  # type: ignore[no-untyped-def]
        return ((masks.astype(np.float32) @ masks_weights.astype(np.float32)) > 0) @ weights

    f = UserFunction(covered, 700, monotone=True, submodular=True)
    outcome = run("lazy-greedy", SubmodularSelection(f, Cardinality(10)))
    assert outcome.statistics["evaluations"] < 0.25 * outcome.statistics["plain_evaluations"]


def test_a_base_that_breaks_the_constraint_is_refused() -> None:
    with pytest.raises(UsageError, check=coded("contradiction")):
        run("lazy-greedy", cover_30(2), base=[0, 1, 2])
    problem = SubmodularSelection(cover_30(2).function, PartitionMatroid.of(np.arange(30) // 2))
    with pytest.raises(UsageError, check=coded("contradiction")):
        run("lazy-greedy", problem, base=[0, 1])
