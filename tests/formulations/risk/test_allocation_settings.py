"""Risk allocation with other settings than those of its file."""

from __future__ import annotations

import pytest

import waybound as wb
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.risk.risk_allocation import RiskAllocation
from waybound.instances.errors import UsageError


def test_settings_change_the_risk() -> None:
    p = wb.generate("risk-allocation", steps=3).instance
    other = problem_from_instance(p, risk="joint", total=0.2)
    assert isinstance(other, RiskAllocation)
    assert (other.risk.kind, other.risk.total, other.caps.tolist()) == ("joint", 0.2, [0.2] * 3)
    with pytest.raises(UsageError, match="has no setting 'speed'; it takes risk, total"):
        problem_from_instance(p, speed=1)
    with pytest.raises(UsageError, match="no chance constraints"):
        wb.read("demo-c25", problem="risk-allocation")
