"""What is within a limit, equal and closed does not depend on the unit of the data."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from waybound.formulations.tolerance import EQUAL, LIMIT, VECTOR, allowance, gap, ratio, room, same, widening

POWERS = st.sampled_from([-900, -300, -30, -10, 0, 10, 30, 300, 900])
NUMBERS = st.floats(-1e9, 1e9).filter(lambda v: v == 0 or abs(v) > 1e-9)


def test_decimals_that_fill_a_limit_fit_and_whole_numbers_are_exact():
    assert allowance(0.3, 0.1 + 0.2) >= 0.1 + 0.2 - 0.3
    assert allowance(10.0, 11.0) == 0.0
    assert allowance(9e14, 9e14 + 1) == 0.0
    assert allowance(10.5, 10.5 * (1 + LIMIT)) > 0.0


def test_an_infinite_limit_allows_no_more():
    assert allowance(math.inf, 5.0) == 0.0
    assert widening(math.inf) == 0.0


@given(NUMBERS, NUMBERS)
def test_a_bound_concedes_at_least_what_is_allowed(limit, total):
    assert allowance(limit, total) <= widening(limit)


@given(NUMBERS, NUMBERS, NUMBERS, POWERS)
def test_verdicts_do_not_depend_on_the_unit(a, b, size, power):
    x, y, z = (math.ldexp(v, power) for v in (a, b, abs(size)))
    assert same(x, y, z) == same(a, b, abs(size))
    assert gap(x, y, z) == gap(a, b, abs(size))
    assert ratio(x, y, z) == ratio(a, b, abs(size))


@pytest.mark.parametrize("scale", [1e-300, 1e-12, 1.0, 1e12, 1e300])
def test_closed_means_a_gap_of_nothing_and_a_ratio_of_one(scale):
    value = 0.7 * scale
    for bound in (value, value * (1 + 0.5 * EQUAL)):
        assert same(value, bound) and ratio(value, bound) == 1.0 and gap(value, bound) <= EQUAL
    for bound in (value * (1 + 1e-6), value * 2, 0.0):
        assert not same(value, bound) and gap(value, bound) > EQUAL and ratio(value, bound) != 1.0


def test_what_cancels_is_known_as_closely_as_its_terms():
    assert same(1e-13, -2e-13, size=1000.0) and ratio(1e-13, -2e-13, size=1000.0) == 1.0
    assert not same(1e-13, -2e-13)


def test_numbers_at_the_ends_of_the_doubles():
    assert gap(0.0, 0.0) == 0.0 and ratio(0.0, 0.0) == 1.0
    assert 0 < gap(0.0, 5e-324) < math.inf and ratio(0.0, 5e-324) is None
    assert 0 < gap(-1.7e308, 1.7e308) < math.inf and ratio(-1.7e308, 1.7e308) is None
    assert ratio(5e-324, 4.0) is None
    assert not same(-math.inf, 1.0) and not same(math.inf, 1.0) and same(math.inf, math.inf)
    assert not same(math.nan, 1.0)


def test_arrays_are_judged_entry_by_entry():
    allowed = allowance([1.0, 0.3, 0.0], [2.0, 0.31, 1e-300])
    assert np.array_equal(allowed, [0.0, LIMIT * 0.3, 0.0])


def test_a_gap_agrees_with_what_counts_as_the_same():
    for value, bound, size in ((5e-10, 0.0, 1.0), (2e-7, 1e-7, 2.0), (3.0, 3.0 + 1e-6, 0.0)):
        for precision in (EQUAL, VECTOR):
            if same(value, bound, size, precision):
                assert gap(value, bound, size, precision) <= precision
            else:
                assert gap(value, bound, size, precision) > precision


def test_what_a_budget_has_room_for_is_decided_by_all_costs():
    assert room([1.0, 2.0], 10.0) == 10.0
    for costs, budget in (([0.1, 0.2], 0.3), ([1e12 + 5, 0.5], 1e12), ([1.0, 2.0**53], 10.0), ([1.0], 10.5)):
        assert room(costs, budget) == budget + widening(budget)
