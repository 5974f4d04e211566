import math
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from programs import program
from scipy.optimize import Bounds, LinearConstraint, linprog, milp

from waybound.formulations.arrays.checking.lp_dual import check_lp_dual
from waybound.instances.errors import InputError


def arrays(cost, matrix, row_lower, row_upper, lower, upper, *, sense="min", integer=False, offset=0.0):
    """Stand-in for a problem of the family "arrays"."""
    whole = range(len(cost)) if integer else ()
    p = program(cost, matrix, row_lower, row_upper, lower, upper, integer=whole, sense=sense, offset=offset)
    return SimpleNamespace(family="arrays", sense=sense, program=p)


def random_arrays(seed: int, *, integer: bool = False, free: bool = False):
    rng = np.random.default_rng(seed)
    m, n = int(rng.integers(1, 5)), int(rng.integers(1, 6))
    matrix = rng.integers(-4, 5, (m, n)).astype(float)
    inside = rng.integers(-2, 3, n).astype(float)
    row_lower = matrix @ inside - rng.integers(0, 4, m)
    row_upper = matrix @ inside + rng.integers(0, 4, m)
    row_lower[rng.random(m) < 0.3] = -math.inf
    row_upper[rng.random(m) < 0.3] = math.inf
    lower, upper = inside - rng.integers(0, 5, n), inside + rng.integers(0, 5, n)
    if free:
        lower[rng.random(n) < 0.4] = -math.inf
        upper[rng.random(n) < 0.4] = math.inf
    cost = rng.integers(-5, 6, n).astype(float)
    sense = str(rng.choice(["min", "max"]))
    return arrays(cost, matrix, row_lower, row_upper, lower, upper, sense=sense, integer=integer, offset=float(rng.integers(-9, 9)))


def optimum(problem) -> tuple[float | None, np.ndarray | None]:
    """Optimum and row duals by scipy; None if there is none."""
    p = problem.program
    sign = 1.0 if p.sense == "min" else -1.0
    if p.integer.any():
        reference = milp(
            sign * p.cost,
            constraints=LinearConstraint(p.matrix, p.row_lower, p.row_upper),
            bounds=Bounds(p.lower, p.upper),
            integrality=p.integer,
        )
        return (sign * reference.fun + p.offset, None) if reference.status == 0 else (None, None)
    up, down = np.isfinite(p.row_upper), np.isfinite(p.row_lower)
    dense = p.matrix.toarray()
    reference = linprog(
        sign * p.cost,
        A_ub=np.vstack([dense[up], -dense[down], np.zeros((1, len(p.cost)))]),
        b_ub=np.concatenate([p.row_upper[up], -p.row_lower[down], [0.0]]),
        bounds=np.column_stack([p.lower, p.upper]),
    )
    if reference.status != 0:
        return None, None
    y = np.zeros(p.num_rows)
    marginals = reference.ineqlin.marginals
    y[up] += marginals[: up.sum()]
    y[down] -= marginals[up.sum() : up.sum() + down.sum()]
    return sign * reference.fun + p.offset, sign * y


def no_better(problem, bound: float, value: float) -> bool:
    slack = 1e-9 * max(1.0, abs(value))
    return bound <= value + slack if problem.sense == "min" else bound >= value - slack


@settings(max_examples=draws(80), deadline=None)
@given(seed=st.integers(0, 10**6), integer=st.booleans(), free=st.booleans(), scale=st.sampled_from([0.1, 1.0, 100.0]))
def test_no_duals_however_wrong_prove_more_than_the_optimum(seed, integer, free, scale):
    problem = random_arrays(seed, integer=integer, free=free)
    value, _ = optimum(problem)
    if value is None:
        return
    rng = np.random.default_rng(seed)
    for _ in range(6):
        duals = scale * rng.normal(size=problem.program.num_rows) * (rng.random(problem.program.num_rows) < 0.7)
        assert no_better(problem, check_lp_dual(problem, {"duals": duals.tolist()}), value)


@settings(max_examples=draws(80), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_optimal_duals_of_a_bounded_program_prove_its_optimum(seed):
    problem = random_arrays(seed)
    value, duals = optimum(problem)
    assert value is not None
    assert check_lp_dual(problem, {"duals": duals.tolist()}) == pytest.approx(value, abs=1e-7)


def test_a_max_min_program_with_a_free_variable_is_bounded_by_inexact_duals():
    # max t over t <= 0.1 x, t <= 0.3 (1 - x), 0 <= x <= 1, t free: 0.075. Duals off by a rounding leave t a reduced cost of 1e-17.
    problem = arrays([0, 1], [[0.1, -1.0], [-0.3, -1.0]], [0.0, -0.3], [math.inf, math.inf], [0, -math.inf], [1, math.inf], sense="max")
    duals = {"duals": [-0.75 * (1 + 3e-16), -0.25]}
    assert check_lp_dual(problem, duals) == pytest.approx(0.075, abs=1e-9)
    assert check_lp_dual(problem, duals) >= 0.075 - 1e-15


def test_a_wrong_reduced_cost_on_an_unbounded_variable_proves_nothing():
    problem = arrays([1.0], [[1.0]], [1.0], [math.inf], [-math.inf], [math.inf])
    assert check_lp_dual(problem, {"duals": [1.0]}) == pytest.approx(1.0, abs=1e-12)
    assert check_lp_dual(problem, {"duals": [0.5]}) <= 1.0
    unbounded = arrays([-1.0], [[0.0]], [-math.inf], [math.inf], [0.0], [math.inf])
    assert check_lp_dual(unbounded, {"duals": [0.0]}) == -math.inf
    assert check_lp_dual(arrays([1.0], [[0.0]], [0.0], [0.0], [0.0], [math.inf], sense="max"), {"duals": [0.0]}) == math.inf


def test_duals_that_point_to_a_missing_side_count_as_zero():
    problem = arrays([1.0], [[1.0]], [-math.inf], [5.0], [2.0], [9.0])
    assert check_lp_dual(problem, {"duals": [3.0]}) == pytest.approx(2.0, abs=1e-12)


def test_integer_costs_on_integer_variables_lift_the_bound():
    problem = arrays([1.0, 1.0], [[2.0, 2.0]], [3.0], [math.inf], [0, 0], [5, 5], integer=True)
    assert check_lp_dual(problem, {"duals": [0.5]}) == 2.0


def test_the_offset_belongs_to_the_bound():
    problem = arrays([1.0], [[1.0]], [-math.inf], [5.0], [2.0], [9.0], offset=100.0)
    assert check_lp_dual(problem, {"duals": [0.0]}) == pytest.approx(102.0, abs=1e-9)


@pytest.mark.parametrize("duals", [[], [1.0, 2.0], None, "x", [math.nan], [math.inf], [None], [True]])
def test_malformed_evidence_is_refused(duals):
    problem = arrays([1.0], [[1.0]], [1.0], [2.0], [0.0], [9.0])
    with pytest.raises(InputError):
        check_lp_dual(problem, {"duals": duals})


def test_huge_duals_prove_nothing():
    problem = arrays([1.0, 1.0], [[1e200, -1e200]], [1.0], [2.0], [0.0, 0.0], [9.0, 9.0])
    assert check_lp_dual(problem, {"duals": [1e300]}) == -math.inf


@settings(max_examples=draws(150), deadline=None)
@given(seed=st.integers(0, 10**6), free=st.booleans(), scale=st.sampled_from([1e-180, 1e-6, 1.0, 1e6, 1e180]))
def test_a_ray_proves_that_there_is_no_point_only_where_there_is_none(seed, free, scale):
    problem = random_arrays(seed, free=free)
    p, rng = problem.program, np.random.default_rng(seed)
    reference = linprog(
        np.zeros(p.num_variables), A_ub=np.vstack([p.matrix.toarray(), -p.matrix.toarray()]),
        b_ub=np.nan_to_num(np.concatenate([p.row_upper, -p.row_lower]), posinf=1e9), bounds=np.column_stack([p.lower, p.upper]),
    )  # fmt: skip
    assert reference.status == 0, "a point inside was drawn first"
    for _ in range(6):
        ray = scale * rng.normal(size=p.num_rows) * (rng.random(p.num_rows) < 0.7)
        assert math.isinf(check_lp_dual(problem, {"ray": ray.tolist()}))
        assert no_better(problem, check_lp_dual(problem, {"ray": ray.tolist()}), 0.0)


@pytest.mark.parametrize("sense", ["min", "max"])
def test_a_ray_proves_that_there_is_no_point_in_either_sense(sense):
    none = math.inf if sense == "min" else -math.inf
    problem = arrays([1.0, -1.0], [[1.0, 1.0], [1.0, -1.0]], [3.0, -math.inf], [math.inf, 5.0], [0, 0], [1, 1], sense=sense)
    assert check_lp_dual(problem, {"ray": [1.0, 0.0]}) == none
    assert check_lp_dual(problem, {"ray": {"at": [0], "values": [1e-200]}}) == none
    assert check_lp_dual(problem, {"ray": [-1.0, 0.0]}) == -none
    assert check_lp_dual(problem, {"ray": [0.0, 0.0]}) == -none
    touching = arrays([1.0, -1.0], [[1.0, 1.0]], [2.0], [math.inf], [0, 0], [1, 1], sense=sense)
    assert check_lp_dual(touching, {"ray": [1.0]}) == -none
    crossed = arrays([1.0], [[1.0]], [0.0], [5.0], [2.0], [1.0], sense=sense)
    assert check_lp_dual(crossed, {"duals": [0.0]}) == none


@pytest.mark.parametrize("unit", [1e-308, 1e-312, 1e-318])
def test_products_below_the_normal_doubles_lose_no_more_than_is_conceded(unit: float) -> None:
    # max x + y over x + y <= 1/3 of a unit: thirds of subnormal numbers are rounded by as much as whole parts of them.
    problem = arrays([1.0, 1.0], [[3.0, 3.0]], [-np.inf], [unit], [0, 0], [np.inf, np.inf], sense="max")
    bound = check_lp_dual(problem, {"duals": [1.0 / 3.0]})
    assert Fraction(bound) >= Fraction(unit) / 3
    assert Fraction(bound) <= Fraction(unit) / 3 + 20 * Fraction(5e-324) + Fraction(unit) / 10**12


def test_a_bound_of_nothing_stays_one() -> None:
    assert check_lp_dual(arrays([1.0], [[1.0]], [0.0], [np.inf], [0.0], [5.0]), {"duals": [0.5]}) == 0.0


@given(seed=st.integers(0, 10**6))
def test_rounded_duals_of_programs_with_free_variables_prove_almost_the_optimum(seed: int) -> None:
    # Free variables that share rows: no single dual can be turned until all reduced costs vanish, and in doubles they do not.
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(2, 5)), int(rng.integers(5, 8))
    matrix = rng.uniform(0.1, 3.0, (m, n)) * rng.choice([1.0, -1.0], (m, n))
    cost = matrix.T @ rng.uniform(0.5, 2.0, m)  # duals within their signs: the optimum is finite
    problem = arrays(
        cost, matrix, matrix @ rng.uniform(-1.0, 1.0, n) - 1.0, np.full(m, math.inf), np.full(n, -math.inf), np.full(n, math.inf)
    )
    value, duals = optimum(problem)
    assert value is not None and duals is not None
    bound = check_lp_dual(problem, {"duals": np.round(duals, 7).tolist()})
    assert bound <= value + 1e-9 * max(1.0, abs(value))
    assert bound >= value - 1e-3 * max(1.0, abs(value))


def test_what_no_fractions_mend_proves_nothing():
    # The free variable is in no row: nothing can keep its reduced cost from driving it away.
    lost = arrays([1.0, 1.0], [[0.0, 1.0]], [0.0], [math.inf], [-math.inf, 0.0], [math.inf, 1.0])
    assert check_lp_dual(lost, {"duals": [0.5]}) == -math.inf
