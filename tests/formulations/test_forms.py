import ast
import inspect
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from programs import program

import waybound as wb
from waybound import Compiled, Exactness, UnsupportedError, UsageError
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.forms import FORMS, Form
from waybound.solving.explaining import explain
from waybound.solving.method import missing_features

PROBLEM = ArrayProblem(program([3, 2], [[2, 3]], -np.inf, 10.5, 0, [4, 5], integer=[0, 1], sense="max"), "knapsack")
OPTIMUM = 12.0  # at (4, 0)


ARRAYS = FORMS["arrays"]


@pytest.fixture
def form(registered: Any) -> Any:
    """``form(exactness, most, name="limited")``: one of bare programs, before all others, whose variables are ``most`` at most."""

    def add(exactness: Exactness, most: float, name: str = "limited") -> None:
        def build(problem: ArrayProblem) -> Compiled:
            made = ARRAYS.build(problem)
            columns = tuple(replace(b, upper=np.full(b.size, most)) for b in made.program.variables)
            return replace(made, program=replace(made.program, name=name, variables=columns))

        registered(FORMS, name, Form(name, "arrays", ARRAYS.features, build, exactness, order=-1))

    return add


def test_a_restriction_is_never_the_default(form: Any) -> None:
    form(Exactness.RESTRICTION, 1.0)
    assert PROBLEM.forms() == ["limited", "arrays"]
    assert PROBLEM.compile().form == "arrays"
    for solver in (None, "highs", "cpsat", "pulp"):
        solution = wb.solve(PROBLEM, solver, bound_time=0)
        assert (solution.objective, solution.form, solution.status) == (OPTIMUM, "arrays", "optimal")


def test_a_restriction_that_is_named_gives_answers_and_no_bound(form: Any) -> None:
    form(Exactness.RESTRICTION, 1.0)
    assert PROBLEM.compile("limited").exactness is Exactness.RESTRICTION
    assert PROBLEM.compile("limited", relax=True).exactness is Exactness.NEITHER
    solution = wb.solve(PROBLEM, "highs", form="limited", bound_time=0)
    assert (solution.objective, solution.form, solution.status) == (5.0, "limited", "feasible")
    assert solution.bound is None
    bounded = wb.solve(PROBLEM, "highs", form="limited")
    assert bounded.bound is not None and bounded.bound >= OPTIMUM


def test_an_infeasible_restriction_proves_nothing(form: Any) -> None:
    form(Exactness.RESTRICTION, -1.0)
    assert wb.solve(PROBLEM, "highs", form="limited", bound_time=0).status == "unknown"
    with pytest.raises(UsageError, match="limited is a restriction"):
        explain(PROBLEM, form="limited")


def test_a_relaxation_that_is_named_gives_a_bound(form: Any) -> None:
    form(Exactness.RELAXATION, 10.0)
    assert PROBLEM.compile().form == "arrays"
    solution = wb.solve(PROBLEM, "highs", form="limited", bound_time=0)
    assert solution.bound == 15.0  # at (5, 0), which is no answer
    assert solution.answer is None or solution.objective <= OPTIMUM


def test_where_no_form_is_exact_one_has_to_be_named(form: Any) -> None:
    form(Exactness.RESTRICTION, 1.0, "arrays")
    words = "no form of arrays is exact; name one of arrays"
    for call in (PROBLEM.compile, lambda: wb.solve(PROBLEM), lambda: wb.solve(PROBLEM, "highs")):
        with pytest.raises(UsageError, match=words):
            call()
    assert explain(PROBLEM).verdict == "feasible"
    assert missing_features("highs", PROBLEM) == (frozenset({"an exact form for this problem"}), ("arrays",))


def test_where_no_form_fits_the_nearest_is_named_with_what_it_lacks() -> None:
    free = wb.SubmodularSelection(wb.UserFunction(lambda sets: np.zeros(len(sets)), 2), wb.Cardinality(1))
    with pytest.raises(UnsupportedError, match=r"^no form can take this problem: the nearest, [a-z-]+, does not handle "):
        free.compile()


# -- every form shows what it writes -----------------------------------------------------------------------------------

TESTS = Path(__file__).resolve().parents[1]


def text_to_text(name: str, tests: Path = TESTS) -> str | None:
    """What is missing for a form to have a test from text to text where its module is mirrored; None if nothing is."""
    build = FORMS[name].build
    module = inspect.getmodule(getattr(build, "func", build))
    path = tests.joinpath(*module.__name__.split(".")[1:-1]) / f"test_{module.__name__.rsplit('.', 1)[1]}.py"
    wanted = f"test_{name.replace('-', '_')}_from_text_to_text"
    if not path.is_file():
        return f"{name}: no {path.relative_to(tests)}"
    found = [node for node in ast.parse(path.read_text()).body if isinstance(node, ast.FunctionDef) and node.name == wanted]
    if not found:
        return f"{name}: no {wanted} in {path.relative_to(tests)}"
    body = list(ast.walk(found[0]))
    texts = [node.value for node in body if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    shown = any(isinstance(node, ast.Assert) for node in body) and name in texts and any(text.count("\n") > 3 for text in texts)
    return None if shown else f"{name}: {wanted} does not compare the form with rows that it spells out"


def test_every_form_has_a_test_from_text_to_text_where_its_module_is_mirrored(tmp_path: Path) -> None:
    assert [fault for name in FORMS if (fault := text_to_text(name))] == []
    place = "formulations/sata/forms/test_linearisations.py"
    assert text_to_text("product", tmp_path) == f"product: no {place}"
    empty = tmp_path / place
    empty.parent.mkdir(parents=True)
    empty.write_text("def test_product():\n    pass\n")
    assert text_to_text("product", tmp_path) == f"product: no test_product_from_text_to_text in {place}"
    empty.write_text("def test_product_from_text_to_text():\n    assert True\n")
    assert str(text_to_text("product", tmp_path)).endswith("does not compare the form with rows that it spells out")
