import math

import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st
from selection_problems import CONSTRAINTS, KINDS, cover_30, cover_tight, feasible_sets, optimum, random_problem

from waybound import Evidence, InputError, Selection, SubmodularSelection
from waybound.formulations.sata.checking.marginal_gains import check_marginal_gains
from waybound.formulations.tolerance import LIMIT
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.errors import Code
from waybound.instances.sata.constraints import Cardinality, Knapsack, PartitionMatroid
from waybound.instances.sata.set_functions import Coverage, FacilityLocation, UserFunction


@given(st.integers(0, 10**6), st.sampled_from(KINDS), st.sampled_from(CONSTRAINTS), st.booleans())
def test_any_prefix_proves_a_bound_that_no_feasible_set_exceeds(seed: int, kind: str, constraint: str, whole: bool) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, kind, constraint, 7, whole=whole)
    prefix = rng.permutation(problem.num_elements)[: int(rng.integers(0, problem.num_elements + 1))].tolist()
    bound = check_marginal_gains(problem, {"prefix": prefix})
    assert all(problem.value(s) <= bound * (1 + 1e-12) for s in feasible_sets(problem))


@given(st.integers(0, 10**6), st.sampled_from(KINDS))
def test_the_bound_is_no_looser_than_the_sums_it_stands_for(seed: int, kind: str) -> None:
    """Recomputed here with the values of whole sets; a checker that returned infinity would be valid, and useless."""
    rng = np.random.default_rng(seed)
    for constraint in ("cardinality", "partition"):
        problem = random_problem(rng, kind, constraint, 7)
        n = problem.num_elements
        prefix = rng.permutation(n)[: int(rng.integers(0, n + 1))].tolist()
        base = problem.value(prefix)
        gains = {e: problem.value([*prefix, e]) - base for e in range(n)}
        best = max(sum(gains[e] for e in s) for s in feasible_sets(problem))
        assert check_marginal_gains(problem, {"prefix": prefix}) == pytest.approx(base + best, rel=1e-9, abs=1e-9)


def test_a_knapsack_is_bounded_by_its_fractional_filling() -> None:
    sets = Coverage.from_sets([[0], [1], [2]], [6.0, 4.0, 3.0])
    problem = SubmodularSelection(sets, Knapsack(np.array([2.0, 2.0, 3.0]), 3.0))
    assert check_marginal_gains(problem, {"prefix": []}) == pytest.approx(6 + 4 / 2, abs=1e-5)
    assert check_marginal_gains(problem, {"prefix": [0]}) == pytest.approx(6 + 4 + 1, abs=1e-5)


def test_the_bound_covers_answers_that_exceed_the_budget_by_the_tolerance() -> None:
    over = 2 * 0.9 * LIMIT
    problem = SubmodularSelection(Coverage.from_sets([[0], [1]], [5.0, 7.0]), Knapsack(np.array([1.0, 1.0 + over]), 2.0))
    judged = problem.evaluate(Selection.of([0, 1]))
    assert judged.feasible
    assert check_marginal_gains(problem, {"prefix": []}) >= judged.values[0]


def test_costs_of_nothing_and_of_more_than_the_budget_are_understood() -> None:
    problem = SubmodularSelection(Coverage.from_sets([[0], [1], [2]], [1.0, 10.0, 2.0]), Knapsack(np.array([0.0, 9.0, 1e-300]), 1.0))
    assert check_marginal_gains(problem, {"prefix": []}) == pytest.approx(3.0)


def test_reference_cases() -> None:
    assert check_marginal_gains(cover_tight(), {"prefix": []}) == pytest.approx(81.0)
    assert check_marginal_gains(cover_tight(), {"prefix": [2, 3]}) == pytest.approx(62 + 20)
    assert check_marginal_gains(cover_30(4), {"prefix": [9, 8, 15, 2]}) >= optimum(cover_30(4)) == 105


def test_groups_count_with_their_own_limits() -> None:
    problem = SubmodularSelection(Coverage.from_sets([[0], [1], [2], [3]], [8.0, 4.0, 2.0, 1.0]), PartitionMatroid.of([0, 0, 1, 1], [1, 2]))
    assert check_marginal_gains(problem, {"prefix": []}) == pytest.approx(8 + 2 + 1)
    none = SubmodularSelection(problem.function, PartitionMatroid.of([0, 0, 0, 0], [0]))
    assert check_marginal_gains(none, {"prefix": []}) == 0.0


def test_sums_are_rounded_upwards() -> None:
    """Ten thirds and the like: the bound may not fall below the exact sum by a rounding."""
    rng = np.random.default_rng(5)
    weights = rng.uniform(0, 1, 3000) / 3
    problem = SubmodularSelection(FacilityLocation([0, 3000], np.arange(3000), weights, 3000), Cardinality(1))
    assert check_marginal_gains(problem, {"prefix": []}) >= math.fsum(weights)


def test_a_users_function_proves_something_only_if_it_is_declared_so() -> None:
    def roots(masks):  # type: ignore[no-untyped-def]
        return np.sqrt(masks.sum(axis=1))

    for monotone, submodular in ((False, False), (True, False), (False, True)):
        f = UserFunction(roots, 4, monotone=monotone, submodular=submodular)
        assert check_marginal_gains(SubmodularSelection(f, Cardinality(2)), {"prefix": [1]}) == math.inf
    f = UserFunction(roots, 4, monotone=True, submodular=True)
    bound = check_marginal_gains(SubmodularSelection(f, Cardinality(2)), {"prefix": [1]})
    assert bound == pytest.approx(1 + 2 * (math.sqrt(2) - 1))


@pytest.mark.parametrize("prefix", [[], [0], [0, 1]])
def test_a_declaration_that_the_values_contradict_proves_nothing(prefix: list[int]) -> None:
    growing = UserFunction(lambda masks: masks.sum(axis=1) ** 2.0, 3, monotone=True, submodular=True)
    assert check_marginal_gains(SubmodularSelection(growing, Cardinality(3)), {"prefix": prefix}) == math.inf
    falling = UserFunction(lambda masks: -1.0 * masks.sum(axis=1), 3, monotone=True, submodular=True)
    assert check_marginal_gains(SubmodularSelection(falling, Cardinality(3)), {"prefix": prefix}) == math.inf


@pytest.mark.parametrize(
    ("data", "code"),
    [
        ({"prefix": [0, 0]}, "unknown-name"), ({"prefix": [4]}, "unknown-name"), ({"prefix": [-1]}, "unknown-name"),
        ({"prefix": [0.5]}, "malformed"), ({"prefix": [True]}, "malformed"), ({"prefix": "01"}, "malformed"), ({}, "malformed"),
    ],
)  # fmt: skip
def test_malformed_evidence_is_refused(data: dict[str, object], code: Code) -> None:
    with pytest.raises(InputError, check=coded(code)):
        verified_bound(cover_tight(), Evidence("marginal-gains", "test", 0.0, data))
