"""Risk allocation: statements, answers as files, and the joint risk against a simulation."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from risk_problems import around_a_box, problem, run

import waybound as wb
from waybound.formulations.risk.allocations import Allocation
from waybound.instances.errors import InputError
from waybound.solvers.engines.risk.convex_allocation import ConvexAllocation


def test_statements_on_alternatives_restrict() -> None:
    p = around_a_box()
    assert p.restricted([({"safest": 2}, True)]).open.tolist() == [False, False, True, False]
    assert p.restricted([({"safest": 0}, False), ({"safest": 0}, True)]).open.sum() == 0
    assert p.in_words({"safest": 2}, False) == "alternative 3 of box is not the safest"
    for wrong in ({"safest": 4}, {"safest": True}, {"row": 1}, 3):
        with pytest.raises(InputError, match="not a statement on the rows"):
            p.check_statement(wrong)


def test_answers_are_written_by_name_and_read_again() -> None:
    p = problem()
    data = json.loads(json.dumps(p.answer_to_json(Allocation.of([1, 2], [0.03, 0.04]))))
    assert data == {"kind": "allocation", "decision": {"x1": 1.0, "x2": 2.0}, "risks": {"1": 0.03, "2": 0.04}}
    again = p.answer_from_json(data)
    assert again.decision.tolist() == [1, 2] and again.risks is not None and again.risks.tolist() == [0.03, 0.04]
    for wrong in ({}, {"kind": "allocation", "decision": {"x1": 1}}, {"kind": "allocation", "decision": {"x1": "a", "x2": 1}}):
        with pytest.raises(InputError):
            p.answer_from_json(wrong)
    with pytest.raises(InputError, match="one of other data"):
        p.answer_of([1, 2, 3])
    assert p.answer_to_frame([1.0, 2.0]).columns.tolist() == ["constraint", "allowed", "risk"]


def test_what_is_left_of_the_total_is_shared_out() -> None:
    made = problem(constraints=None).allocated(np.array([3.0, 3.0]))
    assert made.risks is not None and made.risks.sum() == pytest.approx(0.1, rel=1e-12) and made.risks.sum() <= 0.1


def test_the_joint_risk_is_that_of_a_simulation() -> None:
    p, many, rng = wb.generate("risk-allocation"), 100_000, np.random.default_rng(3)
    d = p.instance.quantities.dynamics
    answer = run(ConvexAllocation, p, gap=1e-6).answer
    state, failed, floor = np.tile(d.start, (many, 1)), np.zeros(many, dtype=bool), -p.instance.chance.limits
    for t, u in enumerate(answer.decision.tolist()):
        state = state @ d.state.T + d.input[:, 0] * u + rng.standard_normal((many, 2)) * np.sqrt(np.diag(d.noise))
        failed |= state[:, 0] < floor[t]
    share = failed.mean()
    found = p.joint_risk(answer.decision)["total"]
    error = np.sqrt(share * (1.0 - share) / many)
    assert abs(found.value - share) < 4.0 * error + (found.high - found.low) / 2.0
    assert found.high < p.risk.total / 3.0


@pytest.mark.parametrize(
    "changes", [{"quantities__covariance": [1e308, 1.0], "chance__quantities": [[2, 0], [0, 1]]},
                {"quantities__map": [[1e200, 0], [0, 1]], "chance__quantities": [[1e200, 0], [0, 1]]}],
)  # fmt: skip
def test_numbers_whose_products_are_none_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="their means or variances are no finite numbers"):
        problem(**changes)
