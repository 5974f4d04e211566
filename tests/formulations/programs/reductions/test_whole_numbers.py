import math

import numpy as np
import pytest
import scipy.sparse as sp
from draws import draws
from hypothesis import HealthCheck, given, settings, strategies as st
from programs import program

from waybound.formulations.programs.reductions.reduction import Irreducible
from waybound.formulations.programs.reductions.whole_numbers import ROW_ERROR, UNLIMITED, WHOLE_NUMBERS, IntegerProgram
from waybound.solvers.backend import BACKENDS, Control, Options

INF = math.inf


def integer_program(p) -> IntegerProgram:
    return WHOLE_NUMBERS.apply(p)[-1].program


def activity(counted, z) -> np.ndarray:
    """Row sums in exact integers."""
    rows = np.repeat(np.arange(len(counted.row_lower)), np.diff(counted.indptr))
    sums = np.zeros(len(counted.row_lower), dtype=object)
    np.add.at(sums, rows, counted.data.astype(object) * np.asarray(z, dtype=object)[counted.indices])
    return sums


def test_whole_data_are_taken_as_they_are():
    counted = integer_program(program([2, 3], [[1, 2]], 3, 7, 0, 9, integer=[0, 1]))
    assert counted.exact
    assert (counted.scale, counted.error) == (1.0, 0.0)
    assert counted.data.tolist() == [1, 2]
    assert (counted.row_lower.tolist(), counted.row_upper.tolist()) == ([3], [7])
    assert counted.cost.tolist() == [2, 3]


def test_coefficients_of_continuous_variables_that_no_steps_make_alike_are_none_of_a_network():
    """2 a - b >= 3 and a - b >= -2 have more to them than signs."""
    with pytest.raises(Irreducible, match="counted in steps"):
        integer_program(program([1, 1, 1], [[2, -1, 1], [1, -1, 0]], [3, -2], INF, 0, 9, integer=[2]))


def test_a_network_may_count_its_variables_in_several_units():
    """b in units of 4, c in units of 2: a - 4 b, a - 2 c and 4 b - 2 c with whole sides are differences."""
    differences = program([1, 4, 2], [[1, -4, 0], [1, 0, -2], [0, 4, -2]], [-3, 1, 2], INF, 0, [9, 2, 4])
    counted = integer_program(differences)
    assert counted.exact and (counted.unit / counted.unit[0]).tolist() == [1.0, 0.25, 0.5]


def test_decimals_and_thirds_are_scaled_exactly():
    counted = integer_program(program([0.25, 1.5], [[0.1, 0.7], [1 / 3, 2.0]], [0.4, -INF], [INF, 5.0], 0, 9, integer=[0, 1]))
    assert counted.exact
    assert counted.scale == 4.0
    assert counted.data.tolist() == [1, 7, 1, 6]
    assert counted.row_lower.tolist() == [4, -UNLIMITED]
    assert counted.row_upper.tolist() == [UNLIMITED, 15]


@pytest.mark.parametrize("small", [1e-10, 3e-13])
def test_no_number_is_so_small_that_it_counts_as_the_multiple_0(small: float) -> None:
    counted = integer_program(program([0.5625, small], [[1, 1]], -INF, 7, 0, 9, integer=[0, 1]))
    assert abs(counted.cost[1] / counted.scale - small) * 9 <= counted.error * (1 + 1e-9)
    counted = integer_program(program([1, 1], [[0.5, small]], -INF, 7.5, 0, 9, integer=[0, 1]))
    assert not counted.exact


def test_sides_that_whole_sums_cannot_meet_move_inwards():
    counted = integer_program(program([1], [[2]], 3, 7, 0, 9, integer=[0]))
    assert (counted.row_lower.tolist(), counted.row_upper.tolist()) == ([3], [7])
    counted = integer_program(program([1.0], [[math.pi]], 3, 7, 0, 9, integer=[0]))
    assert not counted.exact
    steps = counted.data[0] / math.pi
    assert counted.row_lower[0] / steps == pytest.approx(3.0, abs=2 * ROW_ERROR)
    assert counted.row_lower[0] <= 3.0 * steps


def test_bounds_of_integers_become_whole_and_may_cross():
    counted = integer_program(program([1], [[1]], -INF, INF, 0.2, 0.8, integer=[0]))
    assert counted.lower[0] > counted.upper[0]


def test_fixed_continuous_variables_are_put_in():
    p = program([1, 5, 1], [[1, 1, 1]], 10, INF, [2.5, 0, -1], [2.5, INF, -1], integer=[1], offset=3)
    counted = integer_program(p)
    assert (counted.lower[[0, 2]] == 0).all()
    assert (counted.upper[[0, 2]] == 0).all()
    assert counted.vector([0, 9, 0]) == pytest.approx([2.5, 9, -1])
    assert counted.constant == pytest.approx(1.5 + 3)
    assert counted.row_lower[0] == 17  # halves
    assert counted.data.tolist() == [2]


def test_a_forest_of_continuous_variables_is_counted_in_its_own_steps():
    # 3 z >= 2 x + 1 and 0.5 z - 2 w <= 4: steps of z are thirds, and w follows.
    p = program([0, 1, 1], [[-2, 3, 0], [0, 0.5, -2]], [1, -INF], [INF, 4], 0, [5, 20, 20], integer=[0])
    counted = integer_program(p)
    assert counted.exact
    assert 1 / counted.unit[1] % 3 == pytest.approx(0.0)
    rows = sp.csr_matrix((counted.data, counted.indices, counted.indptr), shape=(2, 3)).toarray()
    assert set(np.abs(rows[:, 1:]).ravel().tolist()) <= {0, 1}


def test_differences_are_counted_though_they_are_no_forest():
    matrix = [[1, -1, 0, 4], [0, 1, -1, 4], [-1, 0, 1, 4]]
    counted = integer_program(program([1, 1, 1, 0], matrix, -INF, 6, 0, 9, integer=[3]))
    assert counted.exact
    assert (counted.unit == 1.0).all()


def test_flows_are_counted_where_their_columns_hold_one_of_each_sign():
    matrix = [[1, 1, 0, 0], [-1, 0, 1, 0], [0, -1, -1, 0], [1, 0, 0, -3], [0, 1, 0, -3], [0, 0, 1, -3]]
    low = [2, 0, -2, -INF, -INF, -INF]
    counted = integer_program(program([1, 2, 1, 5], matrix, low, [2, 0, -2, 0, 0, 0], 0, 9, integer=[3]))
    assert counted.exact


@pytest.mark.parametrize(
    ("p", "feature"),
    [
        (program([1, 1], [[1, 2], [2, 1]], 3, INF, 0, 9), "counted in steps"),
        (program([-1], [[1]], 0, INF, integer=[0]), r"without bounds \(x0\)"),
        (program([1, 1], [[1, 1]], 0, 3, 0, 9, quadratic=[[0, 1], [1, 0]]), "products of continuous"),
        (program([1, 1], [[1e12, math.pi]], 1, 1e13, 0, 1e5, integer=[0, 1]), "far apart"),
    ],
)
def test_what_cannot_be_counted_is_named(p, feature):
    with pytest.raises(Irreducible, match=feature):
        integer_program(p)


def test_an_objective_that_no_small_scale_holds_is_off_by_a_stated_error():
    rng = np.random.default_rng(0)
    p = program(rng.normal(size=30), np.ones((1, 30)), 0, 9, 0, 1, integer=range(30))
    counted = integer_program(p)
    assert not counted.exact
    assert 0 < counted.error < 1e-6
    for _ in range(50):
        z = rng.integers(0, 2, 30)
        assert abs(float(counted.cost @ z) / counted.scale - p.value(z.astype(float))) <= counted.error


def test_one_weight_alone_needs_no_digits():
    counted = integer_program(program([math.pi, 2 * math.pi], [[1, 1]], 0, 2, 0, 1, integer=[0, 1]))
    assert counted.cost.tolist() == [1, 2]
    assert counted.error == 0.0


def test_squares_of_binaries_are_the_binaries_and_others_are_products():
    counted = integer_program(program([0, 0], [[1, 1]], 0, 4, [0, -2], [1, 3], integer=[0, 1], quadratic=[[6, 1], [1, 4]], sense="max"))
    assert counted.cost.tolist() == [-3, 0]
    assert counted.pairs.tolist() == [[0, 1], [1, 1]]
    assert counted.factors.tolist() == [-1, -2]


@settings(max_examples=draws(150), deadline=None, suppress_health_check=list(HealthCheck))
@given(st.integers(0, 10**6))
def test_every_point_of_the_program_is_one_of_the_integer_program(seed):
    """For whole x and any level of z that the program allows there are steps at least as good."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(2, 6)), int(rng.integers(1, 5))
    a = np.where(rng.random((m, n)) < 0.7, rng.choice([rng.normal(size=(m, n)), rng.integers(-4, 5, (m, n)) / 4.0]), 0.0)
    # One continuous variable, in every row with its own coefficient: a star.
    a = np.hstack([a, rng.choice([-1.0, -0.3, 2.0], (m, 1))])
    x = rng.integers(0, 4, n).astype(float)
    z = float(rng.uniform(0, 3))
    point = np.append(x, z)
    low = a @ point - rng.uniform(0, 2, m) * (rng.random(m) < 0.7)
    p = program(rng.normal(size=n + 1), a, low, low + 5, 0, [*[3] * n, 4], integer=range(n), sense=str(rng.choice(["min", "max"])))
    counted = integer_program(p)
    contained = False
    around = point[-1] / counted.unit[-1]
    for steps in range(math.floor(around) - 2, math.ceil(around) + 3):
        whole = [*[int(v) for v in x], steps]
        sums = activity(counted, whole)
        contained |= bool(
            (sums >= counted.row_lower).all() and (sums <= counted.row_upper).all() and counted.lower[-1] <= steps <= counted.upper[-1]
        )
    assert contained


def test_points_of_the_integer_program_break_a_row_by_no_more_than_stated():
    rng = np.random.default_rng(3)
    for _ in range(100):
        n, m = 5, 3
        a = rng.normal(size=(m, n))
        p = program(rng.normal(size=n), a, rng.normal(size=m) - 2, rng.normal(size=m) + 2, 0, 3, integer=range(n))
        counted = integer_program(p)
        for _ in range(50):
            z = rng.integers(0, 4, n)
            sums = activity(counted, z)
            if (sums >= counted.row_lower).all() and (sums <= counted.row_upper).all():
                assert p.residual(counted.vector(z)) <= ROW_ERROR


@settings(max_examples=draws(60), deadline=None, suppress_health_check=list(HealthCheck))
@given(st.integers(0, 10**6))
def test_cp_sat_and_highs_agree_on_random_programs_that_can_be_counted(seed):
    rng = np.random.default_rng(seed)
    n, m, k = int(rng.integers(1, 6)), int(rng.integers(1, 5)), int(rng.integers(0, 3))
    whole = bool(rng.random() < 0.5)
    draw = (lambda size: rng.integers(-4, 6, size).astype(float)) if whole else (lambda size: rng.normal(size=size) * 3)
    a = np.zeros((m, n + k))
    a[:, :n] = draw((m, n))
    for row in range(m):  # each row holds one continuous variable at most: stars
        if k and rng.random() < 0.7:
            a[row, n + int(rng.integers(0, k))] = float(rng.choice([-1.0, 1.0, 2.0, -0.7]))
    inside = np.append(rng.integers(0, 4, n), rng.uniform(0, 3, k))
    low = a @ inside - np.abs(draw(m))
    high = np.where(rng.random(m) < 0.5, a @ inside + np.abs(draw(m)) + 1, INF)
    p = program(draw(n + k), a, low, high, 0, [*[3] * n, *[3.0] * k], integer=range(n), sense=str(rng.choice(["min", "max"])))
    if not p.is_integer:
        return
    results = [BACKENDS[name]().run(p, Options(time_limit=20), Control()) for name in ("highs", "cpsat")]
    assert [r.status for r in results] == ["optimal", "optimal"], results
    assert results[1].objective == pytest.approx(results[0].objective, abs=1e-5)
    sign = 1.0 if p.sense == "min" else -1.0
    assert sign * results[1].bound <= sign * results[0].objective + 1e-6


def test_points_are_judged_by_the_bounds_that_were_given():
    counted = integer_program(program([-1, 0], [[-1.3, 1]], 0, INF, 0, [1, INF], integer=[0]))
    most = counted.upper
    assert counted.vector(most)[1] > 1.35  # a step beyond what the row can ask for, which is a bound of ours alone
    assert counted.residual(most) == 0.0


@pytest.mark.parametrize("coefficient", [0.0, 0.001, 4.398])
def test_a_bound_that_is_no_fraction_is_broken_by_next_to_nothing(coefficient):
    p = program([1, -1], [[1, coefficient]], -99.1234567, 97.654321, 0, [2, math.e], integer=[0])
    counted = integer_program(p)
    assert 0 <= counted.vector(counted.upper)[1] - math.e <= 2 * ROW_ERROR
    result = BACKENDS["cpsat"]().run(p, Options(), Control())
    assert (result.status, result.objective) == ("optimal", pytest.approx(-math.e, abs=1e-6))
