"""Bounds are lifted to the next value an objective can take, and never past one."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from waybound.formulations.checking.granularity import grain, is_decimal, lift


@pytest.mark.parametrize(
    ("values", "size"), [([1, 2, 30], 1.0), ([0.1, 0.7, 12.3], 0.1), ([0.25], 0.01), ([0.125], 0.001), ([1 / 3], None), ([], 1.0)]
)
def test_the_grain_is_the_coarsest_decimal_that_divides_all(values, size):
    assert grain(values, 10) == size


def test_a_grain_needs_finite_numbers():
    assert grain([1.0, math.inf], 3) is None
    assert grain([1.0, math.nan], 3) is None


def test_many_terms_ask_for_a_sharper_match():
    assert grain([1.0 + 5e-10], 10) == 1.0
    assert grain([1.0 + 5e-10], 10**4) is None


@given(st.integers(-(10**9), 10**9), st.sampled_from([1.0, 0.1, 0.01, 0.001]), st.floats(-0.9, 0.4))
def test_no_multiple_lies_between_a_bound_and_its_lift(count, size, share):
    bound = (count + share) * size
    lifted = lift(bound, "min", size)
    assert lifted >= bound
    steps = lifted / size
    assert abs(steps - round(steps)) < 1e-3 or lifted == bound
    assert lifted <= (count + 1) * size + 1e-12 * max(1.0, abs(bound))
    if share <= 0:
        assert lifted <= count * size + 1e-9 * max(1.0, abs(count * size))


@given(st.lists(st.integers(0, 10**5), min_size=1, max_size=50), st.sampled_from([1, 10, 100, 1000]))
def test_a_sum_of_grains_survives_its_own_lift(counts, scale):
    total = math.fsum(c / scale for c in counts)
    size = grain(np.array(counts) / scale, len(counts))
    assert size is not None
    assert lift(total, "min", size) <= total + 1e-9 * max(1.0, total)
    assert lift(total, "max", size) >= total - 1e-9 * max(1.0, total)


def test_bounds_for_max_are_rounded_down():
    assert lift(7.3, "max", 1.0) == 7.0
    assert lift(-math.inf, "min", 1.0) == -math.inf
    assert lift(7.3, "min", None) == 7.3


def test_decimals_come_out_as_written():
    assert lift(827.2999999, "min", 0.1) == 827.3
    assert lift(827.30000001, "min", 0.1) == 827.30000001
    assert lift(827.3001, "min", 0.1) == 827.4


def test_decimals_are_told_from_other_numbers():
    assert is_decimal([0.1, 0.7, 827.3, 1e6 + 0.125, -3.0, 0.0])
    assert not is_decimal([0.1, 1 / 3])
    assert not is_decimal([10 - 0.9e-6])
