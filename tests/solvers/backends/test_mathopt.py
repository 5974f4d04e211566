import math

import numpy as np
import pytest
from coded import coded
from programs import program
from sata_cases import CASES

import waybound as wb
from waybound import UnsupportedError, UsageError, WinnerTakesAllSATA
from waybound.formulations.programs.program import INTEGERS, QUADRATIC
from waybound.formulations.programs.reductions.reduction import Irreducible
from waybound.solvers.backend import LIMITS, STATUSES, Control, Options
from waybound.solvers.backends import mathopt as module
from waybound.solvers.backends.mathopt import PROGRAMS, REASONS, REDUCTIONS, MathOpt, SeparableObjective

INF = math.inf
LP = program([1, 1], [[1, 2], [3, 1]], [4, 6], INF)
MILP = program([5, 4], [[2, 3]], -INF, 5, 0, 9, integer=[0, 1], sense="max")
PRODUCT = program([0, 0], [[1, 1]], -INF, 2, 0, 1, integer=[0, 1], sense="max", quadratic=[[0, 1], [1, 0]])


def run(p, variant="", control=None, **options):
    return MathOpt(variant).run(p, Options(**options), control or Control())


def test_every_reason_and_limit_has_one_of_ours():
    from ortools.math_opt.python import mathopt

    assert set(REASONS) == set(mathopt.TerminationReason.__members__)
    assert set(REASONS.values()) <= set(STATUSES)
    assert set(module.LIMITS) <= set(mathopt.Limit.__members__)
    assert set(module.LIMITS.values()) <= set(LIMITS)


def test_squares_pass_and_products_are_refused():
    assert SeparableObjective().apply(program([1, 1], [[1, 1]], 1, 2)) == ()
    assert SeparableObjective().apply(program([1, 1], [[1, 1]], 1, 2, quadratic=[[2, 0], [0, 1]])) == ()
    with pytest.raises(Irreducible, match="products of two variables"):
        SeparableObjective().apply(program([1, 1], [[1, 1]], 1, 2, quadratic=[[2, -1], [-1, 1]]))


@pytest.mark.parametrize(("alias", "solver"), [("scip", "gscip"), ("SCIP", "gscip"), ("cpsat", "cp-sat"), ("HiGHS", "highs"), ("", "")])
def test_solvers_go_by_several_names(alias, solver):
    assert MathOpt(alias).solver == solver


def test_unknown_solvers_are_refused_with_those_there_are():
    with pytest.raises(UsageError, match="gscip"):
        MathOpt("gurobi")


def test_without_a_name_the_program_decides():
    assert run(LP).statistics["solver"] == "glop"
    assert run(MILP).statistics["solver"] == "gscip"


@pytest.mark.parametrize("solver", [s for s in PROGRAMS if not MathOpt(s).able(PRODUCT.features())])
def test_a_quadratic_objective_is_an_unsupported_feature_that_names_others(solver):
    with pytest.raises(UnsupportedError, match=r"MIQP programs; can take it: .*mathopt:gscip"):
        run(PRODUCT, solver)


def test_the_user_meets_the_same_error_through_solve():
    problem = WinnerTakesAllSATA(CASES["S3"].graph)
    with pytest.raises(UnsupportedError, match=r"mathopt:gscip"):
        wb.solve(problem, "mathopt:pdlp", form="product")
    for solver in ("mathopt:highs", "mathopt:cp-sat"):
        assert "linear-products" in [link.name for link in wb.solve(problem, solver, form="product", bound_time=0).chain]
    assert wb.solve(problem, "mathopt", form="product", bound_time=0).objective == 31.0
    assert wb.solve(problem, "mathopt:scip", form="product", bound_time=0).objective == 31.0


def test_an_error_inside_mathopt_becomes_an_unsupported_feature(monkeypatch):
    # MathOpt raises the same for whatever a solver lacks; here the programs are declared too widely.
    monkeypatch.setitem(PROGRAMS, "highs", (INTEGERS | QUADRATIC,))
    monkeypatch.setitem(REDUCTIONS, "highs", ())
    with pytest.raises(UnsupportedError, match=r"quadratic objectives.*can take it: .*mathopt:gscip"):
        run(PRODUCT, "highs")


def test_the_product_of_two_binaries_is_maximised_by_scip():
    assert run(PRODUCT, "gscip").objective == pytest.approx(1.0)


def test_cp_sat_gets_whole_variables_only():
    # It would round x to 2 without a word: the optimum is 5 / 3.
    third = program([1, 1], [[3, 0], [1, 1]], [5, 1], INF, 0, 9, integer=[1])
    with pytest.raises(UnsupportedError, match="continuous variables"):
        run(third, "cp-sat")
    step = program([1, 1], [[1, -1]], 0, INF, [1, 0], 9, integer=[0], sense="max")
    assert run(step, "cp-sat").objective == pytest.approx(18.0)


@pytest.mark.parametrize("solver", PROGRAMS)
def test_unknown_parameters_are_refused(solver):
    with pytest.raises(UsageError, check=coded("unknown-name")):
        run(MILP if MathOpt(solver).able(INTEGERS) else LP, solver, extra={"no_such_option": 1})


@pytest.mark.parametrize(
    ("solver", "extra"),
    [
        ("highs", {"presolve": "off"}), ("gscip", {"separating/maxrounds": "0"}), ("gscip", {"limits/memory": "1000.0"}),
        ("cp-sat", {"linearization_level": "2"}), ("glop", {"use_preprocessing": "false"}), ("pdlp", {"major_iteration_frequency": "32"}),
    ],
)  # fmt: skip
def test_own_parameters_are_taken(solver, extra):
    p = MILP if MathOpt(solver).able(INTEGERS) else LP
    assert run(p, solver, extra=extra).objective == pytest.approx(10.0 if p is MILP else 2.8, abs=1e-6)


def test_common_options_of_highs_are_not_taken_twice():
    with pytest.raises(UsageError, match="time limit"):
        run(MILP, "highs", extra={"time_limit": 3})


def test_first_order_points_meet_the_rows():
    rng = np.random.default_rng(0)
    a = rng.random((40, 60))
    result = run(program(rng.random(60), a, a.sum(axis=1) * 0.3, INF, 0, 1), "pdlp")
    assert result.status == "optimal"
    assert result.objective == pytest.approx(result.bound, abs=1e-6)


def test_scip_prints_nothing_of_its_own(capfd):
    run(MILP, "gscip")
    captured = capfd.readouterr()
    assert (captured.out, captured.err) == ("", "")


def test_an_unbounded_program_is_no_fault_of_scip():
    result = run(program([-1, -1], [[1, -1]], -1, 1, integer=[0, 1]), "gscip")
    assert result.status in ("unbounded", "infeasible_or_unbounded")


def test_pdlp_refuses_products_and_names_who_takes_them():
    products = program([1, 1], [[1, 1]], 1, 2, quadratic=[[2, -1], [-1, 2]])
    with pytest.raises(UnsupportedError, match=r"mathopt:pdlp .*products of two variables; can take it: .*highs"):
        MathOpt("pdlp").run(products, Options(), Control())
