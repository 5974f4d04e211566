import numpy as np
import pytest
from one_factor import any_fails_by_quadrature
from risk_problems import margins, problem, risk_of_two_sensors, run, two_sensors
from scipy.stats import norm

import waybound as wb
from waybound import UnsupportedError, solve
from waybound.solvers.engines.risk.exact_joint import ExactJoint, gradient


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("z", [1.0, 2.5, 5.0])
@pytest.mark.parametrize("many", [1, 2, 3, 5])
def test_it_is_that_of_finite_differences(many: int, z: float, scale: float) -> None:
    b, s = np.array([1.0, -0.8, 1.2, 0.5, -1.0])[:many], np.array([0.3, 0.4, 0.5, 1.0, 0.2])[:many]
    deviation = np.hypot(b, s)
    slack, step = z * deviation * np.linspace(1.0, 1.1, many), 1e-4
    slopes = gradient(scale * slack, scale**2 * (np.outer(b, b) + np.diag(s * s))) * scale
    for k in range(many):
        up, down = (any_fails_by_quadrature(slack + sign * step * np.eye(many)[k], b, s) for sign in (1.0, -1.0))
        assert slopes[k] == pytest.approx((up - down) / (2.0 * step), rel=2e-3)


def test_a_constraint_that_another_one_covers_changes_nothing() -> None:
    slopes = gradient(np.array([2.0, 3.0]), np.ones((2, 2)))
    assert slopes.tolist() == pytest.approx([-norm.pdf(2.0), 0.0])


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
    result = run(ExactJoint, p, gap=1e-5)
    assert result.objective == pytest.approx(value, rel=2e-5)
    assert p.evaluate(result.answer).feasible
    risk = p.joint_risk(result.answer.decision)["total"]
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
    result = run(ExactJoint, p)
    assert result.status == "optimal"
    assert p.evaluate(result.answer).feasible
    assert result.objective <= result.bound + 1e-9 * abs(result.objective)
    assert result.objective == pytest.approx(-1.5 * scale * weight, rel=2e-6)


@pytest.mark.parametrize(("total", "limit"), [(1e-6, 5.0), (9e-7, 5.0), (2e-5, 4.3), (1e-4, 4.0), (0.05, 2.1)])
def test_a_plan_keeps_its_true_risk_where_failures_come_together(total: float, limit: float) -> None:
    """With and without a plan whose risks add up to the total."""
    p = two_sensors(total, limit)
    result = run(ExactJoint, p, gap=1e-5)
    x = float(result.answer.decision[0])
    assert p.evaluate(result.answer).feasible
    assert 0.9999 * total <= risk_of_two_sensors(x, limit) <= total * (1.0 + 1e-9)
    assert x <= result.bound + 1e-9 and risk_of_two_sensors(result.bound, limit) >= total * (1.0 - 1e-7)


@pytest.mark.parametrize("total", [1.5e-5, 1.723e-5])
def test_a_total_that_no_position_keeps_is_kept_by_none(total: float) -> None:
    assert total < min(risk_of_two_sensors(x, 4.3) for x in np.linspace(-0.01, 0.01, 41))
    result = run(ExactJoint, two_sensors(total, 4.3))
    assert result.answer is None and result.status == "infeasible"


def test_planes_lead_to_the_few_positions_that_keep_it() -> None:
    result = run(ExactJoint, two_sensors(7.5e-7, 4.95))  # from -0.0045 to 0.0004
    assert result.answer is not None and risk_of_two_sensors(float(result.answer.decision[0]), 4.95) <= 7.5e-7 * (1.0 + 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("total", [1e-6, 1e-3])
def test_a_generated_plan_keeps_its_risk_by_an_independent_sampler(total: float) -> None:
    p = wb.generate("risk-allocation", family="auv", total=total, risk="joint")
    slack, s = p.limits - p.chance @ solve(p, time_limit=5, bound_time=1).answer.decision, p.covariance
    deviation, rng, many = np.sqrt(np.diag(s)), np.random.default_rng(77), 400_000
    tails = norm.sf(slack / deviation)
    row = rng.choice(len(tails), many, p=tails / tails.sum())
    noise = rng.multivariate_normal(np.zeros(len(s)), s, many)
    failing = norm.isf(rng.random(many) * tails[row]) * deviation[row]
    noise += s[row] / deviation[row][:, None] ** 2 * (failing - noise[np.arange(many), row])[:, None]
    share = 1.0 / np.maximum(1, np.count_nonzero(noise > slack * (1.0 - 1e-12), axis=1))
    value, error = tails.sum() * share.mean(), tails.sum() * share.std() / np.sqrt(many)
    assert value - 4.0 * error <= total and value > 0.9 * total
