"""From picks to an outcome: evidence only where something makes the function submodular, and no answer lost to a bound."""

from __future__ import annotations

import numpy as np
import pytest
from selection_problems import cover_30, cover_tight

from waybound.formulations.certificate import verified_bound
from waybound.formulations.evidence import Guarantee
from waybound.formulations.stop import Stop
from waybound.heuristics.sata.greedy_steps import ending
from waybound.heuristics.sata.greedy_steps.ending import concluded

PROMISE = Guarantee(2.0, "half", (), "nowhere")


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

    monkeypatch.setattr(ending, "best_prefix", fail)
    outcome = concluded(cover_30(3), Stop(), [2, 1], ("holds",), PROMISE, {}, "first")
    assert outcome.answer.elements == (2, 1) and outcome.guarantee is PROMISE and outcome.evidence == ()
    assert outcome.message.startswith("first; no bound by marginal gains: ") and "no room for gains" in outcome.message
