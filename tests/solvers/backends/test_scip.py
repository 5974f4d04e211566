import math

import numpy as np
import pytest
from coded import coded
from programs import program

from waybound.formulations.programs.reductions.reduction import Irreducible
from waybound.instances.errors import MissingPackageError, UsageError
from waybound.solvers.backend import LIMITS as OUR_LIMITS, Control, Options, solver_named
from waybound.solvers.backends.scip import LIMITS, FiniteNumbers, Scip

INF = math.inf
needs_scip = pytest.mark.skipif(not Scip.installed(), reason="needs the extra scip (PySCIPOpt)")


def run(p, control=None, **options):
    return Scip().run(p, Options(**options), control or Control())


def test_a_missing_package_is_named_with_what_installs_it(monkeypatch):
    monkeypatch.setattr(Scip, "modules", ("no_such_package",))
    with pytest.raises(MissingPackageError, match="pip install pyscipopt"):
        solver_named("scip")


def test_limits_are_ours():
    assert set(LIMITS.values()) <= set(OUR_LIMITS)


def test_numbers_taken_for_infinite_are_refused_and_infinity_is_not():
    assert FiniteNumbers().apply(program([1], [[1]], -INF, 9e19)) == ()
    with pytest.raises(Irreducible, match="numbers of 1e\\+20 and more"):
        FiniteNumbers().apply(program([1], [[1]], -INF, 1e20))


@needs_scip
def test_duals_of_rows_of_one_variable_are_found_in_its_reduced_cost():
    p = program([3, 5], [[1, 0], [0, 2], [3, 2]], -INF, [4, 12, 18], sense="max")
    assert run(p).row_duals == pytest.approx([0.0, 1.5, 1.0])
    p = program([1, 1], [[-2, 0], [1, 1]], [-INF, 3], [-2, INF])
    result = run(p)
    assert float(result.row_duals @ [-2, 3]) == pytest.approx(result.objective)


@needs_scip
def test_duals_that_prove_nothing_are_not_told():
    rng = np.random.default_rng(0)
    for _ in range(40):
        m, n = 5, 6
        a = rng.integers(-3, 4, (m, n)) * (rng.random((m, n)) < 0.6)
        low = (a @ rng.integers(0, 4, n)) - rng.integers(0, 3, m)
        p = program(rng.integers(-4, 5, n), a, low, low + 6, 0, 5)
        result = run(p)
        assert result.status == "optimal"
        if result.row_duals is not None:
            y, reduced = result.row_duals, p.cost - p.matrix.T @ result.row_duals
            bound = float(np.minimum(y * p.row_lower, y * p.row_upper).sum() + np.minimum(reduced * p.lower, reduced * p.upper).sum())
            assert bound == pytest.approx(result.objective, abs=1e-5) or not np.isfinite(bound)


@needs_scip
def test_nonconvex_objectives_are_solved_globally():
    p = program([0, 0], [[1, 1]], -INF, 2, -1, 1, quadratic=[[-2, 1], [1, -2]])
    result = run(p)
    grid = [(x, y) for x in np.linspace(-1, 1, 41) for y in np.linspace(-1, 1, 41) if x + y <= 2]
    best = min(p.value(np.array(point)) for point in grid)
    assert result.status == "optimal"
    assert result.objective <= best + 1e-9
    assert result.bound <= best


@needs_scip
def test_a_start_with_products_is_taken_in_full_and_in_part():
    p = program([0, 0, 0], [[1, 1, 1]], -INF, 2, 0, 1, integer=[0, 1, 2], sense="max", quadratic=[[0, 1, 2], [1, 0, 3], [2, 3, 0]])
    for start in (np.array([0.0, 1.0, 1.0]), np.array([np.nan, 1.0, np.nan])):
        result = run(p, start=start)
        assert result.statistics["start"] == "used"
        assert result.objective == pytest.approx(3.0)


@needs_scip
@pytest.mark.parametrize(
    ("extra", "code"),
    [
        ({"limits/time": 1}, "contradiction"), ({"no/such": 1}, "unknown-name"), ({"limits/bestsol": "few"}, "malformed"),
        ({"limits/gap": 0.1}, "contradiction"),
    ],
)  # fmt: skip
def test_parameters_that_have_a_common_name_or_none_are_refused(extra, code):
    with pytest.raises(UsageError, check=coded(code)):
        run(program([1], [[2]], 3, INF, 0, 9, integer=[0]), extra=extra)


@needs_scip
@pytest.mark.parametrize("extra", [{"separating/maxrounds": "0"}, {"presolving/maxrounds": "0"}, {"misc/usesymmetry": "0"}])
def test_own_parameters_are_taken(extra):
    assert run(program([1], [[2]], 3, INF, 0, 9, integer=[0]), extra=extra).objective == pytest.approx(2.0)


@needs_scip
def test_linear_programs_have_no_limit_on_iterations():
    with pytest.raises(UsageError, match="time limit"):
        run(program([1], [[1]], 1, INF), iterations=3)


@needs_scip
def test_scip_prints_nothing_of_its_own(capfd):
    run(program([1], [[2]], 3, INF, 0, 9, integer=[0]))
    captured = capfd.readouterr()
    assert (captured.out, captured.err) == ("", "")
