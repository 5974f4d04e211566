"""Figures of the orchard study."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from .._study_figures import _figure, _plain, _save

if TYPE_CHECKING:
    import pandas as pd

COLOURS = {"greedy+baseline": "#777777", "auction+baseline": "#DDAA33", "greedy+proposed": "#33AADD", "auction+proposed": "#332288"}

EFFECTS = {
    "auction (baseline)": "#DDAA33", "auction (proposed)": "#CC3377", "delivery (greedy)": "#33AADD", "delivery (auction)": "#117733",
    "both": "#332288",
}  # fmt: skip


def ablation(steps: pd.DataFrame, effects: pd.DataFrame, path: Path) -> None:
    """One row a number of groups: steps of each method over the number of robots, and what each change saves; bands are the intervals."""
    from matplotlib.ticker import NullFormatter, ScalarFormatter

    groups = sorted(set(steps["groups"]))
    figure = _figure(11.0, 0.6 + 3.6 * len(groups))
    axes = figure.subplots(len(groups), 2, squeeze=False, sharex=True)
    for (left, right), count in zip(axes, groups, strict=True):
        own = steps[steps["groups"] == count]
        for method, colour in COLOURS.items():
            line = own[own["method"] == method]
            left.plot(line["robots"], line["steps"], color=colour, linewidth=1.6, label=method)
            left.fill_between(
                line["robots"],
                line["steps"] - line["steps_half"],
                line["steps"] + line["steps_half"],
                color=colour,
                alpha=0.25,
                linewidth=0,
            )
        floor = own.drop_duplicates("robots")
        left.plot(floor["robots"], floor["least"], color="#222222", linewidth=0.9, linestyle=(0, (5, 3)), label="no rule can take fewer")
        left.set_yscale("log")
        left.set_yticks([100, 200, 400, 800])
        left.yaxis.set_major_formatter(ScalarFormatter())
        left.yaxis.set_minor_formatter(NullFormatter())
        left.set_ylabel("steps until all bins are home", fontsize=9)
        _plain(left, f"{count} groups: steps")
        saved = effects[effects["groups"] == count]
        for effect, colour in EFFECTS.items():
            right.plot(saved["robots"], saved[effect], color=colour, linewidth=1.6, label=effect)
            low, high = (saved[effect] + sign * saved[f"{effect} half"] for sign in (-1, 1))
            right.fill_between(saved["robots"], low, high, color=colour, alpha=0.25, linewidth=0)
        right.axhline(0.0, color="#999999", linewidth=0.8)
        right.set_ylabel("percent of the baseline's steps saved", fontsize=9)
        _plain(right, f"{count} groups: what each change saves on the same day")
    for ax in axes[-1]:
        ax.set_xlabel("robots", fontsize=9)
        ax.locator_params(axis="x", integer=True)
    axes[0][0].legend(frameon=False, fontsize=8)
    figure.legend(*axes[0][1].get_legend_handles_labels(), loc="outside lower right", ncols=len(EFFECTS), frameon=False, fontsize=8)
    _save(figure, path)
