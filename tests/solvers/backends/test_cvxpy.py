"""CVXPY: its solvers by name, statuses that are not believed, and duals of every kind of row."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from programs import program

from waybound.formulations.programs.program import LINEAR, QUADRATIC
from waybound.instances.errors import MissingPackageError, UnsupportedError, UsageError
from waybound.solvers.backend import Control, Options
from waybound.solvers.backends import cvxpy as module
from waybound.solvers.backends.cvxpy import CVXPY, solvers_found
from waybound.solvers.backends.highs import Highs

INF = math.inf
CONTINUOUS = [s for s in solvers_found() if CVXPY(s).able(LINEAR)]
ECOS = pytest.mark.skipif("ECOS" not in solvers_found(), reason="ECOS is not installed")


def run(p, variant="", **options):
    return CVXPY(variant).run(p, Options(**options), Control())


def test_unknown_solvers_are_refused_with_those_that_are_used():
    with pytest.raises(UsageError, match="CLARABEL"):
        CVXPY("MOSEK")
    assert CVXPY("clarabel").solver == "CLARABEL"


def test_without_a_name_the_program_decides():
    assert run(program([1], [[1]], 1, INF)).statistics["solver"] == "CLARABEL"
    assert run(program([1], [[2]], 3, INF, 0, 9, integer=[0])).statistics["solver"] == "HIGHS"


def test_solvers_without_integers_say_so():
    with pytest.raises(UnsupportedError, match=r"cvxpy:SCS.*MILP programs; can take it: .*cvxpy:HIGHS"):
        run(program([1], [[2]], 3, INF, 0, 9, integer=[0]), "SCS")


@pytest.mark.share(2)
@pytest.mark.parametrize("solver", CONTINUOUS)
@pytest.mark.parametrize("sense", ["min", "max"])
def test_duals_of_ranges_equalities_and_both_sides(solver, sense):
    sign = 1.0 if sense == "min" else -1.0
    matrix = [[1, 1, 0], [1, -1, 0], [0, 1, 1], [1, 0, 0]]
    p = program([sign * 2, sign * 3, sign * 1], matrix, [4, 1, 3, -INF], [INF, 1, 9, 2.75], 0, 20, sense=sense)
    result = run(p, solver)
    y, reduced = result.row_duals, p.cost - p.matrix.T @ result.row_duals
    value = float(y @ (p.matrix @ result.answer)) + float(reduced @ result.answer)
    assert value == pytest.approx(result.objective, abs=1e-6)
    step = 1e-3
    for row in range(4):  # each dual tells what one more on the sides is worth
        low, high = np.array([4, 1, 3, -INF]), np.array([INF, 1, 9, 2.75])
        low[row] += step
        high[row] += step
        moved = run(program(p.cost, matrix, low, high, 0, 20, sense=sense), solver)
        assert (moved.objective - result.objective) / step == pytest.approx(y[row], abs=1e-4)


def test_zeros_that_a_limit_leaves_behind_are_no_answer():
    # CVXPY says that a solution is present, and hands over zeros that break the rows.
    rng = np.random.default_rng(0)
    a = rng.integers(0, 100, (6, 50)).astype(float)
    half = np.floor(a.sum(axis=1) / 2)
    result = run(program(np.zeros(50), a, half, half, 0, 1, integer=range(50)), time_limit=0.5)
    assert (result.status, result.limit, result.answer) == ("unknown", "time", None)


def test_a_nonconvex_objective_is_an_error_that_says_so():
    result = run(program([0, 0], [[1, 1]], -INF, 2, -1, 1, quadratic=[[-2, 0], [0, -2]]))
    assert result.status == "error"
    assert "convex" in result.message


def test_a_maximised_bound_has_the_sign_of_the_program():
    result = run(program([5, 4], [[2, 3]], -INF, 5, 0, 9, integer=[0, 1], sense="max", offset=7))
    assert (result.objective, result.bound) == (pytest.approx(17.0), pytest.approx(17.0))


@pytest.mark.parametrize(
    ("solver", "extra"),
    [
        ("CLARABEL", {"max_step_fraction": "0.9"}),
        ("SCS", {"alpha": "1.4"}),
        ("HIGHS", {"presolve": "off"}),
        pytest.param("ECOS", {"feastol": "1e-8"}, marks=ECOS),
    ],
)
def test_own_options_are_taken(solver, extra):
    assert run(program([1, 1], [[1, 2]], 4, INF), solver, extra=extra).objective == pytest.approx(2.0, abs=1e-6)


@pytest.mark.parametrize(
    ("solver", "extra"),
    [
        ("CLARABEL", {"max_iter": 3}), ("CLARABEL", {"no_such": 1}), ("CLARABEL", {"tol_feas": "tight"}), ("SCS", {"max_iters": 3}),
        ("SCS", {"no_such": 1}), ("HIGHS", {"time_limit": 1}), ("HIGHS", {"no_such": 1}),
        pytest.param("ECOS", {"max_iters": 3}, marks=ECOS),
    ],
)  # fmt: skip
def test_options_that_have_a_common_name_or_none_are_refused(solver, extra):
    with pytest.raises(UsageError):
        run(program([1], [[1]], 1, INF), solver, extra=extra)


def test_a_failure_of_cvxpy_is_an_error_with_its_words(monkeypatch):
    import cvxpy

    def fail(*_):
        raise cvxpy.error.SolverError("no luck")

    monkeypatch.setattr(module, "_solved", fail)
    result = run(program([1], [[1]], 1, INF))
    assert result.status == "error"
    assert "no luck" in result.message
    assert run(program([1], [[1]], 1, INF), iterations=1).limit == "iterations"


@pytest.mark.parametrize("solver", [s for s in solvers_found() if CVXPY(s).able(QUADRATIC)])
def test_who_takes_quadratic_objectives_finds_their_optimum(solver):
    p = program([-5, 1], [[1, 1]], -INF, 4, -1, 3, quadratic=[[2, -1], [-1, 2]])
    result = run(p, solver)
    assert (result.status, result.objective) == ("optimal", pytest.approx(Highs().run(p, Options(), Control()).objective, abs=1e-6))


def test_an_inaccurate_end_within_all_limits_is_no_limit(monkeypatch):
    monkeypatch.setattr(module, "_solved", lambda *_: SimpleNamespace(status="optimal_inaccurate", solver_stats=None, var_dict=held))
    held = {"x0": SimpleNamespace(value=np.array([3.0]))}
    result = run(program([1], [[1]], 2, INF, 0, 9))
    assert (result.status, result.limit) == ("feasible", "none")


def test_a_solver_whose_library_is_missing_is_not_offered_and_named_with_what_brings_it(monkeypatch):
    import cvxpy

    monkeypatch.setattr(module, "is_installed", lambda name: name != "ecos")
    assert "cvxpy:ECOS" not in (*CVXPY.available(), *CVXPY.takers(LINEAR)) and "cvxpy:SCS" in CVXPY.available()
    monkeypatch.setattr(cvxpy, "installed_solvers", lambda: ["CLARABEL"])
    with pytest.raises(MissingPackageError, match="does not find ECOS: pip install ecos; found: CLARABEL"):
        run(program([1], [[1]], 1, INF), "ECOS")
