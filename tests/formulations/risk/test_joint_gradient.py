"""How the probability that any constraint fails changes with what each leaves."""

from __future__ import annotations

import numpy as np
import pytest
from one_factor import any_fails_by_quadrature
from scipy.stats import norm

from waybound.formulations.risk.joint_gradient import gradient


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("z", [1.0, 2.5, 5.0])
@pytest.mark.parametrize("many", [1, 2, 3, 5])
def test_it_is_that_of_finite_differences(many: int, z: float, scale: float) -> None:
    b, s = np.array([1.0, -0.8, 1.2, 0.5, -1.0])[:many], np.array([0.3, 0.4, 0.5, 1.0, 0.2])[:many]
    deviation = np.hypot(b, s)
    slack, step = z * deviation * np.linspace(1.0, 1.1, many), 1e-4
    made = gradient(scale * slack, scale**2 * (np.outer(b, b) + np.diag(s * s))) * scale
    for k in range(many):
        up, down = (any_fails_by_quadrature(slack + sign * step * np.eye(many)[k], b, s) for sign in (1.0, -1.0))
        assert made[k] == pytest.approx((up - down) / (2.0 * step), rel=2e-3)


def test_a_constraint_that_another_one_covers_changes_nothing() -> None:
    made = gradient(np.array([2.0, 3.0]), np.ones((2, 2)))
    assert made.tolist() == pytest.approx([-norm.pdf(2.0), 0.0])
