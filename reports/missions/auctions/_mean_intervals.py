"""Means of repeated runs with their confidence intervals."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

LEVEL = 0.95


def mean_interval(values: ArrayLike) -> tuple[float, float]:
    """Mean, and half the width of its interval of confidence ``LEVEL`` by Student's t; NaN for fewer than two values."""
    from scipy import stats

    own = np.asarray(values, dtype=np.float64)
    mean = float(own.mean())
    if len(own) < 2:
        return mean, math.nan
    return mean, float(stats.t.ppf((1.0 + LEVEL) / 2.0, len(own) - 1) * own.std(ddof=1) / math.sqrt(len(own)))
