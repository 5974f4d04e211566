"""Answers of risk allocation."""

from __future__ import annotations

from waybound.formulations.risk.allocations import Allocation


def test_anything_that_is_a_vector_will_do() -> None:
    made = Allocation.of([1, 2], [0.1])
    assert made.decision.tolist() == [1.0, 2.0] and made.risks is not None and made.risks.tolist() == [0.1]
    assert repr(made) == "<Allocation: 2 decisions, 1 risks>"
    assert repr(Allocation.of([1, 2])) == "<Allocation: 2 decisions>"
