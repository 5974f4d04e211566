"""The probability that any of many jointly Gaussian constraints fails, with limits between which it lies.

One constraint: the normal tail. Two: Plackett's integral. More: that over the cube of Genz (1992), the constraints in the order of their
risk, over a lattice rule with random shifts (Richtmyer's, Cranley and Patterson 1976), whose spread gives the interval. What is summed up
are probabilities to fail, first at the first, then at the second after the first held: so that small ones keep their digits, where one
minus a probability to hold loses them. Alternatives, of which any suffices, are sampled.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .normal import ndtr, ndtri

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SHIFTS, POINTS, MORE_POINTS = 12, 2039, 8191
"""Random shifts of the lattice, and its points: primes; more where an answer is judged by them."""

WORK = 4e8
"""Multiplications that a probability may take: of more constraints fewer points are looked at."""

SAMPLES = 200_000

CONFIDENCE = 0.999

_STUDENT = 4.4370
"""Of the t distribution with ``SHIFTS - 1`` degrees of freedom, the quantile that leaves (1 - CONFIDENCE) / 2 above it."""

ROUNDED = 1e-15
"""Part of a probability, for each constraint, that sums and tails round off."""

ALIKE = 0.95
"""Correlation of two constraints from which on what tells them apart is integrated."""

SINGULAR = 1e-7
"""Part of a standard deviation left by those before, under which a constraint depends on them alone."""


@dataclass(frozen=True)
class Probability:
    """An estimate, and an interval that holds the truth with probability ``CONFIDENCE``; ``exact`` where there is no sampling in it."""

    value: float
    low: float
    high: float
    exact: bool = False


def any_fails(slack: Floats, covariance: Floats, constraint: Ints | None = None, *, seed: int = 1, points: int = POINTS) -> Probability:
    """Probability that a centred Gaussian vector with ``covariance`` exceeds ``slack`` anywhere.

    Parameters
    ----------
    slack : array of shape (rows,)
    covariance : array of shape (rows, rows)
        Positive semidefinite. Rows without variance hold for certain, or fail.
    constraint : array of shape (rows,), optional
        The constraint of each row: one fails where all of its rows do. By default each row is one.
    seed : int
        Of the shifts, or samples.
    points : int
        Of the lattice, at most.
    """
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))  # which rounding may leave below 0
    if constraint is not None and len(np.unique(constraint)) < len(constraint):
        return _sampled(slack, covariance, constraint, seed)
    if (slack[deviation == 0.0] < 0.0).any():
        return Probability(1.0, 1.0, 1.0, True)
    kept = deviation > 0.0
    with np.errstate(over="ignore"):
        z = slack[kept] / deviation[kept]
    tails = ndtr(-z)
    felt = tails > 1e-300
    total = float(tails.sum())
    if not felt.any():
        return Probability(total, total, total, True)
    z, tails = z[felt], tails[felt]
    correlation = (covariance[np.ix_(kept, kept)] / np.outer(deviation[kept], deviation[kept]))[np.ix_(felt, felt)]
    if len(z) == 1:
        return Probability(float(tails[0]), float(tails[0]), float(tails[0]), True)
    if len(z) == 2:
        either = total - _both(float(z[0]), float(z[1]), float(correlation[0, 1]))
        value = min(max(either, float(tails.max())), total)
        return Probability(value, value, value, True)
    order = np.argsort(z, kind="stable")
    return _integral(z[order], correlation[np.ix_(order, order)], float(tails.max()), total, seed, points)


def gradient(slack: Floats, covariance: Floats, *, points: int = 251) -> Floats:
    """How the probability that any fails falls with each entry of ``slack``, all of them with noise.

    By the density of a constraint at its limit, times the probability that the others hold there.
    """
    deviation = np.sqrt(np.diag(covariance))
    density = np.exp(-0.5 * (slack / deviation) ** 2) / (deviation * math.sqrt(2.0 * math.pi))
    made = np.zeros(len(slack))
    for k in np.nonzero(density * deviation > 1e-12)[0].tolist():
        others = np.arange(len(slack)) != k
        along = covariance[others, k] / covariance[k, k]
        left = covariance[np.ix_(others, others)] - np.outer(along, covariance[k, others])
        variance = np.diag(left).copy()
        variance[variance < (SINGULAR * deviation[others]) ** 2] = 0.0
        keep = (variance > 0.0).astype(float)
        left = left * np.outer(keep, keep)
        np.fill_diagonal(left, variance)
        made[k] = -density[k] * (1.0 - any_fails(slack[others] - along * slack[k], left, points=points).value)
    return made


def _both(a: float, b: float, correlation: float) -> float:
    """Probability that two standard normal numbers exceed a and b: Plackett's (1954) integral over the correlation, far from its ends."""
    from scipy.integrate import quad

    if correlation > ALIKE:
        return max(0.0, float(ndtr(-max(a, b))) - _apart(max(a, b), min(a, b), correlation))
    if correlation < -ALIKE:  # the second exceeds b where its opposite, which is like the first, does not exceed -b
        if a >= -b:
            return _apart(a, -b, -correlation)
        return float(ndtr(-a) - ndtr(b)) + _apart(-b, a, -correlation)

    def along(angle: float) -> float:
        sine, cosine = math.sin(angle), math.cos(angle)
        power = (a * a + b * b - 2.0 * a * b * sine) / (2.0 * cosine * cosine)
        return float(math.exp(-power))

    found = quad(along, 0.0, math.asin(correlation), epsabs=1e-300, epsrel=1e-11, limit=200)[0]
    return max(0.0, float(ndtr(-a) * ndtr(-b)) + float(found) / (2.0 * math.pi))


def _apart(a: float, b: float, correlation: float) -> float:
    """Probability that of two standard normal numbers, nearly the same, the first exceeds a and the second does not exceed b <= a."""
    from scipy.integrate import quad

    spread = math.sqrt(max(0.0, (1.0 - correlation) * (1.0 + correlation)))
    if spread == 0.0:
        return 0.0
    edge = ((b - a) + (1.0 - correlation) * a) / spread
    if edge < -38.0:
        return 0.0

    def along(t: float) -> float:
        x = a + spread * t
        return float(math.exp(-0.5 * x * x) * ndtr(edge - correlation * t))

    found = quad(along, 0.0, (edge + 38.0) / correlation, epsabs=1e-300, epsrel=1e-11, limit=200)[0]
    return spread * float(found) / math.sqrt(2.0 * math.pi)


def _integral(z: Floats, correlation: Floats, least: float, most: float, seed: int, points: int) -> Probability:
    """By the lattice; between the largest single risk and the sum of all, where it lies for certain (Frechet, Boole)."""
    factor, size = _factor(correlation), len(z)
    points = int(min(points, max(31, WORK / (SHIFTS * size * size))))
    rng = np.random.default_rng(seed)
    roots = np.sqrt(_primes(size))
    base = np.arange(1, points + 1)[:, None] * (roots - np.floor(roots))
    found = np.empty(SHIFTS)
    for k in range(SHIFTS):
        shifted = base + rng.random(size)
        shifted -= np.floor(shifted)
        found[k] = float(np.mean(_fail_first(z, factor, np.abs(2.0 * shifted - 1.0))))  # the tent makes it periodic
    value = float(found.mean())
    error = _STUDENT * float(found.std(ddof=1)) / math.sqrt(SHIFTS) + ROUNDED * size * value
    clipped = np.clip([value, value - error, value + error], least, min(1.0, most))
    return Probability(float(clipped[0]), float(clipped[1]), float(clipped[2]))


def _fail_first(z: Floats, factor: Floats, points: Floats) -> Floats:
    """For each point of the cube the probability to fail, one constraint after the other."""
    many, size = points.shape
    normal = np.zeros((many, size))
    holds, fails = np.ones(many), np.zeros(many)
    for k in range(size):
        given = normal[:, :k] @ factor[k, :k]
        own = factor[k, k]
        if own > SINGULAR:
            edge = (z[k] - given) / own
            tail = ndtr(-edge)
            normal[:, k] = np.clip(ndtri(np.maximum(points[:, k], 1e-300) * ndtr(edge)), -38.0, 38.0)
        else:
            tail = (given > z[k] + 1e-9).astype(np.float64)
        fails += holds * tail
        holds *= 1.0 - tail
    return fails


def _factor(correlation: Floats) -> Floats:
    """Lower triangle whose product with its transpose is the correlation, which may be singular."""
    size = len(correlation)
    made = np.zeros((size, size))
    for k in range(size):
        rest = correlation[k, k] - made[k, :k] @ made[k, :k]
        if rest > SINGULAR**2:
            made[k, k] = math.sqrt(rest)
            made[k + 1 :, k] = (correlation[k + 1 :, k] - made[k + 1 :, :k] @ made[k, :k]) / made[k, k]
    return made


def _primes(count: int) -> Floats:
    """The first prime numbers."""
    limit = max(16, int(count * (math.log(count + 2) + math.log(math.log(count + 3)) + 2)))
    sieve = np.ones(limit, dtype=bool)
    sieve[:2] = False
    for p in range(2, math.isqrt(limit) + 1):
        if sieve[p]:
            sieve[p * p :: p] = False
    return np.nonzero(sieve)[0][:count].astype(np.float64)


def _sampled(slack: Floats, covariance: Floats, constraint: Ints, seed: int) -> Probability:
    """By samples, with the interval of Clopper and Pearson (1934)."""
    from scipy.special import betaincinv  # scipy.stats takes a second to load

    deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    noisy, z = deviation > 0.0, np.where(slack >= 0.0, math.inf, -math.inf)
    z[noisy] = slack[noisy] / deviation[noisy]
    root = np.zeros((len(slack), int(noisy.sum())))  # rows without variance have no noise, not that of its rounding
    values, vectors = np.linalg.eigh(covariance[np.ix_(noisy, noisy)] / np.outer(deviation[noisy], deviation[noisy]))
    root[noisy] = vectors * np.sqrt(np.maximum(values, 0.0))
    rng, failed = np.random.default_rng(seed), 0
    order = np.argsort(constraint, kind="stable")
    starts = np.nonzero(np.diff(constraint[order], prepend=-1))[0]
    sorted_root, sorted_z = root[order], z[order, None]
    portion = max(1, min(SAMPLES, int(2e6 // max(1, len(slack)))))  # what a processor keeps at hand
    for begin in range(0, SAMPLES, portion):
        noise = rng.standard_normal((min(portion, SAMPLES - begin), root.shape[1]))
        beyond = sorted_root @ noise.T > sorted_z
        failed += int(np.logical_and.reduceat(beyond, starts, axis=0).any(axis=0).sum())
    low = 0.0 if failed == 0 else float(betaincinv(failed, SAMPLES - failed + 1, (1.0 - CONFIDENCE) / 2.0))
    high = 1.0 if failed == SAMPLES else float(betaincinv(failed + 1, SAMPLES - failed, (1.0 + CONFIDENCE) / 2.0))
    most = min(1.0, float(np.minimum.reduceat(ndtr(-z)[order], starts).sum()))  # Boole
    return Probability(min(failed / SAMPLES, most), min(low, most), min(high, most))
