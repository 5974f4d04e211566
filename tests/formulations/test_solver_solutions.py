from pathlib import Path

import pytest
from typer.testing import CliRunner

import waybound as wb
from waybound.cli.app import app
from waybound.formulations.forms import FORMS
from waybound.formulations.programs.solution_files import SolverFile
from waybound.formulations.solver_solutions import answer_of_solver


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("solved") / "model.sol"
    made = wb.read("demo-tiny").compile("three-index").to_highs()
    made.run()
    made.writeSolution(str(path), 0)
    return path


def test_the_form_is_found_or_named(file: Path) -> None:
    problem = wb.read("demo-tiny")
    best = wb.judge(problem, file)
    assert best.feasible and best.objective == pytest.approx(384.7341400722)
    assert wb.judge(problem, file, form="three-index").objective == best.objective
    with pytest.raises(wb.InputError, match="as of its form two-index-mtz it"):
        wb.judge(problem, file, form="two-index-mtz")


@pytest.mark.parametrize(("other", "settings"), [("demo-c25", {}), ("demo-tiny", {"customers": 6}), ("figure-3-3", {})])
def test_a_solution_of_another_model_is_refused(file: Path, other: str, settings: dict[str, int]) -> None:
    with pytest.raises(wb.InputError, match=r"model\.sol: is a solution of another model than ") as error:
        wb.judge(wb.read(other, **settings), file)
    assert "\n" not in str(error.value)


def test_a_solution_of_the_same_size_is_told_by_its_objective(file: Path) -> None:
    """The same names in the same number, but other distances."""
    stretched = wb.read("demo-tiny", convention="ceil")
    with pytest.raises(wb.InputError, match=r"has the objective .* by its values; expected the objective that it states"):
        wb.judge(stretched, file, form="three-index")


def test_the_command_line_takes_it_and_says_whose_it_is(file: Path) -> None:
    ended = CliRunner(env={"COLUMNS": "160"}).invoke(app, ["check", "demo-tiny", str(file), "--form", "three-index"])
    assert ended.exit_code == 0 and "a solution of HiGHS to the form three-index" in ended.stdout


def test_a_problem_without_forms_says_so(registered) -> None:
    problem = wb.read("demo-tiny")
    for name in problem.forms():
        from dataclasses import replace

        registered(FORMS, name, replace(FORMS[name], features=frozenset()))
    with pytest.raises(wb.InputError, match="is a solution of HiGHS, and no form writes demo-tiny down"):
        answer_of_solver(problem, SolverFile("HiGHS"))


def test_values_of_the_form_that_are_no_answer_are_told_from_those_of_another_model() -> None:
    with pytest.raises(wb.InputError, match=r"^is a solution of its form two-index-mtz, and no answer to demo-tiny: a route ends"):
        answer_of_solver(wb.read("demo-tiny"), SolverFile("HiGHS", {"x(0,1)": 1.0}), "two-index-mtz")
