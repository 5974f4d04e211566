"""The interval around an optimum: how wide it is, and what proves its end."""

from __future__ import annotations

import math

import numpy as np
import pytest

from waybound.solvers.engines.risk.convex_allocation_steps.interval import Interval

PRICES = {"constraints": np.array([1.0, 2.0]), "chance": np.array([0.0, 0.0, 0.0, 0.5])}


def test_of_nothing_the_gap_is_infinite_and_nothing_is_proved() -> None:
    unknown = Interval()
    assert (unknown.status, unknown.bound, unknown.value, unknown.answer) == ("unknown", -math.inf, math.inf, None)
    assert unknown.gap == math.inf and unknown.evidence(1.0) == ()
    assert Interval(bound=3.0).gap == Interval(value=3.0).gap == math.inf


@pytest.mark.parametrize(
    ("bound", "value", "gap"),
    [
        (9.0, 10.0, 0.1),
        (-10.0, -8.0, 0.25),
        (-1.0, 1.0, 2.0),
        (10.0, 10.0, 0.0),
        (10.0 + 1e-12, 10.0, 0.0),  # rounding may cross the two
        (0.0, 0.0, 0.0),
    ],
)
def test_the_gap_is_a_part_of_the_value_and_never_negative(bound: float, value: float, gap: float) -> None:
    assert Interval(bound=bound, value=value).gap == pytest.approx(gap, rel=1e-12, abs=0.0)


@pytest.mark.parametrize(("sign", "stated"), [(1.0, 9.0), (-1.0, -9.0)])
def test_prices_prove_the_bound_in_the_sense_of_the_problem(sign: float, stated: float) -> None:
    (evidence,) = Interval("feasible", bound=9.0, value=10.0, prices=PRICES).evidence(sign)
    assert (evidence.kind, evidence.source, evidence.value) == ("risk-allocation-duals", "duals of successive tangents", stated)
    assert evidence.data == {"constraints": [1.0, 2.0], "chance": {"at": [3], "values": [0.5]}}


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_prices_that_no_decision_can_pay_prove_that_there_is_none(sign: float) -> None:
    (evidence,) = Interval("infeasible", prices=PRICES).evidence(sign)
    assert evidence.value == sign * math.inf and evidence.data["infeasible"] is True
    assert "no decision can pay" in evidence.source
