import math
from fractions import Fraction

import numpy as np
import pytest
from coded import coded
from draws import draws
from hypothesis import given, settings, strategies as st
from selection_problems import CONSTRAINTS, cover_30, half_tight, optimum, random_problem

from waybound import Coverage, DenseFacilityLocation, InputError, MaxMinLP, Selection, SubmodularSelection
from waybound.formulations.evidence import CHECKERS
from waybound.formulations.sata.checking.item_prices import value_grain
from waybound.formulations.tolerance import LIMIT
from waybound.instances.sata.constraints import Cardinality, Knapsack, PartitionMatroid

KIND = "item-prices"
FUNCTIONS = ("coverage", "facility-location", "dense", "dense32")
ANY = st.one_of(st.floats(-3, 5), st.sampled_from([0.0, 1e300, 5e-324, -1e9]))


def check(problem, prices) -> float:
    return CHECKERS[KIND](problem, {"prices": [float(p) for p in prices]})


@settings(max_examples=draws(300), deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(FUNCTIONS), st.sampled_from(CONSTRAINTS), st.booleans(), st.data())
def test_any_prices_prove_a_bound_that_holds(seed, function, constraint, whole, data):
    problem = random_problem(np.random.default_rng(seed), function, constraint, most=6, whole=whole)
    items = problem.function.num_items
    assert check(problem, data.draw(st.lists(ANY, min_size=items, max_size=items))) >= optimum(problem) - 1e-12


def test_prices_of_nothing_leave_the_best_sum_of_elements():
    weights = np.array([[3.0, 0.0], [2.0, 2.0], [0.0, 1.5]])
    for constraint, value in (
        (Cardinality(2), 7.0),
        (PartitionMatroid.of([0, 0, 1]), 5.5),
        (Knapsack([2.0, 2.0, 1.0], 3.0), 2.0 * 2 + 1.5),  # the second whole and the third; the first has the worse rate
    ):
        problem = SubmodularSelection(DenseFacilityLocation(weights), constraint)
        assert check(problem, [0, 0]) == pytest.approx(value, abs=1e-5)


def test_high_prices_leave_their_sum():
    problem = cover_30(6)
    most = problem.function.item_weights
    assert check(problem, most) == pytest.approx(most.sum())
    assert check(problem, 2 * most) == pytest.approx(2 * most.sum())


def test_a_knapsack_takes_the_last_element_in_part():
    problem = SubmodularSelection(Coverage.from_sets([[0], [1]], [math.pi, math.e]), Knapsack([1.0, 2.0], 2.0))
    assert check(problem, [0, 0]) == pytest.approx(math.pi + math.e / 2, abs=1e-5)


def test_elements_that_do_not_fit_the_budget_do_not_count():
    problem = SubmodularSelection(Coverage.from_sets([[0], [1]], [10.0, 6.5]), Knapsack([3.0, 2.0], 2.0))
    assert check(problem, [0, 0]) == pytest.approx(6.5)


def test_free_elements_count_in_full():
    problem = SubmodularSelection(Coverage.from_sets([[0], [1]], [10.3, 6.1]), Knapsack([0.0, 2.5], 1.5))
    assert check(problem, [0, 0]) == pytest.approx(10.3, abs=1e-5)
    problem = SubmodularSelection(Coverage.from_sets([[0], [1]], [10.3, 6.1]), Knapsack([0.0, 0.0], 0.0))
    assert check(problem, [0, 0]) == pytest.approx(16.4, abs=1e-5)


def test_what_the_check_of_answers_lets_pass_is_within_the_bound():
    # The set costs a little more than the budget, which the evaluation tolerates.
    problem = SubmodularSelection(Coverage.from_sets([[0], [1]], [1.25, 1.5]), Knapsack([1.0, 1.0 + LIMIT], 2.0))
    answer = problem.evaluate(Selection.of([0, 1]))
    assert answer.feasible
    assert check(problem, [0, 0]) >= answer.values[0]


def test_values_on_a_grain_lower_the_bound_to_it():
    # LP prices prove 1.5 on this triangle of three pairs, of which one may be chosen twice; every value is whole.
    problem = SubmodularSelection(Coverage.from_sets([[0, 1], [1, 2], [2, 0]], [1.0, 1.0, 1.0]), Cardinality(1))
    assert check(problem, [0.5, 0.5, 0.4]) == 2.0


def test_the_rounding_never_favours_the_bound():
    rng = np.random.default_rng(1)
    for _ in range(100):
        problem = random_problem(rng, "facility-location", "cardinality", most=12)
        f = problem.function
        if not len(f.weights) or value_grain(f) is not None:  # a bound on multiples of something is rounded down to one
            continue
        p = rng.random(f.num_items)
        worth = [
            sum(max(Fraction(0), Fraction(float(w)) - Fraction(float(p[j]))) for w, j in zip(f.weights[s], f.indices[s], strict=True))
            for s in (slice(f.indptr[e], f.indptr[e + 1]) for e in range(f.num_elements))
        ]
        exact = sum(map(Fraction, p.tolist())) + sum(sorted(worth, reverse=True)[: problem.constraint.limit])
        found = check(problem, p)
        assert Fraction(found) >= exact
        assert found <= float(exact) * (1 + 1e-13) + 1e-300


def test_sums_that_overflow_prove_nothing():
    assert check(half_tight(), [1e308, 1e308]) == math.inf


@pytest.mark.parametrize("data", [{}, {"prices": [1.0]}, {"prices": [1.0, math.nan]}, {"prices": "ab"}, {"prices": [1.0, math.inf]}])
def test_malformed_prices_are_refused(data):
    with pytest.raises(InputError):
        CHECKERS[KIND](half_tight(), data)


def test_prices_are_no_evidence_without_items():
    problem = random_problem(np.random.default_rng(0), "user", "cardinality")
    for other in (problem, MaxMinLP(np.eye(1), np.eye(1))):
        with pytest.raises(InputError, check=coded("foreign")):
            CHECKERS[KIND](other, {"prices": []})
