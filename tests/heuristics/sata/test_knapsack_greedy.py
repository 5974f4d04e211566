import itertools
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from selection_problems import KINDS, context, only_evidence, optimum, random_problem, run, value

from waybound import Coverage, Knapsack, SubmodularSelection, UserFunction
from waybound.formulations.verified_bounds import verified_bound
from waybound.heuristics.heuristic import HEURISTICS

E = 1 - math.exp(-1)
SHARES = {0: E / 2, 1: E / 2, 2: E, 3: E}


def sums(values: list[float], costs: list[float], budget: float) -> SubmodularSelection:
    return SubmodularSelection(Coverage.from_sets([[k] for k in range(len(values))], values), Knapsack(np.array(costs), budget))


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.integers(0, 3), st.booleans())
def test_each_depth_keeps_its_guarantee(seed: int, kind: str, depth: int, whole: bool) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, "knapsack", whole=whole)
    outcome, best = run("knapsack-greedy", problem, enumerate=depth), optimum(problem)
    assert outcome.guarantee is not None and outcome.guarantee.ratio == pytest.approx(1 / SHARES[depth])
    assert value(problem, outcome) >= SHARES[depth] * best * (1 - 1e-9)
    assert verified_bound(problem, only_evidence(outcome)) >= best * (1 - 1e-12)


@given(st.integers(0, 10**6), st.sampled_from(KINDS))
def test_more_starting_sets_are_never_worse(seed: int, kind: str) -> None:
    problem = random_problem(np.random.default_rng(seed), kind, "knapsack")
    values = [value(problem, run("knapsack-greedy", problem, enumerate=depth)) for depth in range(4)]
    assert all(a <= b * (1 + 1e-12) for a, b in itertools.pairwise(values))


@given(st.integers(0, 10**6))
def test_a_users_function_is_filled_like_the_same_one_given_by_arrays(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, "coverage", "knapsack", whole=True)
    f = problem.function
    assert isinstance(f, Coverage)
    covers = np.zeros((f.num_elements, f.num_items), dtype=bool)
    covers[np.repeat(np.arange(f.num_elements), np.diff(f.indptr)), f.indices] = True
    by_user = UserFunction(lambda m: ((m @ covers) > 0) @ f.item_weights, f.num_elements, monotone=True, submodular=True)
    twin = SubmodularSelection(by_user, problem.constraint)
    for depth in range(3):
        assert value(twin, run("knapsack-greedy", twin, enumerate=depth)) == value(
            problem, run("knapsack-greedy", problem, enumerate=depth)
        )


def test_the_best_single_element_saves_what_gain_per_cost_loses() -> None:
    problem = sums([1.1, 10.0], [1.0, 10.0], 10.0)
    outcome = run("knapsack-greedy", problem, enumerate=0)
    assert outcome.answer.elements == (1,)
    assert value(problem, outcome) == 10


def test_pairs_find_what_single_starts_miss() -> None:
    """Two large elements fill the knapsack; gain per cost prefers the small one, beside which only one of them fits."""
    problem = sums([3.0, 5.0, 5.0], [2.0, 5.0, 5.0], 10.0)
    assert value(problem, run("knapsack-greedy", problem, enumerate=0)) == 8
    assert value(problem, run("knapsack-greedy", problem, enumerate=1)) == 8
    assert value(problem, run("knapsack-greedy", problem, enumerate=2)) == 10 == optimum(problem)


def test_elements_without_cost_are_always_taken() -> None:
    problem = sums([2.0, 3.0, 4.0], [0.0, 1.0, 0.0], 0.5)
    for depth in range(4):
        assert sorted(run("knapsack-greedy", problem, enumerate=depth).answer.elements) == [0, 2]


def test_three_costs_of_a_tenth_fit_into_three_tenths() -> None:
    assert len(run("knapsack-greedy", sums([1.0] * 3, [0.1] * 3, 0.3)).answer) == 3


@pytest.mark.parametrize("problem", [sums([1.0, 2.0], [1.0, 2.0], 0.0), sums([5.0], [2.0], 1.0), sums([], [], 1.0)])
def test_where_nothing_fits_nothing_is_chosen(problem: SubmodularSelection) -> None:
    outcome = run("knapsack-greedy", problem)
    assert outcome.answer.elements == ()
    assert outcome.guarantee is not None


@pytest.mark.slow
def test_the_depth_follows_from_the_size_by_itself() -> None:
    rng = np.random.default_rng(1)

    def depth_of(n: int) -> int:
        f = Coverage.from_sets([rng.integers(0, 50, 5) for _ in range(n)], rng.random(50))
        return int(run("knapsack-greedy", SubmodularSelection(f, Knapsack(rng.uniform(1, 2, n), 6.0))).statistics["enumerate"])

    assert [depth_of(n) for n in (10, 60, 400)] == [3, 3, 2]


def test_the_time_limit_lowers_what_is_promised() -> None:
    rng = np.random.default_rng(1)
    f = Coverage.from_sets([rng.integers(0, 500, 50) for _ in range(400)], rng.random(500))
    problem = SubmodularSelection(f, Knapsack(rng.uniform(1, 2, 400), 60.0))
    run("knapsack-greedy", problem, enumerate=0)  # compiled by now
    outcome = HEURISTICS["knapsack-greedy"].run(problem, context(seconds=0.2), enumerate=3)
    assert problem.evaluate(outcome.answer).feasible and len(outcome.answer) > 0
    assert outcome.statistics["enumerate"] < 2
    assert outcome.guarantee is not None and outcome.guarantee.ratio == pytest.approx(2 / E)
    assert "the time was up" in outcome.message
    assert outcome.limit == "time"


def test_before_the_first_filling_nothing_is_promised() -> None:
    problem = sums([1.0, 2.0], [1.0, 1.0], 1.0)
    outcome = HEURISTICS["knapsack-greedy"].run(problem, context(seconds=0.0))
    assert problem.evaluate(outcome.answer).feasible
    assert (outcome.guarantee, outcome.limit) == (None, "time")
