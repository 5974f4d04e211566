"""Figures of the study on information gathering."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from .._study_figures import _figure, _plain, _save

if TYPE_CHECKING:
    import pandas as pd

COLOURS = {
    "auction": "#DDAA33", "partition, look-ahead 1": "#33AADD", "partition, look-ahead 3": "#332288",
    "partition, literal urgency": "#CC3377",
}  # fmt: skip

TITLES = {"gain": "units brought home", "idle": "steps for which sensors were full", "loss": "units not gathered"}


def metrics(table: pd.DataFrame, path: Path) -> None:
    """Each metric over the number of robots, and below it by how much each method lies above the auction on the same runs; bands are the
    intervals."""
    figure = _figure(11.0, 6.6)
    axes = figure.subplots(2, len(TITLES), sharex=True)
    for column, (name, title) in enumerate(TITLES.items()):
        for ax, key in zip(axes[:, column], (name, f"{name}_above"), strict=True):
            for method, colour in COLOURS.items():
                own = table[table["method"] == method]
                ax.plot(own["robots"], own[key], color=colour, linewidth=1.6, marker="o", markersize=3, label=method)
                low, high = (own[key] + sign * own[f"{key}_half"] for sign in (-1, 1))
                ax.fill_between(own["robots"], low, high, color=colour, alpha=0.22, linewidth=0)
        axes[0, column].set_ylim(bottom=0)
        axes[1, column].set_xlabel("robots", fontsize=9)
        axes[1, column].locator_params(axis="x", integer=True)
        _plain(axes[0, column], title)
        _plain(axes[1, column], "above the auction, on the same runs")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=len(COLOURS), frameon=False, fontsize=9)
    _save(figure, path)
