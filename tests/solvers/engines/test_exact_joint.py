"""Joint risk by its true probability."""

from __future__ import annotations

import numpy as np
import pytest
from risk_problems import margins, problem, run

import waybound as wb
from waybound.instances.errors import UnsupportedError
from waybound.solvers.engines.exact_joint import ExactJoint
from waybound.solving.solve import solve


@pytest.mark.share(3)
@pytest.mark.parametrize(
    ("p", "value"),
    [
        (problem(risk__kind="joint"), 13.765737),
        (margins([1.0, 3.0], 0.1, kind="joint"), 6.234263),
        (margins([1.0, 2.0, 5.0], 0.1, kind="joint"), 13.713541),
    ],
)
def test_independent_noise_has_its_known_optimum(p, value: float) -> None:
    found = run(ExactJoint, p, gap=1e-5)
    assert found.objective == pytest.approx(value, rel=2e-5)
    assert p.evaluate(found.answer).feasible
    risk = p.joint_risk(found.answer.decision)["total"]
    assert 0.0999 < risk.value <= risk.high <= 0.1


@pytest.mark.slow
def test_it_uses_what_an_allocation_leaves() -> None:
    p = problem(risk__kind="joint")
    best, allocated = solve(p, bound_time=2), solve(p, "convex-allocation", bound_time=0)
    assert best.solver == "exact-joint" and best.objective > allocated.objective
    assert best.certificate.bound == pytest.approx(7.0 + 2.0 * (5.0 - 1.281552), abs=1e-5)  # the second with all of the risk


def test_many_constraints_are_refused() -> None:
    with pytest.raises(UnsupportedError, match="more than 60 chance constraints"):
        run(ExactJoint, wb.generate("risk-allocation", steps=61, risk="joint"))


@pytest.mark.parametrize("scale", [1.0, 1e9])
@pytest.mark.parametrize("weight", [1.0, 1e-10])
def test_bounds_hold_at_any_scale(scale: float, weight: float) -> None:
    p = problem(
        sense="max", decisions=2, lower=[-4 * scale] * 2, upper=None, constraints=None,
        quantities={"map": [[-3.0, 1.0], [-1.0, -1.0], [0.0, 1.0]], "covariance": (np.array([3.0, 1.0, 1.0]) * scale**2).tolist()},
        cost={
            "decisions": [-weight, -weight],
            "terms": [{"kind": "norm", "weight": weight, "decisions": [[0, -2], [-2, 0]], "constant": [scale, 2 * scale]}],
        },
        chance={"quantities": np.eye(3).tolist(), "limits": [4 * scale, scale, 3 * scale]},
        risk={"total": 0.1, "kind": "joint"},
        cones=[{"decisions": [[1.0, 0.0], [0.0, 1.0]], "limit": 4 * scale}],
    )  # fmt: skip
    found = run(ExactJoint, p)
    assert found.status == "optimal"
    assert p.evaluate(found.answer).feasible
    assert found.objective <= found.bound + 1e-9 * abs(found.objective)
    assert found.objective == pytest.approx(-1.5 * scale * weight, rel=2e-6)
