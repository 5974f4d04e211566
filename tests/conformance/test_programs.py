"""Every program backend on small programs whose answers are known: statuses, optima by KKT, and refusals."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from programs import program
from scipy.optimize import linprog

from waybound import InputError, Program, Rows, UnsupportedError, UsageError, Variables
from waybound.formulations.programs.cones import Cones
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.program_backend import ProgramBackend

INF = math.inf

NO_DUALS = ("pulp:HiGHS", "mathopt:gscip")
"""PuLP's interfaces split ranges, so that their duals belong to other rows; SCIP through MathOpt tells none."""


def test_an_lp_has_its_optimum_and_dual_vector(solve_with, check_optimum):
    lp = program([1, 1], [[1, 2], [3, 1]], [4, 6], INF)
    result = solve_with(lp)
    check_optimum(lp, result, 2.8)
    if result.row_duals is not None:
        assert result.row_duals == pytest.approx([0.4, 0.2])


def test_native_backends_tell_the_duals_of_an_lp(backend_name, solve_with):
    if backend_name in NO_DUALS:
        pytest.skip(f"{backend_name} tells none")
    assert solve_with(program([1, 1], [[1, 2], [3, 1]], [4, 6], INF)).row_duals is not None


def test_a_maximised_lp_has_duals_in_its_own_sense(solve_with, check_optimum):
    lp = program([3, 5], [[1, 0], [0, 2], [3, 2]], -INF, [4, 12, 18], sense="max", offset=7)
    result = solve_with(lp)
    check_optimum(lp, result, 43.0)
    if result.row_duals is not None:
        assert result.row_duals == pytest.approx([0.0, 1.5, 1.0], abs=1e-6)  # one more on the right side is worth that much more


KNOWN = {
    "a degenerate lp ends at its optimum": (
        program([-0.75, 150, -0.02, 6], [[0.25, -60, -0.04, 9], [0.5, -90, -0.02, 3], [0, 0, 1, 0]], -INF, [0, 0, 1]),
        -0.05,
    ),
    "redundant rows do no harm": (program([1, 2], [[1, 1], [1, 1], [2, 2]], [3, 3, 6], [INF, 3, 6]), 3.0),
    "free variables go below zero": (program([1, 1], [[1, 1], [1, -1]], [-3, -1], INF, -INF, INF), -3.0),
    "free integer variables go below zero": (program([1], [[2]], -7, INF, -INF, INF, integer=[0]), -3.0),
    "variables without a lower but with an upper bound": (program([-1, -1], [[1, -1]], -4, 4, -INF, [-2, 9]), -0.0),
    "integer variables without an upper bound are not binary": (program([1], [[1]], 6.5, INF, integer=[0]), 7.0),
    "ranges with negative sides": (program([1, -1], [[1, 1], [1, -1]], [-5, -3], [-2, -1], -INF, INF), -3.0),
    "equalities hold": (program([2, 3, 1], [[1, 1, 1], [1, -1, 0]], [6, 1], [6, 1]), 7.0),
    "rows without limits and rows without entries": (program([1, 1], [[1, 1], [1, 0], [0, 0]], [2, -INF, -1], [INF, INF, 1]), 2.0),
    "maximisation of a milp": (
        program([5, 4, 3], [[2, 3, 1], [4, 1, 2], [3, 4, 2]], -INF, [5, 11, 8], integer=[0, 1, 2], sense="max"),
        13.0,
    ),
    "a program without rows sits on its bounds": (program([5, -1], np.zeros((0, 2)), 0, 0, [2, 0], [3, 8], offset=3), 5.0),
    "a program without objective has any feasible point": (program([0, 0], [[2, 3]], 7, 7, 0, 9, integer=[0, 1]), 0.0),
}


@pytest.mark.parametrize("name", KNOWN)
def test_optima_that_are_known(solve_with, check_optimum, name):
    made, value = KNOWN[name]
    check_optimum(made, solve_with(made), value)


NO_POINT = {
    "of one row": program([1, 1], [[1, 1]], 3, INF, 0, 1),
    "of whole numbers": program([1], [[2]], 1, 1, 0, 5, integer=[0]),
    "with a direction without end, so that a presolve can only say that it is one of the two": program(
        [-1, -1, 0], [[1, -1, 0], [0, 0, 1], [0, 0, 1]], [-1, 2, -INF], [1, INF, 1]
    ),
}


@pytest.mark.parametrize("name", NO_POINT)
def test_an_infeasible_program_is_infeasible_and_has_no_answer(solve_with, name):
    result = solve_with(NO_POINT[name])
    assert (result.status, result.answer) == ("infeasible", None)


def test_an_unbounded_lp_is_unbounded_and_has_no_answer(solve_with):
    result = solve_with(program([-1, -1], [[1, -1]], -1, 1))
    assert result.status in ("unbounded", "infeasible_or_unbounded")
    assert result.answer is None


@pytest.mark.share(3)
def test_an_unbounded_milp_is_not_called_infeasible(solve_with):
    result = solve_with(program([-1, -1], [[1, -1]], -1, 1, integer=[0, 1]))
    assert result.status in ("unbounded", "infeasible_or_unbounded", "unknown")
    assert result.answer is None


@pytest.mark.parametrize("sense", ["min", "max"])
def test_the_two_variable_milp_that_highs_1_14_gets_wrong(solve_with, check_optimum, sense):
    # HiGHS#2957: 15 where the optimum is 9.
    sign = 1.0 if sense == "min" else -1.0
    milp = program([2 * sign, 3 * sign], [[1, 1]], 4.5, INF, integer=[1], sense=sense)
    check_optimum(milp, solve_with(milp), 9.0 * sign)


def test_fixed_variables_keep_their_value(solve_with, check_optimum):
    milp = program([1, 1, 1], [[1, 1, 1]], 10, INF, [2.5, 0, -1], [2.5, INF, -1], integer=[1])
    result = solve_with(milp)
    check_optimum(milp, result, 2.5 + 9 - 1)
    assert result.answer[[0, 2]] == pytest.approx([2.5, -1])


def test_ranges_hold_on_both_sides(solve_with, check_optimum):
    for sign, value in ((1.0, 2.0), (-1.0, -5.0)):
        lp = program([sign, sign], [[1, 1]], 2, 5, 0, 9)
        check_optimum(lp, solve_with(lp), value)


def test_the_constant_of_the_objective_counts(solve_with, check_optimum):
    for sense in ("min", "max"):
        milp = program([1, 2], [[1, 1]], 3, 3, 0, 2, integer=[0, 1], sense=sense, offset=-100.25)
        check_optimum(milp, solve_with(milp), (4.0 if sense == "min" else 5.0) - 100.25)


def test_an_empty_program_is_its_constant(solve_with):
    empty = Program("empty", "min", (), (), offset=4.0)
    result = solve_with(empty)
    assert (result.status, result.objective, result.bound) == ("optimal", 4.0, 4.0)
    assert result.answer.shape == (0,)


def test_rows_without_variables_can_be_infeasible(solve_with):
    rows = Rows("row", indptr=np.zeros(2, dtype=np.int32), lower=np.array([1.0]), upper=np.array([2.0]))
    assert solve_with(Program("empty", "min", (), (rows,))).status == "infeasible"


def test_bounds_that_cross_are_infeasible(solve_with):
    result = solve_with(program([1], [[1]], 0, INF, 2, 1))
    assert result.status == "infeasible"
    assert "x0" in result.message


@pytest.mark.parametrize("where", ["cost", "coefficient", "lower", "row", "offset", "quadratic"])
def test_data_that_are_not_numbers_are_refused_by_name(solve_with, where):
    nan = math.nan
    parts = {
        "cost": program([1, nan], [[1, 1]], 1, INF),
        "coefficient": program([1, 1], [[1, nan]], 1, INF),
        "lower": program([1, 1], [[1, 1]], 1, INF, [0, nan]),
        "row": program([1, 1], [[1, 1]], nan, INF),
        "offset": program([1, 1], [[1, 1]], 1, INF, offset=nan),
        "quadratic": program([1, 1], [[1, 1]], 1, INF, quadratic=[[1, 0], [0, nan]]),
    }
    with pytest.raises(InputError) as caught:
        solve_with(parts[where])
    word = {"cost": "x1", "coefficient": "x1", "lower": "x1", "row": "row", "offset": "constant", "quadratic": "quadratic"}[where]
    assert word in str(caught.value)


def test_infinite_costs_and_coefficients_are_refused(solve_with):
    for bad in (program([1, INF], [[1, 1]], 1, INF), program([1, 1], [[1, INF]], 1, INF)):
        with pytest.raises(InputError):
            solve_with(bad)


def test_duplicate_coefficients_add_up(solve_with, check_optimum):
    # x + x + y >= 4, given as three entries: column 0 twice.
    doubled = sp.csr_matrix((np.array([1.0, 1.0, 1.0]), np.array([0, 0, 1]), np.array([0, 3])), shape=(1, 2))
    lp = program([1, 3], doubled, 4, INF)
    assert len(lp.data) == 3
    check_optimum(lp, solve_with(lp), 2.0)


def test_columns_in_any_order_within_a_row(solve_with, check_optimum):
    shuffled = sp.csr_matrix((np.array([2.0, 1.0]), np.array([1, 0]), np.array([0, 2])), shape=(1, 2))
    lp = program([1, 3], shuffled, 4, INF)
    check_optimum(lp, solve_with(lp), 4.0)


def test_blocks_of_variables_come_back_in_their_order(solve_with):
    one = Variables("a", keys=(np.arange(2),), lower=np.zeros(2), upper=np.full(2, 5.0), cost=np.array([1.0, 2.0]), integer=True)
    two = Variables("b", lower=np.array([1.0]), upper=np.array([1.0]), cost=np.array([7.0]))
    rows = Rows(
        "row", indptr=np.array([0, 3], dtype=np.int32), indices=np.array([0, 1, 2], dtype=np.int32), data=np.ones(3),
        lower=np.array([8.0]), upper=np.array([INF]),
    )  # fmt: skip
    assert solve_with(Program("blocks", "min", (one, two), (rows,))).answer == pytest.approx([5, 2, 1])


def test_a_convex_qp_meets_its_optimality_conditions(solve_with, check_optimum):
    qp = program([-2, -5], [[1, 1]], -INF, 2, quadratic=[[2, 0], [0, 2]])
    check_optimum(qp, solve_with(qp), -6.125)


def test_a_concave_qp_is_maximised(solve_with, check_optimum):
    qp = program([2, 5], [[1, 1]], -INF, 2, quadratic=[[-2, 0], [0, -2]], sense="max", offset=1.0)
    check_optimum(qp, solve_with(qp), 7.125)


def test_a_nonconvex_qp_is_solved_globally_or_not_called_optimal(solve_with, check_optimum):
    qp = program([0, 0], [[1, 1]], -INF, 2, -1, 1, quadratic=[[-2, 0], [0, -2]])
    result = solve_with(qp)
    if result.status == "optimal":
        check_optimum(qp, result, -2.0)
    else:
        assert result.status in ("error", "unknown", "feasible")
        assert result.bound is None


def test_a_product_of_two_binaries_is_maximised(solve_with, check_optimum):
    # Neither convex nor concave: 2 x y + 3 y z - 4 x z + x, of which y and z alone are best.
    miqp = program(
        [1, 0, 0], [[1, 1, 1]], -INF, 3, 0, 1, integer=[0, 1, 2], quadratic=[[0, 2, -4], [2, 0, 3], [-4, 3, 0]], sense="max", offset=0.5
    )
    check_optimum(miqp, solve_with(miqp), 3.5)


@pytest.mark.share(3)
def test_products_under_a_row_meet_enumeration(solve_with, check_optimum):
    rng = np.random.default_rng(11)
    for sense in ("min", "max"):
        n = 7
        q = np.triu(rng.integers(-5, 6, (n, n)), 1).astype(float)
        cost, weight = rng.integers(-4, 5, n).astype(float), rng.integers(1, 6, n).astype(float)
        points = np.array([[k >> j & 1 for j in range(n)] for k in range(2**n)], dtype=float)
        inside = points[points @ weight <= 10]
        values = inside @ cost + np.einsum("ki,ij,kj->k", inside, q, inside)
        miqp = program(cost, weight[None], -INF, 10, 0, 1, integer=range(n), quadratic=q + q.T, sense=sense)
        check_optimum(miqp, solve_with(miqp), values.min() if sense == "min" else values.max())


def test_squares_of_integers_count(solve_with, check_optimum):
    # (x - 2.6)^2 + (y + 1.2)^2 less its constant, over integers.
    miqp = program([-5.2, 2.4], [[1, 1]], -9, 9, -5, 5, integer=[0, 1], quadratic=[[2, 0], [0, 2]], offset=6.76 + 1.44)
    check_optimum(miqp, solve_with(miqp), 0.16 + 0.04)


def _cones(kind: str, matrix: list[list[float]], offset: list[float], width: int) -> Cones:
    a = sp.csr_matrix(np.asarray(matrix, dtype=float))
    return Cones(kind, kind, width, a.indptr, a.indices, a.data, np.asarray(offset, dtype=float))


def test_a_linear_objective_over_second_order_cones(solve_with, check_optimum):
    # Two discs around (0, 0) and (3, 0) of radius 2: the lens between them reaches down to -sqrt(2^2 - 1.5^2).
    discs = _cones("second-order", [[0, 0], [1, 0], [0, 1], [0, 0], [1, 0], [0, 1]], [2, 0, 0, 2, -3, 0], 3)
    lens = replace(program([0, 1], [[1, 0]], -9, 9, -INF, INF), cones=(discs,))
    assert lens.features() == {"second-order-cones"}
    check_optimum(lens, solve_with(lens), -math.sqrt(4 - 2.25))


def test_a_quadratic_objective_over_an_exponential_cone(solve_with, check_optimum):
    # The point of y >= exp(x) nearest to (1, 0) is where (x - 1) + exp(2 x) = 0, that is x = 0.
    above = _cones("exponential", [[1, 0], [0, 0], [0, 1]], [0, 1, 0], 3)
    near = replace(program([-2, 0], [[1, 1]], -9, 9, -INF, INF, offset=1, quadratic=[[2, 0], [0, 2]]), cones=(above,))
    assert near.features() == {"exponential-cones", "quadratic-objective"}
    check_optimum(near, solve_with(near), 2.0)


def test_whole_points_of_a_cone(solve_with):
    """(t, x, y) with t >= |(x, y)|, x + y >= 7: (3, 4) or (4, 3), of norm 5."""
    cone = _cones("second-order", [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0, 0, 0], 3)
    result = solve_with(replace(program([1, 0, 0], [[0, 1, 1]], 7, INF, 0, [99, 9, 9], integer=[1, 2]), cones=(cone,)))
    assert result.status == "optimal"
    assert result.objective == pytest.approx(5.0, abs=1e-5) and sorted(result.answer[1:]) == pytest.approx([3.0, 4.0])


def test_cones_that_do_not_meet_leave_no_answer(solve_with):
    discs = _cones("second-order", [[0, 0], [1, 0], [0, 1], [0, 0], [1, 0], [0, 1]], [1, 0, 0, 1, -3, 0], 3)
    result = solve_with(replace(program([0, 1], [[1, 0]], -9, 9, -INF, INF), cones=(discs,)))
    assert result.status == "infeasible"
    assert result.answer is None


def test_cones_are_refused_by_whom_they_are_not_for(backend_name):
    base, _, variant = backend_name.partition(":")
    backend = BACKENDS[base](variant) if variant else BACKENDS[base]()
    ball = replace(program([1, 1], [[1, 1]], -9, 9), cones=(_cones("second-order", [[0, 0], [1, 0], [0, 1]], [1, 0, 0], 3),))
    if not ProgramBackend.missing(backend, ball):
        pytest.skip(f"{backend_name} takes cones")
    with pytest.raises(UnsupportedError, match=r"cone LP.*cvxpy:CLARABEL"):
        backend.run(ball, Options(), Control())


def test_kinds_that_are_not_declared_are_refused(backend_name):
    base, _, variant = backend_name.partition(":")
    kind = BACKENDS[base]
    backend = kind(variant) if variant else kind()
    miqp = program([1, 1], [[1, 1]], 1, INF, integer=[0], quadratic=[[1, 0], [0, 1]])
    if not backend.lacking(miqp):
        pytest.skip(f"{backend_name} takes MIQP")
    with pytest.raises(UnsupportedError, match="MIQP"):
        backend.run(miqp, Options(), Control())


def test_unknown_options_are_refused(solve_with):
    with pytest.raises(UsageError):
        solve_with(program([1], [[1]], 1, INF), extra={"no_such_option": 1})


@pytest.mark.share(3)
def test_random_lps_meet_kkt_and_agree(solve_with, check_optimum):
    rng = np.random.default_rng(5)
    for _ in range(8):
        m, n = 6, 8
        a = rng.integers(-4, 6, (m, n)).astype(float)
        inside = rng.integers(0, 4, n)
        cost = rng.integers(0, 9, n).astype(float)
        low = a @ inside - rng.integers(0, 5, m)
        lp = program(cost, a, low, low + 12, 0, 6)
        sides = np.vstack([-a, a]), np.concatenate([-low, low + 12])
        known = linprog(cost, *sides, bounds=[(0, 6)] * n, method="highs").fun
        check_optimum(lp, solve_with(lp), known)
