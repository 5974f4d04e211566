"""Figures of the tracking study."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .._study_figures import _figure, _plain, _save

if TYPE_CHECKING:
    import pandas as pd

COLOURS = {
    "greedy": "#332288", "greedy-stay-first": "#8877CC", "force-vector": "#DDAA33", "random": "#777777", "exact": "#117733",
    "stay": "#BBBBBB", "lp-rounding": "#33AADD", "local": "#CC3377",
    "binary": "#332288", "inverse-distance": "#CC3377", "binary, noisy": "#33AADD", "inverse-distance, noisy": "#DDAA33",
}  # fmt: skip
"""Colours of methods and of weights; alike ones never meet in one picture."""


def parker(table: pd.DataFrame, path: Path) -> None:
    """Targets observed by each method, for each number of targets: (a), (b) and (c), with standard deviations."""
    figure = _figure(11.0, 3.8)
    axes = figure.subplots(1, 3, sharey=True)
    methods, counts = list(dict.fromkeys(table["method"])), sorted(set(table["targets"]))
    width = 0.8 / len(methods)
    for ax, key, title in zip(axes, "abc", ("(a) single steps", "(b) all steps of long runs", "(c) time averages"), strict=True):
        for k, method in enumerate(methods):
            own = table[table["method"] == method].set_index("targets").loc[counts]
            at = np.arange(len(counts)) + (k - (len(methods) - 1) / 2) * width
            ax.bar(at, own[f"{key}_mean"], width * 0.92, yerr=own[f"{key}_std"], color=COLOURS[method], label=method, **_ERRORS)
        ax.set_xticks(range(len(counts)), [str(count) for count in counts])
        ax.set_xlabel("targets", fontsize=9)
        _plain(ax, title)
    axes[0].set_ylabel("targets observed: mean, standard deviation", fontsize=9)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(methods), frameon=False, fontsize=9)
    _save(figure, path)


def weights(logs: pd.DataFrame, path: Path) -> None:
    """Estimated against actual, all steps: number of targets, and value of the objective; a step on the diagonal came true."""
    figure = _figure(9.0, 4.4)
    axes = figure.subplots(1, 2)
    for ax, what, title in zip(axes, ("targets", "value"), ("number of targets", "value, relative to the largest"), strict=True):
        for k, (method, log) in enumerate(logs.groupby("method", sort=False)):
            estimated, actual = log[f"estimated_{what}"].to_numpy(), log[f"actual_{what}"].to_numpy()
            scale = 1.0 if what == "targets" else max(np.nanmax(estimated), np.nanmax(actual), 1e-9)
            ax.plot(actual / scale, estimated / scale, "ox"[k % 2], color=COLOURS[str(method)], markersize=4, alpha=0.6, label=str(method))
        low, high = min(ax.get_xlim()[0], ax.get_ylim()[0]), max(ax.get_xlim()[1], ax.get_ylim()[1])
        ax.plot([low, high], [low, high], color="#999999", linewidth=0.8, linestyle=(0, (5, 3)))
        ax.set_xlabel("actual", fontsize=9)
        ax.set_ylabel("estimated", fontsize=9)
        _plain(ax, title)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    _save(figure, path)


def bottleneck(table: pd.DataFrame, path: Path) -> None:
    """Share of the candidates that stay covered, and targets observed, by method."""
    figure = _figure(9.0, 3.6)
    axes = figure.subplots(1, 2)
    known = table.dropna(subset=["share_actual"])
    at = np.arange(len(known))
    axes[0].bar(at - 0.2, known["share_estimated"], 0.38, color=[COLOURS[m] for m in known["method"]], alpha=0.45)
    axes[0].bar(at + 0.2, known["share_actual"], 0.38, color=[COLOURS[m] for m in known["method"]])
    axes[0].set_xticks(at, known["method"], fontsize=8)
    axes[0].set_ylim(0, 1.05)
    _plain(axes[0], "share of candidates covered: estimated (pale), actual")
    axes[1].bar(
        range(len(table)), table["observed"], 0.7, yerr=table["observed_std"], color=[COLOURS[m] for m in table["method"]], **_ERRORS
    )
    axes[1].set_xticks(range(len(table)), table["method"], fontsize=8)
    _plain(axes[1], "targets observed: time average")
    _save(figure, path)


_ERRORS: dict[str, Any] = {"error_kw": {"elinewidth": 1.0, "ecolor": "#222222"}, "capsize": 2.0}
