import math

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from programs import program

from waybound.formulations.programs.reductions.finite_bounds import FINITE_BOUNDS
from waybound.solvers.backend import BACKENDS, Control, Options

INF = math.inf


def finite_box(p):
    steps = FINITE_BOUNDS.apply(p)
    return steps[-1].program if steps else p


def box(*args, **options):
    bounded = finite_box(program(*args, **options))
    return bounded.lower.tolist(), bounded.upper.tolist()


def test_given_bounds_stay():
    assert box([1, 1], [[1, 1]], 0, 3, [0, -2], [4, 5]) == ([0, -2], [4, 5])


def test_a_row_of_bounded_variables_bounds_the_last_one():
    lower, upper = box([-1, -1], [[2, 1]], -INF, 7, 0, [INF, 4], integer=[0, 1])
    assert (lower, upper) == ([0, 0], [3, 4])
    lower, upper = box([1, 1], [[1, -1]], -3, 5, [-INF, 0], [INF, 2], integer=[0, 1])
    assert (lower, upper) == ([-3, 0], [7, 2])


def test_bounds_follow_from_bounds():
    _, upper = box([-1, -1, -1], [[1, 0, 0], [1, -1, 0], [0, 1, -1]], [-INF, 0, 0], [4, 0, 0], 0, INF, integer=[0, 1, 2])
    assert upper == [4, 4, 4]


def test_what_only_costs_is_bounded_by_what_rows_can_ask():
    assert box([1], [[2]], -7, INF, -INF, INF, integer=[0]) == ([-3], [-3])
    _, upper = box([1, 1, 1], [[1, 1, 1]], 10, INF, [2.5, 0, -1], [2.5, INF, -1], integer=[1])
    assert upper[1] == 9


def test_a_variable_that_costs_nothing_is_not_cut_from_both_sides():
    lower, upper = box([0, 0], [[1, 0], [1, 0]], [3, -INF], [INF, 10], -INF, INF, integer=[0, 1])
    assert 3 <= lower[0] <= upper[0] <= 10


def test_what_pays_without_end_stays_open():
    _, upper = box([-1, -1], [[1, -1]], -1, 1, 0, INF, integer=[0, 1])
    assert upper == [INF, INF]


def test_products_keep_a_variable_from_being_cut():
    _, upper = box([1, 1], [[1, 1]], 3, INF, 0, INF, integer=[0, 1], quadratic=[[0, -5], [-5, 0]])
    assert upper == [INF, INF]


@settings(max_examples=draws(80), deadline=None)
@given(st.integers(0, 10**6))
def test_the_optimum_stays_where_bounds_are_added(seed):
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 5)), int(rng.integers(1, 4))
    a = rng.integers(-3, 4, (m, n)).astype(float)
    inside = rng.integers(-3, 4, n).astype(float)
    low = np.where(rng.random(m) < 0.6, a @ inside - rng.integers(0, 4, m), -INF)
    high = np.where(rng.random(m) < 0.6, a @ inside + rng.integers(0, 4, m), INF)
    lower = np.where(rng.random(n) < 0.5, inside - rng.integers(0, 3, n), -INF)
    upper = np.where(rng.random(n) < 0.5, inside + rng.integers(0, 3, n), INF)
    given_ = {"lower": lower, "upper": upper}
    p = program(rng.integers(-2, 4, n), a, low, high, **given_, integer=range(n))
    bounded = finite_box(p)
    before = BACKENDS["highs"]().run(p, Options(), Control())
    if before.status != "optimal":
        return
    after = BACKENDS["highs"]().run(program(p.cost, a, low, high, bounded.lower, bounded.upper, integer=range(n)), Options(), Control())
    assert after.status == "optimal"
    assert after.objective == pytest.approx(before.objective)
