"""Probabilities that any of many Gaussian constraints fails."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal, norm

from waybound.formulations.risk.joint_normal import any_fails, gradient


@pytest.mark.parametrize(
    ("correlation", "union"), [(-0.99, 0.1), (-0.5, 0.09994), (0.0, 0.0975), (0.5, 0.08781), (0.9, 0.06813), (0.99, 0.05581)]
)
def test_two_events_of_one_twentieth(correlation: float, union: float) -> None:
    covariance = np.array([[1.0, correlation], [correlation, 1.0]])
    found = any_fails(np.full(2, norm.isf(0.05)), covariance)
    assert found.value == pytest.approx(union, abs=6e-6)
    assert found.low <= found.value <= found.high <= found.low + 1e-4


def _by_slices(a: float, b: float, correlation: float) -> float:
    """P(x > a or y > b), by slices of x about the kink of what y has there."""
    spread = np.sqrt((1.0 - correlation) * (1.0 + correlation))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    cuts = [-38.0, *np.linspace(-8.0, 8.0, 33), *(b / correlation + spread * np.linspace(-40.0, 40.0, 81)), a]
    ends = np.unique(np.clip(cuts, -38.0, a))
    half = np.diff(ends)[:, None] / 2.0
    x = (ends[:-1, None] + half + half * nodes).ravel()
    return float(norm.sf(a) + (half * weights).ravel() @ (norm.pdf(x) * norm.sf((b - correlation * x) / spread)))


@pytest.mark.parametrize("correlation", [0.9, 0.94, 0.96, 0.999, 1.0 - 1e-8, 0.9999999999997414])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("a", "b"), [(-0.9375854, -0.9375865), (2.0, 2.0), (1.0, 3.0), (3.0, -2.9), (-1.0, 1.0), (5.0, 5.1)])
def test_two_that_are_nearly_the_same_or_opposite(correlation: float, sign: float, a: float, b: float) -> None:
    r = sign * correlation
    found = any_fails(np.array([a, b]), np.array([[1.0, r], [r, 1.0]]))
    assert found.value == pytest.approx(_by_slices(a, b, r), rel=1e-10)


@pytest.mark.share(2)
@pytest.mark.parametrize("size", [3, 6])
def test_it_agrees_with_scipy(size: int) -> None:
    rng = np.random.default_rng(size)
    root = rng.normal(size=(size, size))
    covariance, slack = root @ root.T, rng.uniform(1.0, 4.0, size) * 2.0
    known = 1.0 - multivariate_normal.cdf(slack, cov=covariance, abseps=5e-7, releps=0.0, maxpts=2_000_000, rng=1)
    found = any_fails(slack, covariance)
    assert found.low - 2e-6 <= known <= found.high + 2e-6
    assert found.high - found.low < 0.02 * known


def test_small_risks_keep_their_digits() -> None:
    found = any_fails(np.array([7.0, 7.0]), np.array([[1.0, 0.3], [0.3, 1.0]]))
    assert found.value == pytest.approx(2.0 * norm.sf(7.0), rel=1e-4)


def test_singular_covariances_are_integrated() -> None:
    walls = np.array([[1.0, -1.0], [-1.0, 1.0]])
    assert any_fails(np.array([2.0, 2.0]), walls).value == pytest.approx(2.0 * norm.sf(2.0), rel=1e-6)
    assert any_fails(np.array([2.0, 2.5]), np.ones((2, 2))).value == pytest.approx(norm.sf(2.0), rel=1e-6)
    assert any_fails(np.array([2.0, 1.0]), np.diag([1.0, 0.0])).value == pytest.approx(norm.sf(2.0))
    assert any_fails(np.array([2.0, -1.0]), np.diag([1.0, 0.0])).value == 1.0
    assert any_fails(np.array([2.0]), np.eye(1)).exact


def test_one_alternative_that_holds_is_enough() -> None:
    slack, rho = np.array([1.0, 1.0]), 0.5
    covariance = np.array([[1.0, rho], [rho, 1.0]])
    both = 2.0 * norm.sf(1.0) - any_fails(slack, covariance).value
    found = any_fails(slack, covariance, np.array([0, 0]))
    assert found.low < both < found.high < found.low + 0.01


def test_rows_without_variance_have_no_noise_among_alternatives() -> None:
    root = np.random.default_rng(3).normal(size=(5, 4)) * np.array([1.0, 1e-3, 0.0, 10.0, 1.0])[:, None]
    slack, constraint = np.array([2.0, 2e-3, 0.0, 9.0, 2.0]), np.array([2, 2, 0, 2, 1])
    rest = np.array([0, 1, 3, 4])
    covariance = root @ root.T
    known = any_fails(slack[rest], covariance[np.ix_(rest, rest)], constraint[rest]).value
    assert any_fails(slack, covariance, constraint).value == known
    slack[2] = -1e-9
    assert any_fails(slack, covariance, constraint).value == 1.0


def test_a_variance_that_rounds_below_zero_is_none() -> None:
    covariance = np.diag([-1.5e-17, 1.0])
    assert any_fails(np.array([-9.0, 3.0]), covariance).value == 1.0
    assert any_fails(np.array([9.0, 3.0]), covariance).value == norm.sf(3.0)
    assert any_fails(np.array([-9.0, 3.0, 4.0]), np.diag([-1.5e-17, 1.0, 1.0]), np.array([0, 1, 1])).value == 1.0


def test_the_gradient_is_that_of_finite_differences() -> None:
    rng = np.random.default_rng(4)
    root = rng.normal(size=(4, 4))
    covariance, slack, step = root @ root.T, np.full(4, 2.5), 1e-3
    made = gradient(slack, covariance, points=2039)
    for k in range(4):
        up, down = (any_fails(slack + sign * step * np.eye(4)[k], covariance).value for sign in (1.0, -1.0))
        assert made[k] == pytest.approx((up - down) / (2.0 * step), rel=0.01)
