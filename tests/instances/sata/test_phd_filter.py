"""The filter of a probability hypothesis density: mass in a disc, prediction, update, pruning and merging, births."""

import math

import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st
from scipy import stats
from scipy.integrate import quad
from scipy.stats import multivariate_normal

from waybound import InputError
from waybound.instances.sata.phd_filter import Mixture, PHDFilter, disc_mass

HERE = np.zeros(2)


def mixture(*components):
    """From (weight, mean, covariance or variance)."""
    shaped = [(w, m, p if np.ndim(p) else p * np.eye(2)) for w, m, p in components]
    return Mixture(*(np.array([c[k] for c in shaped], dtype=float) for k in range(3)))


@pytest.mark.parametrize(
    ("distance", "mass"),
    [(0, 0.998070), (15, 0.890573), (20, 0.707679), (25, 0.442989), (30, 0.201142), (40, 0.012771)],
)
def test_known_masses_in_a_disc(distance, mass):
    own = mixture((1, (distance, 0), 50.0))
    assert disc_mass(own, HERE, 25.0) == pytest.approx([mass], abs=1e-6)
    assert PHDFilter().detected(own, HERE) == pytest.approx([0.98 * mass], abs=1e-6)


def test_a_known_mass_of_a_skewed_distribution():
    assert disc_mass(mixture((1, (10, 5), [[60, 20], [20, 30]])), HERE, 12.0) == pytest.approx([0.489368], abs=1e-6)


@given(st.floats(0, 60), st.floats(0, 6.3), st.floats(0.01, 1e4))
def test_round_distributions_follow_the_noncentral_chi_square(distance, angle, variance):
    own = mixture((1, (distance * math.cos(angle), distance * math.sin(angle)), variance))
    assert disc_mass(own, HERE, 25.0)[0] == pytest.approx(stats.ncx2.cdf(625 / variance, 2, distance**2 / variance), abs=1e-7)


@given(st.integers(0, 10**6))
def test_masses_agree_with_an_integral_around_the_circle(seed):
    """Green's theorem along rays from the mean would fail outside; here in polar coordinates of the disc, ray by ray."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(2, 2)) * 6
    covariance, mean, radius = root @ root.T + np.eye(2), rng.normal(size=2) * 15, 5 + 20 * rng.random()
    inverse, scale = np.linalg.inv(covariance), 1 / (2 * math.pi * math.sqrt(np.linalg.det(covariance)))
    turns = 2 * math.pi * np.arange(720) / 720
    rays = np.column_stack([np.cos(turns), np.sin(turns)])

    def ring(r):
        off = r * rays - mean
        return r * scale * float(np.exp(-0.5 * np.einsum("ki,ij,kj->k", off, inverse, off)).mean()) * 2 * math.pi

    assert disc_mass(mixture((1, mean, covariance)), HERE, radius)[0] == pytest.approx(quad(ring, 0, radius, limit=200)[0], abs=1e-6)


def test_many_places_at_once_are_as_one_by_one():
    own = mixture((1, (3, 4), 9.0), (2, (20, 0), [[5, 1], [1, 2]]))
    places = np.array([[0.0, 0.0], [15.0, 3.0], [-40.0, 2.0]])
    assert np.array_equal(disc_mass(own, places, 10.0), [disc_mass(own, place, 10.0) for place in places])


def test_the_border_pushes_what_it_does_not_see():
    """p_D is 0.434 at 25 m: by (2.11) the mean moves by that share of its way; at 15 m (0.873) and 30 m (0.197) it stays."""
    own = mixture((1, (15, 0), 50.0), (1, (25, 0), 50.0), (1, (30, 0), 50.0))
    none = np.zeros((0, 2))
    seen = PHDFilter().detected(own, HERE)
    for repulsion, at in (("all", 25 * (1 + seen[1])), ("undetected", 25 * (1 + seen[1])), ("none", 25.0)):
        after = PHDFilter(repulsion=repulsion).update(own, HERE, none)
        assert after.means[:, 0] == pytest.approx([15, at, 30])
        assert after.weights == pytest.approx(1 - seen)
        assert np.array_equal(after.covariances, own.covariances)
    assert seen[1] == pytest.approx(0.434, abs=5e-4)
    detected = np.array([[25.0, 0.0]])
    pushed = {
        kind: PHDFilter(repulsion=kind).update(own.part(np.array([False, True, False])), HERE, detected) for kind in ("all", "undetected")
    }
    assert pushed["all"].means[0, 0] > 30 and pushed["undetected"].means[0, 0] == 25


def test_one_component_and_one_detection_are_a_kalman_filter():
    prior, z = mixture((0.7, (2, 1), [[8, 3], [3, 5]])), np.array([[3.0, 0.0]])
    rules = PHDFilter(clutter=0.2, noise=2.0, repulsion="none")
    after = rules.update(prior, HERE, z)
    seen, p = rules.detected(prior, HERE)[0], prior.covariances[0]
    likelihood = multivariate_normal.pdf(z[0], prior.means[0], p + 4 * np.eye(2))
    hit = seen * 0.7 * likelihood
    assert after.weights == pytest.approx([0.7 * (1 - seen), hit / (hit + 0.2 / (math.pi * 625))])
    information = np.linalg.inv(p) + np.eye(2) / 4
    assert after.covariances[1] == pytest.approx(np.linalg.inv(information))
    assert after.means[1] == pytest.approx(np.linalg.solve(information, np.linalg.solve(p, prior.means[0]) + z[0] / 4))


@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(0, 4), st.sampled_from([0.0, 0.1]))
def test_each_detection_adds_a_target_at_most_and_without_clutter_exactly_one(seed, count, detections, clutter):
    rng = np.random.default_rng(seed)
    prior = mixture(*((rng.random() + 0.1, rng.normal(size=2) * 8, 1 + 40 * rng.random()) for _ in range(count)))
    rules = PHDFilter(clutter=clutter)
    after = rules.update(prior, HERE, rng.normal(size=(detections, 2)) * 8)
    assert len(after.weights) == count * (detections + 1)
    each = after.weights[count:].reshape(detections, count).sum(axis=1)
    assert (each <= 1 + 1e-12).all()
    if not clutter:
        assert each == pytest.approx(np.ones(detections))
    assert after.weights[:count] == pytest.approx((1 - rules.detected(prior, HERE)) * prior.weights)


@given(st.integers(0, 10**6), st.integers(0, 12))
def test_merging_keeps_weight_mean_and_spread(seed, count):
    rng = np.random.default_rng(seed)
    prior = mixture(*((rng.random() + 0.01, rng.normal(size=2) * 5, 1 + 5 * rng.random()) for _ in range(count))) if count else _empty()
    after = PHDFilter().reduced(prior)
    moments = [_moments(m) for m in (prior, after)]
    for one, other in zip(*moments, strict=True):
        assert one == pytest.approx(other, abs=1e-9)
    assert len(after.weights) <= count


def _empty():
    return Mixture(np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2, 2)))


def _moments(m):
    second = m.covariances + m.means[:, :, None] * m.means[:, None, :]
    return m.weights.sum(), m.weights @ m.means, np.einsum("k,kij->ij", m.weights, second)


def test_light_components_go_and_near_ones_join_the_heaviest():
    own = mixture((0.5, (0, 0), 1.0), (0.0009, (50, 0), 1.0), (1.5, (3, 0), 1.0), (1.0, (20, 0), 1.0), (0.2, (6.4, 0), 1.0))
    after = PHDFilter().reduced(own)
    assert after.weights == pytest.approx([2.0, 1.0, 0.2])
    assert after.means[:, 0] == pytest.approx([2.25, 20, 6.4])
    assert after.covariances[0] == pytest.approx(np.diag([1 + 0.75 * 0.75**2 + 0.25 * 2.25**2, 1]))


def test_prediction_spreads_and_births_have_the_noise_of_a_measurement():
    rules = PHDFilter(survival=0.9, drift=0.5, noise=2.0, birth=0.8)
    after = rules.predict(mixture((1, (2, 3), 4.0)))
    assert (after.weights[0], after.means[0].tolist(), after.covariances[0, 0, 0]) == (0.9, [2, 3], 4.25)
    born = rules.born(np.array([[1.0, 2.0], [5.0, 6.0]]))
    assert born.weights.tolist() == [0.8, 0.8] and np.array_equal(born.covariances, [4 * np.eye(2)] * 2)


@pytest.mark.parametrize(
    ("rules", "message"),
    [
        ({"detection": 1.2}, "detection is no probability"), ({"survival": -0.1}, "survival is no probability"),
        ({"clutter": -0.1}, "clutter is no probability"), ({"drift": -1.0}, "drift is negative"),
        ({"merge": math.nan}, "merge is negative or no number"), ({"noise": 0.0}, "noise is 0"), ({"birth": -1.0}, "birth is negative"),
        ({"detection": math.nan}, "detection is no probability"),
    ],
)  # fmt: skip
def test_rules_that_make_no_filter_are_refused(rules, message):
    with pytest.raises(InputError, match=message, check=coded("out-of-range")):
        PHDFilter(**rules)
