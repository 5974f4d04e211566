import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from waybound.solvers.engines.routing.integer_scales import FINE, UNLIMITED, Scale, Strips, scale_of

numbers = st.floats(0, 1e5, allow_nan=False)


@pytest.mark.parametrize(
    ("values", "factor", "exact"),
    [
        ([1, 2, 3], 1, True), ([1.5], 10, True), ([0.25, 3], 100, True), ([0.125], 1000, True), ([1 / 3], FINE, False),
    ],
)  # fmt: skip
def test_the_smallest_exact_scale_is_chosen(values: list[float], factor: int, exact: bool) -> None:
    assert scale_of(values) == Scale(factor, exact)


@pytest.mark.parametrize("values", [[3, 7, 12], [0.3, 0.7], [1 / 3, 2 / 7]])
@pytest.mark.parametrize("power", [-200, -30, 40, 300])
def test_data_of_any_size_keep_their_precision(values: list[float], power: int) -> None:
    scale = scale_of(np.ldexp(values, power))
    assert scale.exact == scale_of(values).exact
    made = scale.nearest(np.ldexp(values, power))
    assert made / made[0] == pytest.approx(np.array(values) / values[0], rel=1e-5)
    assert made.max() < 2**44


def test_infinite_values_do_not_count_for_the_scale() -> None:
    assert scale_of([math.inf, 2.0], [0.5]) == Scale(10, True)


def test_nothing_to_scale_is_scaled_by_one() -> None:
    assert scale_of() == Scale(1, True)
    assert scale_of([]) == Scale(1, True)


@given(numbers)
def test_up_is_never_below_and_down_never_above_by_more_than_the_guard(value: float) -> None:
    scale = scale_of([value])
    slack = 1e-9 / scale.factor if scale.exact else 1e-9
    up, down = int(scale.up(value)), int(scale.down(value))
    assert up / scale.factor >= value - slack - 1e-12 * value
    assert down / scale.factor <= value + slack + 1e-12 * value
    assert up - down in (0, 1)


@given(st.integers(-(10**12), 10**12), st.sampled_from([1, 10, 100, 1000]))
def test_exact_scales_are_exact(whole: int, factor: int) -> None:
    value = whole / factor
    scale = scale_of([value])
    assert scale.exact
    for made in (scale.up(value), scale.down(value), scale.nearest(value)):
        assert int(made) * factor == whole * scale.factor


def test_infinite_limits_are_unlimited() -> None:
    assert int(Scale(FINE, False).down(math.inf)) == UNLIMITED


def test_strips_are_scaled_as_if_they_were_one_array() -> None:
    rows = [np.array([1.0, math.inf, 2.5]), np.array([math.nan, 7.25]), np.array([])]
    strips = Strips(lambda: rows)
    assert strips.largest == 7.25
    assert scale_of(strips, [3.0]) == scale_of([1.0, 2.5, 7.25, 3.0]) == Scale(100, True)
