"""A solver's claims against what was checked: what refutes what, and what refutes nothing."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from waybound.formulations.evaluation import Evaluation, Violation
from waybound.formulations.programs.exactness import Exactness
from waybound.instances.errors import CheckFailedError
from waybound.solvers.backend import RawResult
from waybound.solving.claims import CLAIM_TOLERANCE, check_bound, check_feasibility, check_objective, check_verified

EXACT, RELAXATION, RESTRICTION = Exactness.EXACT, Exactness.RELAXATION, Exactness.RESTRICTION


def worth(*values: float, violations: tuple[Violation, ...] = ()) -> Evaluation:
    return Evaluation(values, (), violations, {})


def refuted(check: Callable[..., None], *given: Any) -> str | None:
    try:
        check(*given)
    except CheckFailedError as fault:
        return str(fault)
    return None


# -- the objective -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sense", "claimed", "value", "false"),
    [
        ("min", 10.0, 12.0, True), ("min", 12.0, 10.0, False), ("max", 12.0, 10.0, True), ("max", 10.0, 12.0, False),
        ("min", 10.0, 10.0 * (1 + CLAIM_TOLERANCE / 2), False), ("min", 10.0, 10.0 * (1 + 2 * CLAIM_TOLERANCE), True),
        ("min", 1e-9, 1.2e-9, True), ("max", 1e12, 1e12 - 1.0, False),
    ],
)  # fmt: skip
def test_an_answer_worse_than_claimed_refutes_the_objective_and_a_better_one_does_not(
    sense: str, claimed: float, value: float, false: bool
) -> None:
    found = refuted(check_objective, "liar", (sense,), RawResult("feasible", objective=claimed), worth(value))
    assert (found is not None) == false
    if found:
        assert f"liar claims the objective {claimed!r}" in found and repr(value) in found


def test_what_is_added_up_to_a_small_value_is_its_scale() -> None:
    """Terms of 1e6 that cancel to 1 cannot be told apart by 1e-3."""
    result = RawResult("feasible", objective=1.0)
    assert refuted(check_objective, "s", ("min",), result, Evaluation((1.001,), (), (), {}, sizes=(2e6,))) is None
    assert refuted(check_objective, "s", ("min",), result, Evaluation((1.001,), (), (), {}, sizes=(2.0,)))


def test_no_claim_and_several_levels_are_not_compared() -> None:
    assert refuted(check_objective, "s", ("min",), RawResult("optimal"), worth(5.0)) is None
    assert refuted(check_objective, "s", ("min",), RawResult("optimal", objective=1.0), worth(5.0, 6.0)) is None


# -- feasibility -------------------------------------------------------------------------------------------------------


def test_a_claimed_answer_that_breaks_something_is_told_with_the_worst() -> None:
    broken = worth(1.0, violations=(Violation("load", "by a little", 2.0), Violation("visits", "by much", 7.0)))
    for status in ("optimal", "feasible"):
        found = refuted(check_feasibility, "liar", RawResult(status), broken, EXACT)
        assert found == f"liar claims a {status} answer, but it breaks 2 constraints; the worst: by much (by 7)"
    assert refuted(check_feasibility, "s", RawResult("unknown"), broken, EXACT) is None
    assert refuted(check_feasibility, "s", RawResult("optimal"), broken, RELAXATION) is None
    assert refuted(check_feasibility, "s", RawResult("optimal"), broken, RESTRICTION)
    assert refuted(check_feasibility, "s", RawResult("optimal"), worth(1.0), EXACT) is None


# -- bounds, optima and infeasibility ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sense", "result", "words"),
    [
        ("min", RawResult("infeasible"), "claims that there is no answer, but one of value 10.0"),
        ("min", RawResult("feasible", bound=11.0), "claims the bound 11.0, but an answer of value 10.0"),
        ("max", RawResult("feasible", bound=9.0), "claims the bound 9.0, but an answer of value 10.0"),
        ("min", RawResult("optimal", objective=11.0), "claims the optimum 11.0, but an answer of value 10.0"),
        ("max", RawResult("optimal", objective=9.0), "claims the optimum 9.0, but an answer of value 10.0"),
    ],
)
def test_an_answer_of_10_refutes_a_claim_that_it_beats_where_the_claim_is_meant_for_the_problem(
    sense: str, result: RawResult, words: str
) -> None:
    assert words in str(refuted(check_bound, "liar", (sense,), result, worth(10.0), EXACT))
    assert refuted(check_bound, "liar", (sense,), result, None, EXACT) is None
    assert refuted(check_bound, "liar", (sense,), result, worth(10.0), RESTRICTION) is None
    assert refuted(check_bound, "liar", (sense,), result, worth(10.0), Exactness.NEITHER) is None


@pytest.mark.parametrize(
    ("sense", "result"),
    [
        ("min", RawResult("feasible", bound=9.0)), ("max", RawResult("feasible", bound=11.0)), ("min", RawResult("optimal", objective=9.0)),
        ("max", RawResult("optimal", objective=11.0)), ("min", RawResult("feasible", objective=11.0)), ("min", RawResult("feasible")),
        ("min", RawResult("feasible", bound=10.0 * (1 + CLAIM_TOLERANCE / 2))), ("min", RawResult("unknown", bound=-1e300)),
    ],
)  # fmt: skip
def test_what_an_answer_of_10_does_not_beat_is_not_refuted_by_it(sense: str, result: RawResult) -> None:
    assert refuted(check_bound, "s", (sense,), result, worth(10.0), EXACT) is None


def test_a_relaxations_optimum_is_none_of_the_problem_but_its_infeasibility_and_bound_are() -> None:
    assert refuted(check_bound, "s", ("min",), RawResult("optimal", objective=11.0), worth(10.0), RELAXATION) is None
    assert refuted(check_bound, "s", ("min",), RawResult("infeasible"), worth(10.0), RELAXATION)
    assert refuted(check_bound, "s", ("min",), RawResult("feasible", bound=11.0), worth(10.0), RELAXATION)


def test_an_optimum_beyond_a_verified_bound_is_refuted() -> None:
    claim = RawResult("optimal", objective=8.0)
    assert "claims the optimum 8.0, but the verified bound is 9.0" in str(refuted(check_verified, "liar", "min", claim, 9.0, EXACT))
    assert refuted(check_verified, "liar", "min", claim, 9.0, RESTRICTION)
    assert refuted(check_verified, "liar", "max", claim, 7.0, EXACT)
    for sense, bound in (("min", 7.0), ("min", 8.0), ("max", 9.0), ("min", None)):
        assert refuted(check_verified, "s", sense, claim, bound, EXACT) is None
    assert refuted(check_verified, "s", "min", claim, 9.0, RELAXATION) is None
    assert refuted(check_verified, "s", "min", RawResult("feasible", objective=8.0), 9.0, EXACT) is None
    assert refuted(check_verified, "s", "min", RawResult("optimal"), 9.0, EXACT) is None
    assert refuted(check_verified, "s", "min", claim, 9.0, EXACT, 1e9) is None
