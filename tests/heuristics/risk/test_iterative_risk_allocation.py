"""Iterative risk allocation: monotone, allowed in every round, and stalling where all constraints are active."""

import numpy as np
import pytest
from coded import coded
from risk_problems import context, margins, problem

from waybound import Allocation, RiskAllocation, UsageError, solve
from waybound.heuristics.heuristic import HEURISTICS
from waybound.heuristics.risk.iterative_risk_allocation import iterative
from waybound.reports.benchmarks.risk_allocation import random_problem, rebuilt, reference


def test_the_known_sequence() -> None:
    result = iterative(problem(constraints__upper=4), context())
    known = [10.710293, 10.971765, 11.127949, 11.227660, 11.293560, 11.337998]
    assert result.statistics["values"][:6] == pytest.approx(known, abs=1e-6)
    assert result.statistics["end"] == "small gain"


def test_it_stalls_and_says_so() -> None:
    solution = solve(problem(), heuristic="iterative", bound_time=60.0)
    assert solution.objective == pytest.approx(13.420585, abs=1e-6)
    assert solution.statistics["end"] == "all active"
    assert "it stalled" in solution.message
    assert solution.bound == pytest.approx(13.731143, abs=1e-6)


@pytest.mark.parametrize(("family", "rounds", "value"), [("auv", 29, 5.243666), ("corridor", None, None)])
def test_the_two_problems_of_the_literature(family: str, rounds: int | None, value: float | None) -> None:
    p = reference(family)
    result = iterative(p, context())
    assert rounds is None or result.statistics["rounds"] == rounds
    assert value is None or p.value(result.answer.decision)[0] == pytest.approx(value, abs=1e-6)
    assert p.evaluate(result.answer).feasible


def test_it_is_the_loop_that_writes_its_model_anew() -> None:
    p = reference("auv", steps=6)
    value, rounds = rebuilt(p)
    result = iterative(p, context())
    assert result.statistics["rounds"] == rounds
    assert p.value(result.answer.decision)[0] == pytest.approx(value, abs=1e-6)


@pytest.mark.share(2)
@pytest.mark.parametrize("seed", range(5))
def test_every_round_is_allowed_and_no_worse(seed: int) -> None:
    p, told = random_problem(np.random.default_rng(seed)), list[Allocation]()
    ctx = context()
    object.__setattr__(ctx, "publish", told.append)
    iterative(p, ctx, alpha=0.5, decay=0.98)
    values = [p.evaluate(answer).values[0] for answer in told]
    assert values == sorted(values)
    assert all(p.evaluate(answer).feasible for answer in told)
    assert all(answer.risks is not None and answer.risks.sum() <= p.budgets[0].risk for answer in told)


def test_equal_risks_without_a_plan_end_it() -> None:
    result = iterative(problem(constraints={"decisions": [[1, 1]], "lower": 6.72}), context())
    assert result.answer is None and result.statistics["end"] == "infeasible"
    assert "no plan with equal risks" in result.message


def test_what_it_cannot_do_is_said() -> None:
    with pytest.raises(UsageError, check=coded("out-of-range")):
        iterative(problem(), context(), alpha=1.0)
    budgets = margins([1.0, 3.0], 0.1, budgets=[{"constraints": ["1"], "risk": 0.01}])
    assert HEURISTICS["iterative"].missing(budgets) == {"budgets other than the total"}
    assert isinstance(budgets, RiskAllocation)
