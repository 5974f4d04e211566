import pytest
from risk_problems import context, problem

from waybound.heuristics.risk.cvar import cvar
from waybound.instances.errors import UsageError


def test_plans_are_validated_and_worse_than_the_best() -> None:
    p = problem(risk__kind="joint")
    result = cvar(p, context(), samples=400)
    judged = p.evaluate(result.answer)
    assert judged.feasible and 12.0 < judged.values[0] < 13.765737
    assert result.statistics["joint_risk_high"] <= 0.1
    assert result.statistics["level"] in (0.1, 0.05, 0.025)


def test_rows_without_noise_are_kept() -> None:
    p = problem(risk__kind="joint", quantities__covariance=[1, 0], chance__limits=[5, 2], constraints__upper=5)
    result = cvar(p, context(), samples=200)
    assert result.answer.decision[1] == pytest.approx(2.0, abs=1e-6)
    assert p.evaluate(result.answer).feasible


def test_too_few_samples_end_without_a_plan() -> None:
    result = cvar(problem(risk={"kind": "joint", "total": 1e-4}), context(), samples=10)
    assert result.answer is None and result.message == "10 samples are too few for this risk"
    result = cvar(problem(risk={"kind": "joint", "total": 1e-100}), context(), samples=10)  # a share of 1e-99 samples
    assert result.answer is None and result.message == "10 samples are too few for this risk"
    with pytest.raises(UsageError, match="between 10 and"):
        cvar(problem(risk__kind="joint"), context(), samples=5)
