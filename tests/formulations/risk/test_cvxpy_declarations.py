import cvxpy as cp
import numpy as np
import pytest
from coded import coded
from risk_problems import run

from waybound import InputError, RiskAllocation, UnsupportedError
from waybound.solvers.engines.risk.convex_allocation import ConvexAllocation


def test_the_stalling_problem_in_cvxpy() -> None:
    x = cp.Variable(2, name="x", nonneg=True)
    p = RiskAllocation.from_cvxpy(cp.Problem(cp.Maximize(x[0] + 3 * x[1]), [cp.sum(x) <= 7]), x, np.eye(2), [5, 5], total=0.1)
    result = run(ConvexAllocation, p)
    assert (p.sense, result.status) == ("max", "optimal")
    assert result.objective == pytest.approx(13.731143, abs=1e-6)
    # Where 1 / density(z1) = 3 / density(z2); the optimum is flat.
    assert p.values(result.answer)["x"] == pytest.approx([2.955491, 3.591884], abs=1e-4)


def test_squares_norms_and_cones_keep_their_value() -> None:
    u = cp.Variable((3, 2), name="u")
    cost = cp.sum_squares(u - 1) + 2 * cp.norm(u[0]) + cp.norm1(u[1]) + 3
    means = cp.hstack([u[0, 0] + u[1, 1], -u[2, 0]])
    covariance, limits = np.array([[0.04, 0.01], [0.01, 0.09]]), np.array([0.5, -0.2])
    p = RiskAllocation.from_cvxpy(
        cp.Problem(cp.Minimize(cost), [cp.norm(u[:, 1]) <= 1]), means, covariance, limits, total=0.1, names=["a", "b"]
    )
    assert p.features() >= {"quadratic-cost", "cones"}
    result = run(ConvexAllocation, p)
    assert result.answer is not None and p.evaluate(result.answer).feasible
    u.value = p.values(result.answer)["u"]
    assert float(cost.value) == pytest.approx(result.objective, rel=1e-7)
    assert float(cp.norm(u[:, 1]).value) <= 1 + 1e-7
    assert result.bound == pytest.approx(result.objective, rel=1e-6)


def test_what_cannot_be_declared_is_refused() -> None:
    x = cp.Variable(2, name="x")
    convex = cp.Problem(cp.Minimize(cp.sum(x)))
    with pytest.raises(InputError, match="affine", check=coded("unsupported")):
        RiskAllocation.from_cvxpy(convex, cp.square(x), np.eye(2), [1, 1], total=0.1)
    with pytest.raises(InputError, match="convex"):
        RiskAllocation.from_cvxpy(cp.Problem(cp.Maximize(cp.sum_squares(x))), x, np.eye(2), [1, 1], total=0.1)
    with pytest.raises(UnsupportedError, match="integer"):
        RiskAllocation.from_cvxpy(cp.Problem(cp.Minimize(cp.Variable(integer=True))), x, np.eye(2), [1, 1], total=0.1)
    with pytest.raises(UnsupportedError, match="exponential"):
        RiskAllocation.from_cvxpy(cp.Problem(cp.Minimize(cp.sum(cp.exp(x)))), x, np.eye(2), [1, 1], total=0.1)
    with pytest.raises(InputError, match="least eigenvalue -1"):
        RiskAllocation.from_cvxpy(convex, x, [[1, 2], [2, 1]], [1, 1], total=0.1)
    with pytest.raises(
        InputError, match=r"limits must be a number, or one a quantity; expected 2; found \(1,\)", check=coded("wrong-shape")
    ):
        RiskAllocation.from_cvxpy(convex, x, np.eye(2), [1], total=0.1)
    with pytest.raises(InputError, match="risk says no limit; expected total or each"):
        RiskAllocation.from_cvxpy(convex, x, np.eye(2), [1, 1])
    with pytest.raises(InputError, check=coded("duplicate")):
        RiskAllocation.from_cvxpy(cp.Problem(cp.Minimize(cp.sum(x) + cp.Variable(name="x"))), x, np.eye(2), [1, 1], total=0.1)
