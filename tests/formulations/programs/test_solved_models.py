from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coded import coded

import waybound as wb
from waybound import Compiled, InputError, UsageError
from waybound.formulations.programs.solved_models import vector_from


@pytest.fixture(scope="module")
def model() -> Compiled:
    return wb.read("demo-tiny").compile("two-index-load-flow")


@pytest.fixture(scope="module")
def solved(model: Compiled) -> Any:
    highs_model = model.to_highs()
    highs_model.run()
    return highs_model


def test_each_package_hands_its_solution_back_under_the_names_of_the_export(model: Compiled, solved: Any, tmp_path: Path) -> None:
    import pulp
    import pyscipopt
    from ortools.math_opt.python import mathopt

    problem, best = model.problem, None
    columns = [solved.getColName(k)[1] for k in range(model.program.num_variables)]
    pulp_model = model.to_pulp()
    pulp_model.solve(pulp.PULP_CBC_CMD(msg=False))
    cvx = model.to_cvxpy()
    cvx.solve(solver="HIGHS")
    model.write(tmp_path / "model.mps")
    scip = pyscipopt.Model()
    scip.hideOutput()
    scip.readProblem(str(tmp_path / "model.mps"))
    scip.optimize()
    solved.writeSolution(str(tmp_path / "raw.sol"), 0)
    solved.writeSolution(str(tmp_path / "table.sol"), 1)
    x = np.array(solved.getSolution().col_value)
    nameless = model.to_highs(names=False)
    nameless.run()
    models: list[Any] = [solved, nameless, pulp_model, cvx, scip, mathopt.solve(model.to_mathopt(), mathopt.SolverType.GSCIP)]
    ways: list[Any] = [
        *models, x, x.tolist(),
        dict(zip(columns, x.tolist(), strict=True)), {v.name: v.value() for v in pulp_model.variables()}, tmp_path / "raw.sol",
        str(tmp_path / "table.sol"),
    ]  # fmt: skip
    assert {v.name for v in pulp_model.variables()} <= {*columns, "__dummy"}
    assert {v.name for v in model.to_mathopt().variables()} == set(columns)
    for way in ways:
        verdict = wb.judge(problem, model.answer(way))
        best = verdict.objective if best is None else best
        assert verdict.feasible and verdict.objective == pytest.approx(best), type(way)
    begun = wb.solve(problem, "pyvrp", start=pulp_model, iterations=1, bound_time=0)
    assert begun.objective <= best * (1 + 1e-9) and begun.statistics["start"] == "used"
    for solver_model in models:  # the problem finds the form, or is told it
        for form in (None, "two-index-load-flow"):
            assert wb.judge(problem, solver_model, form=form).objective == pytest.approx(best), type(solver_model)


@pytest.mark.parametrize(
    ("solution", "message"),
    [
        ([1.0, 2.0], r"the vector has another size than the model; expected \(76,\); found \(2,\)"),
        ([], "the vector has another size than the model"),
        (np.full(76, np.nan), "holds a value that is not finite"),
        ({"x(0,1)": np.nan}, r"the value of variable x\(0,1\) is not finite"),
        ({"x(0,1)": None}, "the model holds no solution"),
        ({"x(0,1)": "one"}, r"the value of variable x\(0,1\) must be a number; found .*one"),
        ({"x(0,1)": [1.0]}, r"the value of variable x\(0,1\) must be a number"),
        ({"y": 1.0}, "names a variable that does not exist"),
    ],
)
def test_what_is_no_solution_of_the_model_is_refused(model: Compiled, solution: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        vector_from(model.program, solution)


def test_what_is_no_solution_at_all_is_refused(model: Compiled, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="a solution is a file, values by name, a vector or a solved model, not object"):
        vector_from(model.program, object())
    (tmp_path / "a.sol").write_text("Route #1: 1\n")
    with pytest.raises(InputError, match=r"a\.sol: is no solver's solution file"):
        vector_from(model.program, tmp_path / "a.sol")


@pytest.mark.parametrize("package", ["highs", "pulp", "cvxpy"])
def test_a_model_without_a_solution_or_of_something_else_is_refused(model: Compiled, package: str) -> None:
    with pytest.raises(InputError, check=coded("missing")):
        vector_from(model.program, getattr(model, f"to_{package}")())
    other = getattr(wb.read("demo-tiny", customers=4).compile("two-index-load-flow"), f"to_{package}")()
    _solve(package, other)
    with pytest.raises(
        InputError, match=r"^the answer is a solution of another model than demo-tiny: as of its form \S+ it has another number"
    ):
        wb.judge(model.problem, other)


@pytest.mark.parametrize("package", ["highs", "pulp", "cvxpy", "scip"])
def test_a_solved_model_of_the_same_size_is_told_by_its_objective(package: str, tmp_path: Path) -> None:
    own, other = (wb.read("demo-tiny", customers=3, convention=convention) for convention in ("exact", "trunc1"))
    compiled = own.compile("two-index-mtz")
    if package == "scip":
        import pyscipopt

        compiled.write(tmp_path / "model.mps")
        model = pyscipopt.Model()
        model.hideOutput()
        model.readProblem(str(tmp_path / "model.mps"))
    else:
        model = getattr(compiled, f"to_{package}")()
    _solve(package, model)
    assert wb.judge(own, model, form="two-index-mtz").feasible
    with pytest.raises(InputError, match=r"has the objective .* by its values; expected the objective that it states"):
        wb.judge(other, model, form="two-index-mtz")


def test_what_cbc_leaves_behind_of_an_infeasible_model_is_no_solution(model: Compiled) -> None:
    import pulp

    pulp_model = model.to_pulp()
    pulp_model += pulp.lpSum(pulp_model.variables()) <= -1
    _solve("pulp", pulp_model)
    with pytest.raises(InputError, check=coded("missing")):
        model.answer(pulp_model)


def test_a_model_of_scip_without_a_problem_is_refused(model: Compiled) -> None:
    import pyscipopt

    scip_model = pyscipopt.Model()
    scip_model.freeProb()
    with pytest.raises(InputError, check=coded("missing")):
        model.answer(scip_model)


def test_what_is_no_result_of_mathopt_is_refused(model: Compiled) -> None:
    from ortools.math_opt.python import mathopt

    for given in (model.to_mathopt(), mathopt.SolveParameters()):
        with pytest.raises(InputError, match=f"MathOpt's {type(given).__name__} is no result; expected what mathopt.solve returned"):
            wb.judge(model.problem, given)


def test_values_in_text_are_numbers(model: Compiled) -> None:
    assert vector_from(model.program, {"x(0,1)": "1"}).sum() == 1.0


def _solve(package: str, model: Any) -> None:
    import pulp

    if package == "scip":
        model.optimize()
        return
    if package == "highs":
        model.run()
    else:
        model.solve(**({"solver": pulp.PULP_CBC_CMD(msg=False)} if package == "pulp" else {"solver": "HIGHS"}))
