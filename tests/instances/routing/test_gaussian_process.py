import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError
from waybound.instances.routing.gaussian_process import GaussianProcess, SquaredExponential


@pytest.mark.parametrize("noise", [0.1, 0.4, 3.0])
def test_future_variance_without_data(noise):
    belief = GaussianProcess.prior(SquaredExponential(), np.zeros((1, 2)))
    assert belief.variance_left(np.array([[0]]), noise) == pytest.approx(noise / (1.0 + noise), rel=1e-12)


def test_one_datum():
    belief = GaussianProcess.prior(SquaredExponential(), np.array([[1.0, 0.0]])).given(np.zeros((1, 2)), [2.0], 0.1)
    assert belief.mean[0] == pytest.approx(1.102783, abs=5e-7)
    assert belief.variance[0] == pytest.approx(0.665564, abs=5e-7)
    assert belief.variance_left(np.array([[0]]), 0.4)[0, 0] == pytest.approx(0.249845, abs=5e-7)


def at_once(kernel, points, places, values, noise):
    """(5.4) and (5.5) as they are written."""
    inverse = np.linalg.inv(kernel(places, places) + np.diag(noise))
    across = kernel(points, places)
    return across @ inverse @ values, kernel(points, points) - across @ inverse @ across.T


@given(st.integers(0, 10**6), st.floats(0.3, 4.0), st.floats(0.5, 20.0), st.lists(st.integers(1, 5), min_size=1, max_size=4))
def test_measurements_in_turn_are_measurements_at_once(seed, length, deviation, blocks):
    rng, kernel = np.random.default_rng(seed), SquaredExponential(deviation, length)
    points = rng.uniform(0, 6, (7, 2))
    belief = GaussianProcess.prior(kernel, points)
    places, values, noise = np.zeros((0, 2)), np.zeros(0), np.zeros(0)
    for count in blocks:
        own, read, q = rng.uniform(0, 6, (count, 2)), rng.normal(0, deviation, count), rng.uniform(0.05, 1.0) * deviation**2
        belief = belief.given(own, read, q)
        places, values, noise = np.vstack([places, own]), np.append(values, read), np.append(noise, np.full(count, q))
    mean, covariance = at_once(kernel, points, places, values, noise)
    np.testing.assert_allclose(belief.mean, mean, atol=1e-8 * deviation)
    np.testing.assert_allclose(belief.covariance, covariance, atol=1e-9 * deviation**2)
    groups, extra = np.array([[0, 1, 2], [4, 5, 6]]), 0.2 * deviation**2
    left = belief.variance_left(groups, extra)
    for group, own in zip(groups, left, strict=True):  # (5.7), with the points measured as well
        more = (np.vstack([places, points[group]]), np.append(values, np.zeros(3)), np.append(noise, np.full(3, extra)))
        np.testing.assert_allclose(own, np.diag(at_once(kernel, points, *more)[1])[group], atol=1e-9 * deviation**2)


def test_a_measurement_leaves_the_belief_before_as_it_was():
    prior = GaussianProcess.prior(SquaredExponential(), np.zeros((1, 2)))
    prior.given(np.zeros((1, 2)), [5.0], 1.0)
    assert (prior.mean[0], prior.variance[0]) == (0.0, 1.0)


@pytest.mark.parametrize("noise", [0.0, -1.0, np.inf, np.nan])
def test_measurements_without_noise_are_refused(noise):
    with pytest.raises(InputError, match="noise of a measurement must be positive", check=coded("out-of-range")):
        GaussianProcess.prior(SquaredExponential(), np.zeros((1, 2))).given(np.zeros((1, 2)), [5.0], noise)


@pytest.mark.parametrize("how", [(0.0, 1.0), (1.0, 0.0), (1.0, -1.0), (np.nan, 1.0)])
def test_kernels_need_positive_numbers(how):
    with pytest.raises(InputError, match="of a kernel must be positive", check=coded("out-of-range")):
        SquaredExponential(*how)
