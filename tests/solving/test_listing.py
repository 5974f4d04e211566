"""Tables of solvers and heuristics: one row each, and for a problem what each lacks, which is what ``solve`` refuses it for."""

import pytest
from selection_problems import cover_30

import waybound as wb
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.errors import UnsupportedError
from waybound.solvers.backend import BACKENDS, Engine
from waybound.solving.listing import heuristic_table, solver_table
from waybound.solving.method import missing_features

PROBLEMS = {"routing": lambda: wb.read("demo-tiny"), "selection": lambda: cover_30(3), "max-min": lambda: wb.read("sata-s3")}


def test_every_solver_and_every_heuristic_has_one_row() -> None:
    assert [row.name for row in solver_table()] == list(BACKENDS)
    assert [row.name for row in heuristic_table()] == list(HEURISTICS)
    assert all(row.missing == () for row in [*solver_table(), *heuristic_table()])


def test_a_row_tells_what_a_solver_takes_and_how_to_get_it() -> None:
    rows = {row.name: row for row in solver_table()}
    assert rows["highs"].kind == "program" and {"LP", "MILP"} <= set(rows["highs"].takes.split(", "))
    assert rows["highs"].installed and rows["highs"].version.startswith("1.") and rows["highs"].install == "pip install highspy"
    assert (rows["pyvrp"].kind, rows["pyvrp"].takes) == ("problem", "routing problems")


def test_a_row_tells_what_a_heuristic_promises_and_is_asked_with() -> None:
    rows = {row.name: row for row in heuristic_table()}
    assert rows["sequential-greedy"].guarantee and "order" in rows["sequential-greedy"].parameters
    assert rows["savings"].guarantee == "no guarantee" and rows["savings"].family == "routing"


@pytest.mark.parametrize("family", PROBLEMS)
def test_forms_are_named_for_solvers_of_programs_alone(family: str) -> None:
    problem = PROBLEMS[family]()
    for row in solver_table(problem):
        if issubclass(BACKENDS[row.name], Engine):
            assert row.forms == ()
        else:
            assert set(row.forms) <= set(problem.forms()) and (bool(row.forms) or bool(row.missing))
        assert row.missing == tuple(sorted(missing_features(row.name, problem)[0]))


@pytest.mark.parametrize("family", PROBLEMS)
def test_solve_refuses_exactly_what_the_tables_say_is_lacking(family: str) -> None:
    problem = PROBLEMS[family]()
    for row in solver_table(problem):
        if row.missing and row.installed:
            with pytest.raises(UnsupportedError):
                wb.solve(problem, row.name, time_limit=1, bound_time=0)
    for heuristic in heuristic_table(problem):
        if heuristic.missing:
            with pytest.raises(UnsupportedError):
                wb.solve(problem, heuristic=heuristic.name, time_limit=1, bound_time=0)
