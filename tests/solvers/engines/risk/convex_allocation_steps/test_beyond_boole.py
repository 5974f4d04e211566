"""Plans that keep a joint risk though the risks of their constraints add up to more."""

from __future__ import annotations

import numpy as np
import pytest
from risk_problems import around_a_box, margins, risk_of_two_sensors, run, two_sensors

from waybound.api import solve
from waybound.formulations.stop import Stop
from waybound.solvers.engines.risk.convex_allocation import BEYOND, ConvexAllocation
from waybound.solvers.engines.risk.convex_allocation_steps.beyond_boole import beyond_boole, quantile, room


@pytest.mark.parametrize(("total", "limit"), [(2e-5, 4.3), (6.5e-7, 5.0), (1e-3, 3.3)])
def test_a_plan_is_found_where_no_allocation_is(total: float, limit: float) -> None:
    p = two_sensors(total, limit)
    assert run(ConvexAllocation, p.by_allocation()).answer is None
    x = beyond_boole(p, 1, Stop())
    assert x is not None and room(p, x, 1) >= 0.0 and risk_of_two_sensors(float(x[0]), limit) <= total
    found = run(ConvexAllocation, p)
    assert found.status == "feasible" and found.bound is None and found.message == BEYOND
    assert p.evaluate(found.answer).feasible


def test_none_is_found_where_there_is_none() -> None:
    assert beyond_boole(two_sensors(1.5e-5, 4.3), 1, Stop()) is None
    found = solve(two_sensors(1.5e-5, 4.3), "convex-allocation", bound_time=0)
    assert found.answer is None and found.status == "unknown"


def test_room_is_counted_in_deviations() -> None:
    p = margins([1.0, 3.0], 0.1, kind="joint")
    x = np.full(2, 2.0)
    truth = p.joint_risk(x)["total"].value
    assert room(p, x, 1) == pytest.approx(float(quantile(np.array(truth)) - quantile(np.array(0.1))))
    assert room(p, np.full(2, 1.0), 1) < 0.0


def test_alternatives_are_not_its_own() -> None:
    p = around_a_box(risk={"total": 0.05, "kind": "joint"})
    assert "alternatives" in ConvexAllocation().missing(p)
