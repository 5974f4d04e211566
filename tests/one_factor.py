"""Gaussian constraints ``b_i f + s_i e_i <= slack_i`` with independent f and e_i, whose joint probability is an integral over f alone."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr, ndtri

Floats = NDArray[np.float64]

FARTHEST = 40.0


def any_fails_by_quadrature(slack: Floats, b: Floats, s: Floats) -> float:
    """Gauss-Legendre, in pieces about where each constraint turns from holding to failing."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    turning = b != 0.0
    middle, width = slack[turning] / b[turning], np.abs(s[turning] / b[turning])
    cuts = np.concatenate([np.linspace(-FARTHEST, FARTHEST, 161), (middle[:, None] + width[:, None] * np.linspace(-12, 12, 49)).ravel()])
    ends = np.unique(np.clip(cuts, -FARTHEST, FARTHEST))
    half = np.diff(ends)[:, None] / 2.0
    f = ends[:-1, None] + half + half * nodes
    holds = sum(log_ndtr((slack[k] - b[k] * f) / s[k]) for k in range(len(b)))
    return float((half * weights * -np.expm1(holds) * np.exp(-0.5 * f * f)).sum() / np.sqrt(2.0 * np.pi))


def drawn(rng: Any) -> tuple[Floats, Floats, float]:
    """Slack, covariance and the probability that any of 1 to 40 constraints fails, whose risks lie between 1e-12 and 0.5, at any scale."""
    many, kind = int(rng.choice([1, 2, 3, 4, 6, 10, 20, 40], p=[0.05, 0.15, 0.2, 0.2, 0.15, 0.15, 0.05, 0.05])), int(rng.integers(5))
    b = rng.normal(size=many)
    s = np.full(many, rng.choice([1e-3, 0.01, 0.1, 1.0, 10.0]))
    if kind == 1:
        b = np.full(many, rng.choice([1.0, 0.99, 3.0, 10.0]))
    if kind == 2:
        b = rng.choice([-1.0, 1.0], many)
    if kind == 3:
        s = 10.0 ** rng.uniform(-3.0, 1.0, many)
    deviation = np.hypot(b, s)
    z = -ndtri(10.0 ** (rng.uniform(-12.0, np.log10(0.5)) - rng.uniform(0.0, 2.0, many) * (rng.random(many) < 0.7)))
    if rng.random() < 0.2:
        z[:] = z[0]
    scale = 10.0 ** rng.uniform(-9.0, 9.0, many)
    covariance = (np.outer(b, b) + np.diag(s * s)) * np.outer(scale, scale)
    return z * deviation * scale, covariance, any_fails_by_quadrature(z * deviation, b, s)
