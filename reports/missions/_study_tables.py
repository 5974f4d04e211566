"""Tables of studies: rows by the names of their columns, markdown, and means with intervals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    import pandas as pd

LEVEL = 0.95


def records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """The rows of a table by the names of its columns."""
    return [{str(key): value for key, value in row.items()} for row in table.to_dict("records")]


def markdown(table: pd.DataFrame) -> str:
    """A table as markdown, numbers with four digits."""

    def text(value: Any) -> str:
        if isinstance(value, float):
            return "-" if math.isnan(value) else f"{value:.4g}"
        return str(value)

    lines = [" | ".join(map(str, table.columns)), " | ".join("---" for _ in table.columns)]
    lines += [" | ".join(text(value) for value in row) for row in table.itertuples(index=False)]
    return "\n".join(f"| {line} |" for line in lines) + "\n"


def mean_interval(values: ArrayLike) -> tuple[float, float]:
    """Mean, and half the width of its interval of confidence ``LEVEL`` by Student's t; NaN for fewer than two values."""
    from scipy import stats

    own = np.asarray(values, dtype=np.float64)
    mean = float(own.mean())
    if len(own) < 2:
        return mean, math.nan
    return mean, float(stats.t.ppf((1.0 + LEVEL) / 2.0, len(own) - 1) * own.std(ddof=1) / math.sqrt(len(own)))
