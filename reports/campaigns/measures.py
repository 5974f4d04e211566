"""Measures for comparing methods over many instances: profiles, means and integrals of the field."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    import pandas as pd

SHIFT = 1.0
"""Seconds that a shifted geometric mean of times adds, so that runs of milliseconds do not decide it."""


def shifted_geometric_mean(values: ArrayLike, shift: float = SHIFT) -> float:
    """``prod(v + shift)^(1/n) - shift``: a mean that neither the longest nor the shortest runs decide; NaN of nothing.

    Source: Achterberg, Constraint Integer Programming (2007), section A.3.
    """
    v = np.asarray(values, dtype=np.float64)
    return float(np.exp(np.log(v + shift).mean()) - shift) if v.size else float("nan")


def performance_profile(costs: "pd.DataFrame", factors: Sequence[float] | None = None) -> "pd.DataFrame":
    """The share of cases that each method solves within a factor of the best method's cost.

    Source: Dolan and Moré, Benchmarking optimization software with performance profiles, Mathematical Programming 91 (2002).

    Parameters
    ----------
    costs : DataFrame
        One row per case, one column per method, positive; NaN where a method did not solve a case. Cases that none solved count for all.
    factors : sequence of float, optional
        From 1; by default all at which a profile rises.

    Returns
    -------
    DataFrame
        Index ``factor``, one column per method.
    """
    import pandas as pd

    values = costs.to_numpy(dtype=np.float64)
    best = np.fmin.reduce(values, axis=1) if values.size else np.empty(len(costs))
    with np.errstate(invalid="ignore", divide="ignore"):
        ratios = values / best[:, None]
    ratios[(values == 0.0) & (best[:, None] == 0.0)] = 1.0
    ratios[np.isnan(ratios)] = np.inf
    at = np.unique(ratios[np.isfinite(ratios)]) if factors is None else np.asarray(factors, dtype=np.float64)
    shares = {
        name: np.searchsorted(np.sort(ratios[:, k]), at * (1.0 + 1e-12), side="right") / max(1, len(costs))
        for k, name in enumerate(costs.columns)
    }
    return pd.DataFrame(shares, index=pd.Index(at, name="factor"))


def primal_integral(seconds: ArrayLike, objectives: ArrayLike, best: float, until: float) -> float:
    """The primal gap over time, summed from 0 to ``until``, in seconds: low for a search that is early near to the best.

    Source: Berthold, Measuring the impact of primal heuristics, Operations Research Letters 41 (2013).

    Parameters
    ----------
    seconds, objectives : array (events,)
        When each better answer was there, and what it is worth.
    best : float
        The value to compare with: the best that is known.
    until : float, seconds
    """
    at, values = np.asarray(seconds, dtype=np.float64), np.asarray(objectives, dtype=np.float64)
    at = np.minimum(at, until)
    gaps = np.concatenate(([1.0], primal_gap(values, best)))
    return float((gaps * np.diff(np.concatenate(([0.0], at, [until])))).sum())


def primal_gap(values: ArrayLike, best: float) -> NDArray[np.float64]:
    """``|v - best| / max(|v|, |best|)``; 0 where both are 0, and 1 where their signs differ (Berthold 2013)."""
    v = np.asarray(values, dtype=np.float64)
    most = np.maximum(np.abs(v), abs(best))
    gaps = np.abs(v - best) / np.where(most > 0.0, most, 1.0)
    return np.where(v * best < 0.0, 1.0, gaps)
