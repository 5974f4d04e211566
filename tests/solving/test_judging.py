"""Candidates judged one by one: the best feasible one wins, a fault in one costs none of the others, and every fault is told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from programs import program

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.programs.exactness import Exactness
from waybound.instances.errors import CheckFailedError, InputError, NoAnswerError, SearchFailedError
from waybound.solvers.backend import RawResult
from waybound.solving.judging import Judge

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
        case.at_hand(lambda judged, refutes=refutes: refutes)
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
