import math

import numpy as np
import pytest
from hypothesis import example, given, strategies as st

from waybound.formulations.checking.granularity import Grain, grain, is_decimal, lift

SCALES = (2.0**-200, 2.0**-30, 2.0**-10, 1.0, 2.0**10, 2.0**30, 2.0**200)


@pytest.mark.parametrize(
    ("values", "size"),
    [
        ([1, 2, 30], Grain(1.0)), ([5, 10, 0], Grain(5.0)), ([0.1, 0.7, 12.3], Grain(1.0, 10.0)), ([0.25], Grain(25.0, 100.0)),
        ([1 / 3], Grain(1 / 3)),
    ],
)  # fmt: skip
def test_the_grain_is_the_largest_number_that_divides_all(values, size):
    assert grain(values) == size


@pytest.mark.parametrize("values", [[], [0.0, 0.0], [1.0, math.pi, math.e], [1.0, math.inf], [1.0, math.nan], [1.0, 1e-310]])
def test_where_there_is_none_none_is_found(values):
    assert grain(values) is None


@pytest.mark.parametrize("tiny", [9e-10, 1e-11, 5e-324])
def test_no_number_is_the_multiple_zero(tiny):
    found = grain([tiny, 1.0, 2.0])
    assert found is None or (tiny / found.size == pytest.approx(round(tiny / found.size), rel=1e-12) and round(tiny / found.size) > 0)


@given(st.lists(st.integers(1, 10**4), min_size=1, max_size=30), st.sampled_from([1, 10, 100, 1000]), st.sampled_from(SCALES))
def test_the_grain_does_not_depend_on_the_unit(counts, parts, scale):
    values = np.array(counts) / parts
    one, other = grain(values), grain(values * scale)
    assert other.size == pytest.approx(one.size * scale, rel=1e-13)
    assert one.size == pytest.approx(math.gcd(*counts) / parts)


@given(st.integers(-(10**6), 10**6), st.sampled_from([1.0, 10.0, 100.0, 1000.0]), st.floats(-0.9, 0.4))
def test_no_multiple_lies_between_a_bound_and_its_lift(count, parts, share):
    size = Grain(1.0, parts)
    bound = (count + share) / parts
    lifted = lift(bound, "min", size)
    assert lifted >= bound
    steps = lifted * parts
    assert abs(steps - round(steps)) < 1e-3 or lifted == bound
    assert lifted <= (count + 1) / parts + 1e-12 * max(1.0, abs(bound))
    if share <= 0:
        assert lifted <= count / parts + 1e-9 * max(1.0, abs(count / parts))


@given(st.lists(st.integers(0, 10**5), min_size=1, max_size=50).filter(any), st.sampled_from([1, 10, 100, 1000]), st.sampled_from(SCALES))
@example([23934, 60227], 10, 6.223015277861142e-61)
def test_a_sum_of_grains_survives_its_own_lift(counts, parts, scale):
    values = np.array(counts) / parts * scale
    total = math.fsum(values)
    size = grain(values)
    assert size is not None
    assert lift(total, "min", size) <= total * (1 + 1e-12)
    assert lift(total, "max", size) >= total * (1 - 1e-12)


def test_bounds_for_max_are_rounded_down():
    assert lift(7.3, "max", Grain(1.0)) == 7.0
    assert lift(14.3, "max", Grain(5.0)) == 10.0
    assert lift(-math.inf, "min", Grain(1.0)) == -math.inf
    assert lift(7.3, "min", None) == 7.3


def test_a_bound_of_too_many_grains_stays():
    assert lift(1e12 + 0.3, "max", Grain(1.0)) == 1e12 + 0.3


def test_decimals_come_out_as_written():
    assert lift(827.2999999, "min", Grain(1.0, 10.0)) == 827.3
    assert lift(827.30000001, "min", Grain(1.0, 10.0)) == 827.30000001
    assert lift(827.3001, "min", Grain(1.0, 10.0)) == 827.4


def test_decimals_are_told_from_other_numbers():
    assert is_decimal([0.1, 0.7, 827.3, 1e6 + 0.125, -3.0, 0.0])
    assert not is_decimal([0.1, 1 / 3])
    assert not is_decimal([10 - 0.9e-6])
