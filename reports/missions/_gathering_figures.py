"""Figures of the study on information gathering."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ._tracking_figures import _figure, _plain, _save

if TYPE_CHECKING:
    import pandas as pd

COLOURS = {
    "auction": "#DDAA33", "partition, look-ahead 1": "#33AADD", "partition, look-ahead 3": "#332288", "partition, literal urgency": "#CC3377",
}  # fmt: skip

TITLES = {"gain": "units brought home", "idle": "steps for which sensors were full", "loss": "units not gathered"}


def metrics(table: pd.DataFrame, path: Path) -> None:
    """Each metric over the number of robots; bands are the intervals."""
    figure = _figure(11.0, 3.9)
    axes = figure.subplots(1, len(TITLES))
    for ax, (name, title) in zip(axes, TITLES.items(), strict=True):
        for method, colour in COLOURS.items():
            own = table[table["method"] == method]
            ax.plot(own["robots"], own[name], color=colour, linewidth=1.6, marker="o", markersize=3, label=method)
            ax.fill_between(
                own["robots"], own[name] - own[f"{name}_half"], own[name] + own[f"{name}_half"], color=colour, alpha=0.22, linewidth=0
            )
        ax.set_ylim(bottom=0)
        ax.set_xlabel("robots", fontsize=9)
        ax.locator_params(axis="x", integer=True)
        _plain(ax, title)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(COLOURS), frameon=False, fontsize=9)
    _save(figure, path)
