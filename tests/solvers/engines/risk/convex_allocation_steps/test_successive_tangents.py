import itertools
import math

import numpy as np
import pytest
from risk_problems import margins, problem
from scipy.special import ndtr

from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.reports.benchmarks.risk_allocation import compared, reference
from waybound.solvers.engines.risk.convex_allocation_steps.successive_tangents import Interval, SuccessiveTangents, least_margin

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


def test_random_problems_are_closed_and_never_worse_than_the_heuristics() -> None:
    assert "12 problems" in compared(12)[0]


@pytest.mark.long
def test_many_random_problems() -> None:
    assert "500 problems" in compared(500)[0]


@pytest.mark.parametrize(("family", "value"), [("auv", 5.230550864), ("corridor", 1.3592607548)])
def test_the_two_problems_of_the_literature(family: str, value: float) -> None:
    p = reference(family)
    rough, fine = (SuccessiveTangents(p).run(Stop(), gap) for gap in (1e-5, 0.0))
    assert rough.gap <= 1e-5 and rough.rounds < fine.rounds
    assert fine.value == pytest.approx(value, rel=3e-9)
    assert verified_bound(p, fine.evidence(1.0)[0]) == pytest.approx(value, rel=3e-9)


def test_what_is_told_on_the_way_only_improves() -> None:
    told = []
    SuccessiveTangents(reference("auv"), publish=lambda interval: told.append((interval.bound, interval.value))).run(Stop())
    assert all(a[0] <= b[0] and a[1] >= b[1] for a, b in itertools.pairwise(told))
    assert len(told) > 3


def test_a_constraint_far_from_its_limit_costs_nothing() -> None:
    p = problem(chance__limits=[5, 500], constraints__upper=20, upper=20)
    interval = SuccessiveTangents(p).run(Stop())
    assert interval.status == "optimal" and interval.gap < 1e-8
    assert interval.answer is not None and interval.answer.risks is not None and interval.answer.risks[0] == pytest.approx(0.1, rel=1e-6)


def test_a_constraint_whose_budget_is_its_own_is_closed_whatever_is_rounded() -> None:
    rng = np.random.default_rng(2)
    for _ in range(40):  # its z cannot move, so that the last digits decide whether the budget is kept
        row, total = rng.uniform(0.1, 3.0, 2).tolist(), float(10.0 ** rng.uniform(-4.0, -1.0))
        quantities = {"map": [row], "covariance": [float(rng.uniform(0.01, 2.0))]}
        p = problem(quantities=quantities, chance={"quantities": [[1.0]], "limits": [float(rng.uniform(2.0, 9.0))]}, risk={"total": total})
        interval = SuccessiveTangents(p).run(Stop())
        assert interval.answer is not None and interval.gap < 1e-8, (row, total)
        assert p.evaluate(interval.answer).feasible


def test_budgets_of_parts_are_kept() -> None:
    free, tight = margins([1.0, 3.0], 0.1), margins([1.0, 3.0], 0.1, budgets=[{"constraints": ["2"], "risk": 0.02}])
    loose, held = (SuccessiveTangents(p).run(Stop()) for p in (free, tight))
    assert loose.value == pytest.approx(6.268857, abs=1e-6) and held.value > loose.value
    assert held.answer is not None and held.answer.risks is not None and held.answer.risks == pytest.approx([0.08, 0.02], rel=1e-6)
    assert held.gap < 1e-8


def test_an_unbounded_reward_is_said_to_be_so() -> None:
    assert (
        SuccessiveTangents(problem(chance__limits=[5, 5], constraints=None, quantities__map=[[1, 0], [-1, 0]])).run(Stop()).status
        == "unbounded"
    )


def test_without_time_nothing_is_known() -> None:
    interval = SuccessiveTangents(problem()).run(Stop(0.0))
    assert (interval.status, interval.answer, interval.evidence(1.0)) == ("unknown", None, ())


def test_the_least_margin_is_a_minimum() -> None:
    z = np.linspace(1.5, 9.0, 20001)
    for slope, price in ((0.1, 1.0), (1.0, 0.1), (1e-9, 1.0), (0.0, 1.0), (1.0, 0.0)):
        margin = float(least_margin(np.array([slope]), np.array([price]), np.array([1.5]))[0])
        assert margin == pytest.approx((slope * z + price * ndtr(-z)).min(), rel=1e-6, abs=1e-9)
