"""What is said of what solvers say: verdicts, crashes, interrupts, tables and files."""

from __future__ import annotations

import os
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from waybound.formulations.programs.program import Program, Variables
from waybound.instances.errors import UsageError
from waybound.reports.battery import examining
from waybound.reports.battery.cases import Case, Draw, cases
from waybound.reports.battery.examining import GAVE_UP, RIGHT, Examination, examinable, examine, outcome, verdict
from waybound.reports.battery.report import examination_table, summary_lines, to_json, write_wrong
from waybound.reports.battery.truth import Truth
from waybound.solvers.backend import BACKENDS, Options, RawResult

ONE = Program("one", "min", (Variables("x", lower=np.zeros(1), upper=np.ones(1), cost=np.array([8.0])),), ())


def case(truth: Truth, sense: str = "min") -> Case:
    return Case(0, "made", "arrays", None, replace(ONE, sense=sense), truth)  # type: ignore[arg-type]


def found(status: str, objective: float | None = None, bound: float | None = None) -> RawResult:
    return RawResult(status, answer=None if objective is None else np.array([objective / 8.0]), objective=objective, bound=bound)


FIVE, NONE, ENDLESS = Truth("optimal", Fraction(5)), Truth("infeasible"), Truth("unbounded")


@pytest.mark.parametrize(
    ("truth", "result", "expected"),
    [
        (FIVE, found("optimal", 5.0, 5.0), RIGHT),
        (FIVE, found("optimal", 5.00001, 5.0), RIGHT),
        (FIVE, found("optimal", 6.0, 6.0), "wrong optimum"),
        (FIVE, found("optimal", 4.0, 4.0), "wrong optimum"),
        (FIVE, found("feasible", 6.0, 4.0), GAVE_UP),
        (FIVE, found("feasible", 6.0, 5.5), "wrong optimum"),
        (FIVE, found("infeasible"), "false infeasible"),
        (FIVE, found("infeasible_or_unbounded"), "false infeasible"),
        (FIVE, found("unbounded"), "false unbounded"),
        (FIVE, found("unknown"), GAVE_UP),
        (FIVE, found("error"), GAVE_UP),
        (NONE, found("infeasible"), RIGHT),
        (NONE, found("optimal", 5.0, 5.0), "wrong optimum"),
        (NONE, found("feasible", 5.0), "wrong optimum"),
        (NONE, found("unbounded"), "false unbounded"),
        (NONE, found("infeasible_or_unbounded"), GAVE_UP),
        (ENDLESS, found("unbounded"), RIGHT),
        (ENDLESS, found("optimal", 5.0, 5.0), "wrong optimum"),
        (ENDLESS, found("feasible", 5.0), GAVE_UP),
        (ENDLESS, found("infeasible"), "false infeasible"),
    ],
)
def test_a_word_is_held_against_the_truth(truth, result, expected):
    assert verdict(case(truth), result) == expected


def test_the_sense_decides_what_is_too_good():
    assert verdict(case(FIVE, "max"), found("feasible", 6.0)) == "wrong optimum"
    assert verdict(case(FIVE, "max"), found("feasible", 4.0, 6.0)) == GAVE_UP
    assert verdict(case(FIVE, "max"), found("feasible", 4.0, 4.5)) == "wrong optimum"


def test_the_same_draw_gives_the_same_cases_whatever_is_asked_of_it():
    every = list(cases(Draw(30, 4)))
    (again,) = cases(Draw(30, 4), range(17, 18))
    assert (again.kind, again.form, again.truth) == (every[17].kind, every[17].form, every[17].truth)
    assert (again.program.matrix != every[17].program.matrix).nnz == 0
    assert np.array_equal(again.program.cost, every[17].program.cost)


def test_a_form_is_drawn_from_the_kinds_that_have_it():
    chosen = list(cases(Draw(20, 1, form="two-index-mtz")))
    assert {c.form for c in chosen} == {c.program.name for c in chosen} == {"two-index-mtz"}
    assert {"time-windows", "fleets"} <= {c.kind for c in chosen}


@pytest.mark.parametrize(
    ("asked", "word"),
    [({"kind": "windows"}, "time-windows"), ({"form": "max-min", "kind": "time-windows"}, "max-min"), ({"form": "nope"}, "nope")],
)
def test_what_the_battery_does_not_have_is_refused_by_name(asked, word):
    with pytest.raises(UsageError, match=word):
        Draw(3, **asked)


def test_highs_is_examined_and_right():
    told = []
    made = examine("highs", Draw(19), told=lambda done, total: told.append((done, total)))
    assert (made.solver, made.version, len(made.taken), made.wrong, made.interrupted) == (
        "highs",
        BACKENDS["highs"].version(),
        19,
        [],
        False,
    )
    assert told[-1] == (19, 19)
    assert {o.verdict for o in made.outcomes} == {RIGHT}


def test_a_case_that_ends_the_process_costs_itself_alone(monkeypatch):
    real, deaths = examining.run_in_process, []

    def dying(work, options, control):
        if work.numbers.start == 0:
            deaths.append(work)
            real(replace(work, numbers=range(2)), options, control)
            return RawResult("error", message="the solver's process was ended by SIGSEGV")
        return real(work, options, control)

    monkeypatch.setattr(examining, "run_in_process", dying)
    made = examine("highs", Draw(4))
    assert [o.verdict for o in made.outcomes] == [RIGHT, RIGHT, GAVE_UP, RIGHT]
    assert "SIGSEGV" in made.outcomes[2].said
    assert len(deaths) == 1


def test_an_interrupt_keeps_what_was_found(monkeypatch):
    def interrupted(work, options, control):
        control.publish(tuple(outcome("highs", c, work.options) for c in cases(work.draw, range(2))), 2.0)
        raise KeyboardInterrupt

    monkeypatch.setattr(examining, "run_in_process", interrupted)
    made = examine("highs", Draw(500))
    assert (len(made.outcomes), made.interrupted) == (2, True)


def test_options_of_the_solvers_own_overrule_and_unknown_ones_are_refused():
    (hard,) = cases(Draw(64, 1, "time-windows", "two-index-mtz"), range(16, 17))
    assert outcome("highs", hard, Options(extra={"presolve_rule_off": 0})).verdict == "false infeasible"
    assert outcome("highs", hard, Options()).verdict == RIGHT
    with pytest.raises(UsageError, match="presolve_rule"):
        outcome("highs", hard, Options(extra={"presolve_rule": 0}))


def test_who_takes_no_programs_is_refused():
    with pytest.raises(UsageError, match=r"pyvrp.*highs"):
        examine("pyvrp", Draw(1))


def test_solvers_within_a_solver_are_named_and_tell_their_librarys_version():
    assert {"highs", "pulp", "pulp:HiGHS", "cvxpy:HIGHS", "mathopt:highs"} <= set(examinable())
    assert f"highspy {BACKENDS['highs'].version()}" in examining.version_of(BACKENDS["cvxpy"]("HIGHS"))  # type: ignore[arg-type]


@pytest.fixture
def wrong() -> tuple[Draw, Examination]:
    draw = Draw(64, 1, "time-windows", "two-index-mtz")
    bare = Options(extra={"presolve_rule_off": 0})
    (hard,), (easy,) = cases(draw, range(16, 17)), cases(draw, range(3, 4))
    return draw, Examination("highs", "1", (outcome("highs", hard, bare), outcome("highs", easy, bare)))


def test_the_table_counts_by_solver_and_by_kind(wrong):
    _, made = wrong
    (row,) = examination_table([made]).rows
    assert row[:7] == ("highs", "1", "2", "0", "1", "0", "0")
    (row,) = examination_table([made], "kind").rows
    assert row[2:4] == ("time-windows", "2")


def test_a_false_word_is_told_with_the_truth_and_written_as_a_program_that_is_read_back(wrong, tmp_path):
    import highspy

    draw, made = wrong
    files = write_wrong(tmp_path / "new", draw, made)
    (line,) = summary_lines(made, files)
    assert "case 16 (time-windows, two-index-mtz): false infeasible: the program is optimal at" in line
    assert os.fspath(tmp_path) in line
    data = to_json(draw, [made], {"highs": files})
    assert data["solvers"][0]["false_infeasible"] == 1
    assert data["solvers"][0]["told"][0]["file"] == files[16]
    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    model.setOptionValue("presolve", "off")
    model.readModel(files[16])
    model.run()
    assert f"optimal at {model.getInfo().objective_function_value:.12g}" == made.outcomes[0].truth
