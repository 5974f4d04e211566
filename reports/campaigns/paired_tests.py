"""Paired tests: whether one method is worse than another on the same cases, beyond what chance explains."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ...instances.errors import UsageError
from ...instances.suggestions import did_you_mean
from ..tables.table import Column, Table

if TYPE_CHECKING:
    import pandas as pd

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Paired:
    """The differences of pairs: their mean with its confidence interval (Student's t; infinite for a single pair, whose noise nobody
    knows), and the p-value of Wilcoxon's signed-rank test that they lie around 0.
    """

    pairs: int
    mean: float
    low: float
    high: float
    p_value: float


def paired(differences: ArrayLike, confidence: float = CONFIDENCE) -> Paired:
    """Mean, confidence interval and test of the differences of pairs, of which there is at least one."""
    from scipy import stats

    d = np.asarray(differences, dtype=np.float64)
    mean = float(d.mean())
    p_value = float(stats.wilcoxon(d, zero_method="zsplit").pvalue) if d.any() else 1.0
    if len(d) == 1:
        return Paired(1, mean, -math.inf, math.inf, p_value)
    if np.ptp(d) <= 1e-12 * max(1.0, abs(mean)):  # no noise at all
        return Paired(len(d), mean, mean, mean, p_value)
    interval = stats.ttest_1samp(d, 0.0).confidence_interval(confidence)
    return Paired(len(d), mean, float(interval.low), float(interval.high), p_value)


def against(runs: pd.DataFrame, who: str) -> pd.DataFrame:
    """Paired tests of every method against one, on the cases that both answered.

    Answers to one instance are no independent draws, whatever their seeds: they are averaged, and instances are the pairs, unless there is
    one alone. Raises UsageError if no method has that name.

    Parameters
    ----------
    runs : DataFrame
        Of ``counted``.
    who : str
        The method to compare with, as the column ``who`` names it.

    Returns
    -------
    DataFrame
        ``method, pairs, mean, low, high, p_value``: of the relative differences of the objective, positive where the method is worse.
    """
    import pandas as pd

    names = sorted(runs["who"].unique())
    if who not in names:
        raise UsageError(f"there is no method {who!r}; there are {', '.join(names)}{did_you_mean(who, names)}", "unknown-name")
    counted = runs[runs["counts"]]
    sign = counted.groupby("case")["sense"].first().map({"max": -1.0}).fillna(1.0)
    values = counted.pivot_table(index=["case", "seed"], columns="who", values="objective")
    rows = []
    for other in values.columns:
        if other == who or who not in values.columns:
            continue
        both = values[[other, who]].dropna()
        if len(both):
            worse = sign.loc[both.index.get_level_values("case")].to_numpy() * relative(both[other], both[who])
            test = paired(units(pd.Series(worse, index=both.index)))
            rows.append((other, test.pairs, test.mean, test.low, test.high, test.p_value))
    return pd.DataFrame(rows, columns=["method", "pairs", "mean", "low", "high", "p_value"])


def relative(values: pd.Series[float], than: pd.Series[float]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """How much larger values are than others, relative to these, or, where these are 0, to themselves."""
    other = than.to_numpy(dtype=np.float64)
    difference: np.ndarray[tuple[int], np.dtype[np.float64]] = values.to_numpy(dtype=np.float64) - other
    size = np.abs(np.where(other == 0.0, values.to_numpy(dtype=np.float64), other))
    return np.divide(difference, size, out=np.where(np.isnan(difference), np.nan, 0.0), where=size > 0.0)


def units(differences: pd.Series[float]) -> pd.Series[float]:
    """Differences that count as one pair: the mean over the seeds of each case, or each seed where there is one case alone.

    ``differences`` have the index ``case, seed``.
    """
    means = differences.groupby(level="case").mean()
    return means if len(means) > 1 else differences


def paired_table(tests: pd.DataFrame, who: str) -> Table:
    """The table of paired tests, in percent."""
    rows = tuple(
        (str(method), str(pairs), f"{100 * mean:+.3g} %", interval(low, high), f"{p_value:.2g}")
        for method, pairs, mean, low, high, p_value in tests.itertuples(index=False, name=None)
    )
    names = ("method", "pairs", "worse by", f"{100 * CONFIDENCE:g} % interval", "p")
    return Table(f"Objective, against {who}", tuple(Column(name, right=k > 0) for k, name in enumerate(names)), rows)


def interval(low: float, high: float) -> str:
    """A confidence interval in percent."""
    return f"{100 * low:+.3g} to {100 * high:+.3g} %" if math.isfinite(low) else "unknown, one pair"
