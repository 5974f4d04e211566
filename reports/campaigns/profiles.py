"""Performance profiles of a campaign: of the time to an optimum, or of the quality of answers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...instances.errors import UsageError
from ...instances.suggestions import did_you_mean
from ..plots.drawing import COLOURS, chart_axes, entitle, legend_below
from .measures import performance_profile

if TYPE_CHECKING:
    import pandas as pd

MEASURES = ("objective", "seconds")
LINE_STYLES = ("-", (0, (5, 1.5)), (0, (1.5, 1.2)), (0, (6, 1.5, 1.5, 1.5)))
"""Lines after each round of colours."""

LEAST_SECONDS = 1e-3
"""Shorter times are taken for this one: clocks and systems decide what is below."""


def profile(runs: pd.DataFrame, measure: str = "objective") -> pd.DataFrame:
    """Performance profiles of all methods; a case is an instance with a seed.

    Raises UsageError for another measure.

    Parameters
    ----------
    runs : DataFrame
        Of ``counted``.
    measure : str
        ``objective``: the cost is 1 plus the gap to the best answer of any run, or the best known value where that is better.
        ``seconds``: of the search, where it ended with an optimum; a run without one did not solve its case.

    Returns
    -------
    DataFrame
        Index ``factor``, one column per method: the share of cases within this factor of the least cost.
    """
    if measure not in MEASURES:
        hint = did_you_mean(measure, MEASURES)
        raise UsageError(f"there is no profile of {measure!r}; choose from {', '.join(MEASURES)}{hint}", "unknown-name")
    if measure == "seconds":
        cost = runs["seconds"].clip(lower=LEAST_SECONDS).where(runs["counts"] & (runs["status"] == "optimal"))
    else:
        cost = 1.0 + runs[["gap_to_best", "gap_to_known"]].max(axis=1).clip(lower=0.0).where(runs["counts"])
    costs = _by_case(runs, cost)
    if measure == "objective":  # against the best answer that is known, not the best of these methods
        costs[""] = 1.0
        return performance_profile(costs).drop(columns="")
    return performance_profile(costs)


def _by_case(runs: pd.DataFrame, cost: pd.Series[float]) -> pd.DataFrame:
    """Costs, one row per case with a seed, one column per method."""
    import pandas as pd

    methods = pd.Categorical(runs["who"])
    rows = runs.groupby(["case", "seed"], sort=False).ngroup().to_numpy()
    table = np.full((rows.max() + 1 if len(rows) else 0, len(methods.categories)), np.nan)
    np.fmin.at(table, (rows, methods.codes), cost.to_numpy(dtype=np.float64))
    return pd.DataFrame(table, columns=list(methods.categories))


def draw_profile(shares: pd.DataFrame, measure: str, ax: Any) -> Any:
    """Draw profiles as steps on matplotlib axes, factors on a logarithmic scale."""
    at = shares.index.to_numpy()
    from matplotlib.ticker import FuncFormatter, NullFormatter

    last = max(at[-1] * 1.05 if len(at) else 1.05, 1.05)
    for k, name in enumerate(shares.columns):
        style = LINE_STYLES[k // len(COLOURS) % len(LINE_STYLES)]
        ax.step([1.0, *at, last], [0.0, *shares[name], shares[name].iloc[-1] if len(at) else 0.0],
                where="post", label=name, color=COLOURS[k % len(COLOURS)], linestyle=style, linewidth=1.8)  # fmt: skip
    ax.set_xscale("log")
    ax.set_xlim(1.0, last)
    ax.set_ylim(0.0, 1.02)
    plain = FuncFormatter(lambda x, _: f"{x:g}")
    ax.xaxis.set_major_formatter(plain)
    ax.xaxis.set_minor_formatter(plain if last < 3.0 else NullFormatter())
    ax.set_xlabel("factor of the least time" if measure == "seconds" else "1 + gap to the best answer", fontsize=9, color="#555555")
    ax.set_ylabel("share of cases", fontsize=9, color="#555555")
    chart_axes(ax)
    ax.tick_params(which="minor", labelsize=8, colors="#555555")
    handles, labels = ax.get_legend_handles_labels()
    legend_below(ax, handles, labels, columns=3)
    entitle(ax, f"Performance profile: {measure}", "a line's height: the share of cases solved within this factor of the best")
    return ax


def write_profile(shares: pd.DataFrame, measure: str, path: Path) -> None:
    """Write profiles as a table (.csv) or a picture (.png, .svg, .pdf), whole or not at all."""
    from ...instances.atomic import atomic_write

    if path.suffix.lower() == ".csv":
        atomic_write(path, shares.to_csv())
        return
    from ..plots import save_axes
    from ..plots.drawing import axes_without_display

    save_axes(draw_profile(shares, measure, axes_without_display()), path)
