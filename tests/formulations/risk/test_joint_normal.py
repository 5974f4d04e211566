import numpy as np
import pytest
from one_factor import any_fails_by_quadrature, drawn
from scipy.stats import multivariate_normal, norm

from waybound.formulations.risk.joint_normal import CONFIDENCE, _mean_between, any_fails


@pytest.mark.parametrize(
    ("correlation", "union"), [(-0.99, 0.1), (-0.5, 0.09994), (0.0, 0.0975), (0.5, 0.08781), (0.9, 0.06813), (0.99, 0.05581)]
)
def test_two_events_of_one_twentieth(correlation: float, union: float) -> None:
    covariance = np.array([[1.0, correlation], [correlation, 1.0]])
    chance = any_fails(np.full(2, norm.isf(0.05)), covariance)
    assert chance.value == pytest.approx(union, abs=6e-6)
    assert chance.low <= chance.value <= chance.high <= chance.low + 1e-4


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
    chance = any_fails(np.array([a, b]), np.array([[1.0, r], [r, 1.0]]))
    assert chance.value == pytest.approx(_by_slices(a, b, r), rel=1e-10)


@pytest.mark.share(2)
@pytest.mark.parametrize("size", [3, 6])
def test_it_agrees_with_scipy(size: int) -> None:
    rng = np.random.default_rng(size)
    root = rng.normal(size=(size, size))
    covariance, slack = root @ root.T, rng.uniform(1.0, 4.0, size) * 2.0
    known = 1.0 - multivariate_normal.cdf(slack, cov=covariance, abseps=5e-7, releps=0.0, maxpts=2_000_000, rng=1)
    chance = any_fails(slack, covariance)
    assert chance.low - 2e-6 <= known <= chance.high + 2e-6
    assert chance.high - chance.low < 0.02 * known


def test_small_risks_keep_their_digits() -> None:
    chance = any_fails(np.array([7.0, 7.0]), np.array([[1.0, 0.3], [0.3, 1.0]]))
    assert chance.value == pytest.approx(2.0 * norm.sf(7.0), rel=1e-4)


def test_singular_covariances_are_integrated() -> None:
    walls = np.array([[1.0, -1.0], [-1.0, 1.0]])
    assert any_fails(np.array([2.0, 2.0]), walls).value == pytest.approx(2.0 * norm.sf(2.0), rel=1e-6)
    assert any_fails(np.array([2.0, 2.5]), np.ones((2, 2))).value == pytest.approx(norm.sf(2.0), rel=1e-6)
    assert any_fails(np.array([2.0, 1.0]), np.diag([1.0, 0.0])).value == pytest.approx(norm.sf(2.0))
    assert any_fails(np.array([2.0, -1.0]), np.diag([1.0, 0.0])).value == 1.0
    assert any_fails(np.array([2.0]), np.eye(1)).exact


def test_two_alternatives_fail_as_often_as_both_do() -> None:
    slack, rho = np.array([1.0, 1.0]), 0.5
    covariance = np.array([[1.0, rho], [rho, 1.0]])
    both = 2.0 * norm.sf(1.0) - any_fails(slack, covariance).value
    chance = any_fails(slack, covariance, np.array([0, 0]))
    assert chance.exact and chance.value == pytest.approx(both, rel=1e-12)


@pytest.mark.parametrize("z", [1.0, 3.0, 4.5])
def test_rare_failures_of_constraints_with_alternatives_are_met(z: float) -> None:
    """Three constraints of three alternatives each, with one noise in common and much of their own."""
    own, constraint = 0.5, np.repeat(np.arange(3), 3)
    covariance = np.ones((9, 9)) + own**2 * np.eye(9)
    f = np.linspace(-12.0, 12.0, 200_001)
    each = norm.sf((z - f) / own) ** 3
    truth = float(np.trapezoid((1.0 - (1.0 - each) ** 3) * norm.pdf(f), f))
    chance = any_fails(np.full(9, z), covariance, constraint)
    assert chance.low <= truth <= chance.high <= chance.low + 0.05 * chance.most


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


def test_failures_that_come_together_are_met_however_rare() -> None:
    """Two walls, and a second sensor of one of them: what a lattice over the cube never meets."""
    b, s = np.array([1.0, -1.0, 1.0]), np.full(3, 0.01)
    for z in (2.0, 4.3, 5.0, 7.0):
        slack = np.array([z, z - 0.1, z]) * np.hypot(b, s)
        truth, chance = any_fails_by_quadrature(slack, b, s), any_fails(slack, np.outer(b, b) + np.diag(s * s))
        assert chance.low * (1.0 - 1e-10) <= truth <= chance.high * (1.0 + 1e-10)
        assert chance.high <= 1.001 * truth


def test_limits_hold_of_random_constraints_from_a_risk_of_1e_12_on() -> None:
    rng = np.random.default_rng(6)
    for _ in range(40):
        slack, covariance, truth = drawn(rng)
        chance = any_fails(slack, covariance)
        assert chance.low <= truth * (1.0 + 1e-10) and truth * (1.0 - 1e-10) <= min(chance.high, chance.most)
        assert chance.high - chance.low <= 0.3 * truth


def test_no_interval_is_narrower_than_its_samples_see() -> None:
    """Where not one of them shows what the tree's limit leaves out, it may still be that much."""
    unseen = np.zeros(1), np.array([1000.0])
    mean, low, high = _mean_between(unseen, unseen, 7.6)
    assert (mean, low) == (0.0, 0.0) and 7.6e-3 <= high <= 9e-3


@pytest.mark.parametrize("p", [0.003, 0.1, 0.5])
def test_the_limits_of_a_mean_are_kept_as_often_as_they_say(p: float) -> None:
    rng, doubt, missed = np.random.default_rng(8), 0.2, 0
    for _ in range(400):
        pilot, counts = (
            (np.array([0.0, 1.0]), np.array([n - k, k], dtype=float)) for n, k in ((100, rng.binomial(100, p)), (800, rng.binomial(800, p)))
        )
        _, low, high = _mean_between(pilot, counts, np.log(2.0 / doubt))
        missed += not low <= p <= high
    assert missed <= 400 * doubt


def test_independent_parts_are_exact() -> None:
    chance = any_fails(np.full(50, 3.0), np.eye(50))
    assert chance.value == pytest.approx(-np.expm1(50 * np.log1p(-norm.sf(3.0))), rel=1e-13) and chance.confidence == 1.0
    pair, apart = np.array([[1.0, 0.9], [0.9, 1.0]]), np.array([0, 2, 1, 3])
    twice = np.kron(np.eye(2), pair)[np.ix_(apart, apart)]
    one = any_fails(np.full(2, 4.0), pair).value
    assert any_fails(np.full(4, 4.0), twice).value == pytest.approx(2.0 * one - one * one, rel=1e-13)


def test_alike_constraints_count_once() -> None:
    many = any_fails(np.full(30, 5.0), np.ones((30, 30)))
    assert many.low <= norm.sf(5.0) * (1.0 + 1e-9) and many.high == pytest.approx(norm.sf(5.0), rel=1e-9)
    walls = np.array([1.0, -1.0] * 5)
    assert any_fails(np.full(10, 5.0), np.outer(walls, walls)).value == pytest.approx(2.0 * norm.sf(5.0), rel=1e-9)


def test_what_is_kept_is_proved_or_said_with_its_confidence() -> None:
    chance = any_fails(np.full(5, 3.0), np.full((5, 5), 0.9) + 0.1 * np.eye(5))
    assert chance.low < chance.value < chance.high < chance.most
    assert chance.kept(chance.most) == 1.0 and chance.kept(chance.high) == CONFIDENCE and chance.kept(chance.value) == 0.0
