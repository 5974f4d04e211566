"""What a search says and hands over, held against what was checked."""

from typing import Any

import numpy as np
import pytest
from programs import program

from waybound import CheckFailedError, Evaluation, Exactness, InputError, NoAnswerError, SearchFailedError, Violation
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import Certificate, LevelBound
from waybound.solvers.backend import LevelClaim, RawResult
from waybound.solving.judging import CLAIM_TOLERANCE, Claim, Judge, contradictions, false_answer

KNAPSACK = ArrayProblem(program([3, 2], [[2, 3]], -np.inf, 10.5, 0, [4, 5], integer=[0, 1], sense="max"))
FULL, LESS, OVER = np.array([4.0, 0.0]), np.array([3.0, 1.0]), np.array([4.0, 5.0])


def judge(decode: Any = lambda raw: raw, exactness: Exactness = Exactness.EXACT, **more: Any) -> Judge:
    return Judge(KNAPSACK, "made", exactness, decode, [], **more)


def test_the_best_feasible_candidate_wins_whoever_brought_it() -> None:
    for order in ((FULL, LESS, OVER), (LESS, OVER, FULL), (OVER, FULL, LESS)):
        case = judge()
        case.start(order[0])
        case.incumbent(order[1])
        case.last_word(RawResult("unknown", answer=order[2]), prices=True)
        answer, value = case.best()
        assert answer is FULL and value is not None and value.objective == 12.0
        assert case.faults == []


def test_what_breaks_a_row_is_told_as_what_it_was() -> None:
    case = judge()
    case.start(OVER)
    case.incumbent(OVER)
    case.last_word(RawResult("unknown", answer=OVER), prices=True)
    assert [note.split(": row")[0] for note in case.notes] == [
        "the start is only a hint, for it breaks", "the last incumbent of made breaks", "the last answer of made breaks",
    ]  # fmt: skip
    assert case.best() == (None, None)


def test_a_claimed_answer_that_breaks_a_row_is_a_fault_and_costs_the_start_nothing() -> None:
    case = judge()
    case.start(LESS)
    case.last_word(RawResult("optimal", answer=OVER, objective=22.0), prices=True)
    assert len(case.faults) == 1 and case.faults[0].startswith("made claims an optimal answer, but it breaks 1 constraints")
    assert case.best()[0] is LESS


def test_a_claimed_answer_alone_that_breaks_a_row_is_an_error() -> None:
    case = judge()
    case.last_word(RawResult("feasible", answer=OVER), prices=True)
    with pytest.raises(CheckFailedError, match="claims a feasible answer"):
        case.best()


def test_a_false_objective_is_a_fault_only_where_it_is_meant_for_the_problem() -> None:
    for prices, faults in ((True, 1), (False, 0)):
        case = judge()
        case.last_word(RawResult("optimal", answer=FULL, objective=15.0), prices=prices)
        assert len(case.faults) == faults
        assert case.best()[0] is FULL


def unreadable(raw: Any) -> Any:
    raise InputError("is no answer of mine")


def broken(raw: Any) -> Any:
    raise IndexError("out of range")


def test_what_cannot_be_decoded_is_a_note_and_where_it_was_claimed_a_fault() -> None:
    case = judge(unreadable)
    case.incumbent(FULL)
    case.last_word(RawResult("optimal", answer=FULL), prices=True)
    assert case.notes == ["the last incumbent of made is no answer: is no answer of mine"]
    assert case.faults == ["the optimal answer claimed by made is no answer: is no answer of mine"]


def test_the_point_of_a_relaxation_claims_no_answer() -> None:
    case = judge(unreadable, Exactness.RELAXATION)
    case.last_word(RawResult("optimal", answer=FULL, objective=99.0), prices=False)
    assert case.faults == [] and case.notes == ["the relaxation's point is no answer: is no answer of mine"]
    assert case.best() == (None, None)


def test_an_error_of_the_program_costs_no_other_candidate_and_is_raised_where_there_is_none() -> None:
    case = judge(broken)
    case.incumbent(FULL)
    assert "the last incumbent of made could not be judged" in case.notes[0]
    with pytest.raises(IndexError):
        case.best()
    case.start(LESS)
    assert case.best()[0] is LESS


@pytest.mark.parametrize(
    ("crash", "kind", "words"),
    [
        (MemoryError("no room"), NoAnswerError, "made failed: out of memory"),
        (OSError("gone"), SearchFailedError, "made failed: OSError: gone"),
    ],
)
def test_what_ended_the_search_is_told_before_what_came_after(crash: Exception, kind: type[Exception], words: str) -> None:
    case = judge(broken, crash=crash)
    case.incumbent(FULL)
    with pytest.raises(kind, match=words) as told:
        case.best()
    assert told.value.__cause__ is crash


def test_an_answer_that_needs_no_search_counts_where_it_refutes_something() -> None:
    for refutes in (True, False):
        case = judge()
        case.at_hand(case.problem.answer_at_hand(), lambda judged, refutes=refutes: refutes)
        assert (case.best()[1] is not None) == refutes


def test_the_first_interrupt_costs_no_answer_and_the_second_one_does() -> None:
    for interrupts, kept in ((1, True), (2, False)):
        left = [KeyboardInterrupt()] * interrupts

        def decode(raw: Any, left: list[KeyboardInterrupt] = left) -> Any:
            if left:
                raise left.pop()
            return raw

        case = judge(decode)
        case.incumbent(FULL)
        if kept:
            assert case.best()[0] is FULL
        else:
            with pytest.raises(KeyboardInterrupt):
                case.best()


def test_nothing_is_nothing() -> None:
    case = judge(broken)
    case.start(None)
    case.incumbent(None)
    case.last_word(RawResult("infeasible"), prices=True)
    assert case.best() == (None, None) and case.notes == case.faults == []


EXACT, RELAXATION, RESTRICTION = Exactness.EXACT, Exactness.RELAXATION, Exactness.RESTRICTION


def worth(*values: float, violations: tuple[Violation, ...] = (), sizes: tuple[float, ...] = ()) -> Evaluation:
    return Evaluation(values, (), violations, {}, sizes)


def of_answer(said: RawResult, own: Evaluation, exactness: Exactness = EXACT, sense: str = "min") -> list[str]:
    return list(false_answer(Claim("liar", said, exactness, own), (sense,)))


def of_problem(
    said: RawResult, best: Evaluation | None = None, exactness: Exactness = EXACT, sense: str = "min", **proved: Any
) -> list[str]:
    certificate = Certificate("", "", sense, "file", None, **proved)
    return contradictions(Claim("liar", said, exactness), (sense,), best, certificate)


# -- the answer that is handed over ------------------------------------------------------------------------------------


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
    found = of_answer(RawResult("feasible", objective=claimed), worth(value), sense=sense)
    assert bool(found) == false
    if found:
        assert f"liar claims the objective {claimed!r}" in found[0] and repr(value) in found[0]


def test_what_is_added_up_to_a_small_value_is_its_scale() -> None:
    """Terms of 1e6 that cancel to 1 cannot be told apart by 1e-3."""
    said = RawResult("feasible", objective=1.0)
    assert not of_answer(said, worth(1.001, sizes=(2e6,)))
    assert of_answer(said, worth(1.001, sizes=(2.0,)))


@pytest.mark.parametrize("factor", [1.0, 2.0**-30, 2.0**30])
def test_where_nothing_is_added_up_the_scale_is_what_the_solver_counts_as_one(factor: float) -> None:
    """With costs of 3 and 7 it sees no difference between 0 and 1e-15, and one between 0 and 0.1, in whatever unit."""
    searched = program([3.0 * factor, 7.0 * factor], [[1.0, 1.0]], 0, 5, 0, 9, integer=[0, 1])
    for objective, false in ((-1e-15, False), (-1e-6, False), (-0.1, True)):
        said = RawResult("optimal", objective=factor * objective)
        claim = Claim("liar", said, EXACT, worth(0.0, sizes=(0.0,)), program=searched)
        assert bool(list(false_answer(claim, ("min",)))) == false
        assert bool(contradictions(claim, ("min",), claim.own, Certificate("", "", "min", "file", True, bound=0.0))) == false
        assert claim.speaks_of(worth(0.0, sizes=(0.0,))) != false


def test_no_claim_and_several_levels_are_not_compared() -> None:
    assert not of_answer(RawResult("optimal"), worth(5.0))
    assert not of_answer(RawResult("optimal", objective=1.0), worth(5.0, 6.0))


def test_a_claimed_answer_that_breaks_something_is_told_with_the_worst() -> None:
    broken = worth(1.0, violations=(Violation("load", "by a little", 2.0), Violation("visits", "by much", 7.0)))
    for status, which in (("optimal", "an optimal"), ("feasible", "a feasible")):
        words = f"liar claims {which} answer, but it breaks 2 constraints; the worst: by much (by 7)"
        assert of_answer(RawResult(status), broken) == [words]
    assert not of_answer(RawResult("unknown"), broken)
    assert not of_answer(RawResult("optimal"), broken, RELAXATION)
    assert of_answer(RawResult("optimal"), broken, RESTRICTION)
    assert not of_answer(RawResult("optimal"), worth(1.0))


# -- bounds, optima and infeasibility against an answer ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sense", "said", "words"),
    [
        ("min", RawResult("infeasible"), "claims that there is no answer, but one of value 10.0"),
        ("min", RawResult("feasible", bound=11.0), "claims the bound 11.0, but an answer of value 10.0"),
        ("max", RawResult("feasible", bound=9.0), "claims the bound 9.0, but an answer of value 10.0"),
        ("min", RawResult("optimal", objective=11.0), "claims the optimum 11.0, but an answer of value 10.0"),
        ("max", RawResult("optimal", objective=9.0), "claims the optimum 9.0, but an answer of value 10.0"),
    ],
)
def test_an_answer_of_10_refutes_a_claim_that_it_beats_where_the_claim_is_meant_for_the_problem(
    sense: str, said: RawResult, words: str
) -> None:
    assert words in of_problem(said, worth(10.0), sense=sense)[0]
    assert not of_problem(said, None, sense=sense)
    assert not of_problem(said, worth(10.0), RESTRICTION, sense)
    assert not of_problem(said, worth(10.0), Exactness.NEITHER, sense)


@pytest.mark.parametrize(
    ("sense", "said"),
    [
        ("min", RawResult("feasible", bound=9.0)), ("max", RawResult("feasible", bound=11.0)), ("min", RawResult("optimal", objective=9.0)),
        ("max", RawResult("optimal", objective=11.0)), ("min", RawResult("feasible", objective=11.0)), ("min", RawResult("feasible")),
        ("min", RawResult("feasible", bound=10.0 * (1 + CLAIM_TOLERANCE / 2))), ("min", RawResult("unknown", bound=-1e300)),
        ("min", RawResult("optimal")), ("min", RawResult("unbounded")), ("min", RawResult("infeasible_or_unbounded")),
    ],
)  # fmt: skip
def test_what_an_answer_of_10_does_not_beat_is_not_refuted_by_it(sense: str, said: RawResult) -> None:
    assert not of_problem(said, worth(10.0), sense=sense)


def test_a_relaxations_optimum_is_none_of_the_problem_but_its_infeasibility_and_bound_are() -> None:
    assert not of_problem(RawResult("optimal", objective=11.0), worth(10.0), RELAXATION)
    assert of_problem(RawResult("infeasible"), worth(10.0), RELAXATION)
    assert of_problem(RawResult("feasible", bound=11.0), worth(10.0), RELAXATION)


def test_the_value_of_its_own_answer_is_the_optimum_that_is_claimed_without_a_figure() -> None:
    claim = Claim("liar", RawResult("optimal"), own=worth(11.0))
    found = contradictions(claim, ("min",), worth(10.0), Certificate("", "", "min", "file", True))
    assert found == ["liar claims the optimum 11.0, but an answer of value 10.0 passed every check"]
    assert claim.bound(1) == 11.0


def test_of_several_levels_the_first_that_differs_decides() -> None:
    said = RawResult("optimal", objective=1.0, further=(LevelClaim(5.0),))
    found = contradictions(Claim("liar", said), ("min", "min"), worth(1.0, 4.0), Certificate("", "", "min", "file", True))
    assert found == ["liar claims the optimum 5.0 at level 2, but an answer of value 4.0 at level 2 passed every check"]
    assert not contradictions(Claim("liar", said), ("min", "min"), worth(2.0, 4.0), Certificate("", "", "min", "file", True))


# -- against what is proved ----------------------------------------------------------------------------------------------


def test_an_optimum_beyond_a_verified_bound_is_refuted() -> None:
    said = RawResult("optimal", objective=8.0)
    assert of_problem(said, bound=9.0) == ["liar claims the optimum 8.0, but the verified bound is 9.0"]
    assert of_problem(said, None, RESTRICTION, bound=9.0)
    assert of_problem(said, None, EXACT, "max", bound=7.0)
    for sense, bound in (("min", 7.0), ("min", 8.0), ("max", 9.0), ("min", None)):
        assert not of_problem(said, sense=sense, bound=bound)
    assert not of_problem(said, None, RELAXATION, bound=9.0)
    assert not of_problem(RawResult("feasible", objective=8.0), bound=9.0)
    assert not of_problem(RawResult("optimal"), bound=9.0)
    assert not of_problem(said, worth(9.0, sizes=(1e9,)), bound=9.0)


def test_a_verified_bound_refutes_answers_as_good_as_one_wants_if_it_has_every_level() -> None:
    said = RawResult("unbounded")
    assert of_problem(said, bound=9.0) == ["liar claims that there is no best answer, but the verified bound is 9.0"]
    assert of_problem(said, None, RESTRICTION, bound=9.0)
    assert not of_problem(said, None, RELAXATION, bound=9.0)
    assert not of_problem(said)
    first = Certificate("", "", "min", "file", None, bound=9.0)
    assert not contradictions(Claim("liar", said), ("min", "min"), None, first)
    both = Certificate("", "", "min", "file", None, bound=9.0, levels=(LevelBound(1.0, "made", ()),))
    assert contradictions(Claim("liar", said), ("min", "min"), None, both)


def test_no_answer_and_no_best_one_are_told_apart_by_what_is_known() -> None:
    said = RawResult("infeasible_or_unbounded")
    free, bounded = Certificate("", "", "min", "file", None), Certificate("", "", "min", "file", None, bound=9.0)
    claim = Claim("liar", said)
    assert claim.status(("min",), None, free) == "infeasible_or_unbounded"
    assert claim.status(("min",), None, bounded) == "infeasible"
    assert claim.status(("min",), worth(10.0), free) == "unbounded"
    assert "no answer, but one of value 10.0" in contradictions(claim, ("min",), worth(10.0), bounded)[0]


@pytest.mark.parametrize(
    ("said", "proved", "words"),
    [
        (RawResult("unbounded"), "infeasible", "claims answers as good as one wants, but it is proved that there is none"),
        (RawResult("optimal", objective=3.0), "infeasible", "claims a best answer, but it is proved that there is none"),
        (RawResult("infeasible"), "unbounded", "claims that there is no answer, but it is proved that answers are as good"),
        (RawResult("optimal", objective=3.0), "unbounded", "claims a best answer, but it is proved that answers are as good"),
        (RawResult("feasible", bound=3.0), "unbounded", "claims a bound, but it is proved that answers are as good"),
    ],
)
def test_a_proof_that_there_is_no_answer_or_no_best_one_refutes_what_is_said_of_it(said: RawResult, proved: str, words: str) -> None:
    assert words in of_problem(said, **{proved: True})[0]
    assert not of_problem(said, None, Exactness.NEITHER, **{proved: True})
    assert not of_problem(RawResult("unknown"), **{proved: True})


# -- which answers an optimum is claimed for -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("said", "own", "stands"),
    [
        (RawResult("optimal"), None, False), (RawResult("optimal", objective=8.0), None, False),
        (RawResult("optimal", objective=10.0), None, True), (RawResult("optimal"), 10.0, True), (RawResult("optimal"), 9.0, False),
        (RawResult("feasible", objective=10.0), 10.0, False), (RawResult("infeasible"), None, False),
    ],
)  # fmt: skip
def test_an_optimum_is_claimed_for_an_answer_of_its_value_alone(said: RawResult, own: float | None, stands: bool) -> None:
    claim = Claim("liar", said, own=None if own is None else worth(own))
    assert claim.speaks_of(worth(10.0)) == stands
    assert not Claim("liar", said, RESTRICTION, claim.own).speaks_of(worth(10.0))
