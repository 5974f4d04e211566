"""How the probability that any of many jointly Gaussian constraints fails changes with what each leaves.

By the density of a constraint at its limit, times the probability that the others hold there: that over the cube of Genz (1992), over a
lattice rule with random shifts (Richtmyer's, Cranley and Patterson 1976).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .joint_normal import any_fails
from .normal import ndtr, ndtri

Floats = NDArray[np.float64]

SHIFTS, POINTS = 12, 251
"""Random shifts of the lattice, and its points: a prime."""

SINGULAR = 1e-7
"""Part of a standard deviation left by those before, under which a constraint depends on them alone."""


def gradient(slack: Floats, covariance: Floats, *, points: int = POINTS) -> Floats:
    """How the probability that any fails falls with each entry of ``slack``, all of them with noise.

    Parameters
    ----------
    slack : array of shape (rows,)
    covariance : array of shape (rows, rows)
    points : int
        Of the lattice.
    """
    deviation = np.sqrt(np.diag(covariance))
    z, correlation = slack / deviation, covariance / deviation[:, None] / deviation
    density = np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)
    made = np.zeros(len(z))
    for k in np.nonzero(density > 1e-12 * density.max(initial=0.0))[0].tolist():
        others = np.arange(len(z)) != k
        along = correlation[others, k]
        left = correlation[np.ix_(others, others)] - np.outer(along, along)
        own = np.diag(left).copy()
        own[own < SINGULAR**2] = 0.0
        left = left * np.outer(own > 0.0, own > 0.0)
        np.fill_diagonal(left, own)
        made[k] = -density[k] / deviation[k] * _all_hold(z[others] - along * z[k], left, points)
    return made


def _all_hold(slack: Floats, covariance: Floats, points: int) -> float:
    """Probability that none fails; those without noise hold at their limit, but for rounding."""
    deviation = np.sqrt(np.diag(covariance))
    noisy = deviation > 0.0
    if (slack[~noisy] < -SINGULAR).any():
        return 0.0
    if np.count_nonzero(noisy) <= 2:
        return 1.0 - any_fails(slack[noisy], covariance[np.ix_(noisy, noisy)]).value
    z = slack[noisy] / deviation[noisy]
    correlation = covariance[np.ix_(noisy, noisy)] / deviation[noisy][:, None] / deviation[noisy]
    order = np.argsort(z, kind="stable")
    factor, rng = _factor(correlation[np.ix_(order, order)]), np.random.default_rng(1)
    roots = np.sqrt(_primes(len(z)))
    base = np.arange(1, points + 1)[:, None] * (roots - np.floor(roots))
    shifted = (base + rng.random((SHIFTS, 1, len(z)))).reshape(-1, len(z)) % 1.0
    return float(np.mean(_hold_in_turn(z[order], factor, np.abs(2.0 * shifted - 1.0))))  # the tent makes it periodic


def _hold_in_turn(z: Floats, factor: Floats, points: Floats) -> Floats:
    """For each point of the cube the probability to hold, one constraint after the other."""
    many, size = points.shape
    normal, holds = np.zeros((many, size)), np.ones(many)
    for k in range(size):
        given = normal[:, :k] @ factor[k, :k]
        own = factor[k, k]
        if own > SINGULAR:
            below = ndtr((z[k] - given) / own)
            normal[:, k] = np.clip(ndtri(np.maximum(points[:, k], 1e-300) * below), -38.0, 38.0)
            holds *= below
        else:
            holds *= given <= z[k] + 1e-9
    return holds


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
