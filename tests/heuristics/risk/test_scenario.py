import math

import pytest
from coded import coded
from risk_problems import context, problem
from scipy.stats import binom

from waybound.heuristics.heuristic import HEURISTICS
from waybound.heuristics.risk.scenario import enough_samples, scenario
from waybound.instances.errors import UsageError


@pytest.mark.parametrize(("risk", "confidence", "support"), [(0.05, 0.999, 20), (0.001, 0.99, 2), (0.3, 0.5, 1)])
def test_no_fewer_samples_are_enough(risk: float, confidence: float, support: int) -> None:
    many = enough_samples(risk, confidence, support)
    assert binom.cdf(support - 1, many, risk) <= 1.0 - confidence < binom.cdf(support - 1, many - 1, risk)


def test_plans_keep_the_joint_risk() -> None:
    p = problem(risk__kind="joint")
    for seed in range(5):
        result = scenario(p, context(seed))
        assert p.evaluate(result.answer).feasible
        assert result.statistics == {"samples": enough_samples(0.1, 0.999, 2), "confidence": 0.999, "support": 2}


def test_fewer_samples_promise_nothing() -> None:
    p = problem(risk__kind="joint")
    result = scenario(p, context(), samples=3)
    assert math.isnan(result.statistics["confidence"])
    assert not p.evaluate(result.answer).feasible


def test_what_it_cannot_do_is_said() -> None:
    with pytest.raises(UsageError, check=coded("out-of-range")):
        scenario(problem(risk__kind="joint"), context(), confidence=1.0)
    for total in (1e-6, 1e-100):
        with pytest.raises(UsageError, check=coded("too-large")):
            scenario(problem(risk={"kind": "joint", "total": total}), context())
    with pytest.raises(UsageError, match="6000000 samples are needed"):
        scenario(problem(risk__kind="joint"), context(), samples=6_000_000)
    assert math.isnan(scenario(problem(risk={"kind": "joint", "total": 1e-100}), context(), samples=9).statistics["confidence"])
    assert HEURISTICS["scenario"].missing(problem()) == {"allocated-risk"}
    assert HEURISTICS["cvar"].missing(problem(risk={"kind": "joint", "each": 0.1})) == {"budgets other than the total"}
