from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from programs import program

from waybound.instances.errors import UsageError
from waybound.reports.battery import examining
from waybound.reports.battery.cases import Case, Draw, cases
from waybound.reports.battery.examining import GAVE_UP, RIGHT, examinable, examine, outcome, verdict
from waybound.reports.battery.truth import Truth
from waybound.solvers.backend import BACKENDS, Options, RawResult

ONE = program([8.0], [], [], [], 0.0, 1.0)


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


@pytest.mark.slow
def test_highs_is_examined_and_right():
    told = []
    made = examine("highs", Draw(19), progress=lambda done, total: told.append((done, total)))
    assert (made.solver, made.version) == ("highs", BACKENDS["highs"].version())
    assert (len(made.taken), made.wrong, made.interrupted) == (19, [], False)
    assert told[-1] == (19, 19)
    assert {o.verdict for o in made.outcomes} == {RIGHT}


@pytest.mark.slow
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
