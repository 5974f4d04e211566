"""Outcomes of methods for selections: what ratios rest on, and evidence only where something makes the function submodular."""

import math

import numpy as np
import pytest
from selection_problems import cover_30, cover_tight

import waybound as wb
from waybound import Guarantee, SubmodularSelection
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.heuristics.sata.greedy_steps import outcomes
from waybound.heuristics.sata.greedy_steps.outcomes import assumptions, concluded, greedy_guarantee, rounded_down

ROOTS = np.sqrt(np.arange(6.0))
PROMISE = Guarantee(2.0, "half", (), "nowhere")


def counted(values: np.ndarray, **declared: bool) -> SubmodularSelection:
    """A function of the number of elements alone."""
    f = wb.UserFunction(lambda masks: values[masks.sum(axis=1)], len(values) - 1, label="of the number", **declared)
    return SubmodularSelection(f, wb.Cardinality(2))


@pytest.mark.parametrize(("k", "share"), [(1, 1.0), (2, 0.75), (3, 19 / 27), (30, 1 - (29 / 30) ** 30), (99, 1 - (29 / 30) ** 30)])
def test_a_cardinality_limit_of_k_promises_its_own_share_and_no_more_elements_than_there_are(k: int, share: float) -> None:
    made = greedy_guarantee(cover_30(k), ("holds",))
    assert made is not None and made.ratio == pytest.approx(1 / share)
    assert made.assumptions == ("holds", f"at most k = {min(k, 30)} elements")
    assert f"f(S) >= (1 - (1 - 1/{min(k, 30)})^{min(k, 30)}) f(OPT)" in made.statement and share > 1 - 1 / math.e


def test_a_partition_promises_half_and_a_knapsack_nothing() -> None:
    f = cover_30(1).function
    half = greedy_guarantee(SubmodularSelection(f, wb.PartitionMatroid.of(np.arange(30) // 3)), ("holds",))
    assert half is not None and half.ratio == 2.0 and "f(OPT) / 2" in half.statement


def test_without_assumptions_there_is_no_guarantee() -> None:
    assert greedy_guarantee(cover_30(3), ()) is None


def test_built_in_functions_are_what_they_are_for() -> None:
    holds, reason = assumptions(cover_30(3))
    assert holds == ("coverage with weights >= 0: monotone, submodular, 0 for the empty set",) and reason == ""


def test_a_users_function_must_be_declared_and_the_declaration_is_tried() -> None:
    both = {"monotone": True, "submodular": True}
    holds, reason = assumptions(counted(ROOTS, **both))
    assert "as declared by the user" in holds[0] and reason == ""
    for declared in ({}, {"monotone": True, "submodular": False}, {"monotone": False, "submodular": True}):
        holds, reason = assumptions(counted(ROOTS, **declared))
        assert holds == () and "of the number is not declared monotone and submodular" in reason
    holds, reason = assumptions(counted(np.arange(6.0) ** 2, **both))
    assert holds == () and "whatever is declared: not submodular" in reason


def test_shares_are_rounded_downwards_but_for_what_a_double_loses() -> None:
    assert [rounded_down(v) for v in (0.63219, 0.6321, 0.75, 1.0, 0.99999)] == ["0.6321", "0.6321", "0.7500", "1.0000", "0.9999"]


def test_picks_keep_their_order_and_prove_a_bound() -> None:
    problem = cover_tight()
    outcome = concluded(problem, Stop(), np.array([1, 0]), ("holds",), PROMISE, {"evaluations": 7})
    assert outcome.answer.elements == (1, 0) and outcome.answer.in_order and {type(e) for e in outcome.answer.elements} == {int}
    assert outcome.guarantee is PROMISE and outcome.limit == "none" and outcome.message == ""
    (evidence,) = outcome.evidence
    assert verified_bound(problem, evidence) >= 80.0
    assert outcome.statistics["evaluations"] == 7 and outcome.statistics["bound_evaluations"] > 0


def test_without_assumptions_there_is_neither_evidence_nor_guarantee() -> None:
    outcome = concluded(cover_tight(), Stop(), [0], (), PROMISE, {}, "why not")
    assert (outcome.evidence, outcome.guarantee, outcome.message) == ((), None, "why not")
    assert outcome.statistics == {"bound_evaluations": 0}


def test_what_cut_a_method_short_is_told_and_its_time_does_not_cost_the_evidence() -> None:
    asked, late = Stop(), Stop(0.0)
    asked.ask()
    assert concluded(cover_30(3), asked, [0], (), None, {}, whole=False).limit == "interrupt"
    outcome = concluded(cover_30(3), late, [0], ("holds",), None, {}, whole=False)
    assert outcome.limit == "time" and len(outcome.evidence) == 1
    assert concluded(cover_30(3), Stop(), [0], (), None, {}, whole=False).limit == "time"
    assert not concluded(cover_30(3), Stop(), [0], (), None, {}, in_order=False).answer.in_order


def test_a_bound_that_fails_costs_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*given: object) -> None:
        raise ValueError("no room for gains")

    monkeypatch.setattr(outcomes, "best_prefix", fail)
    outcome = concluded(cover_30(3), Stop(), [2, 1], ("holds",), PROMISE, {}, "first")
    assert outcome.answer.elements == (2, 1) and outcome.guarantee is PROMISE and outcome.evidence == ()
    assert outcome.message.startswith("first; no bound by marginal gains: ") and "no room for gains" in outcome.message
