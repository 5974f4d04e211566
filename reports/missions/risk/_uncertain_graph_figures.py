"""Figures of the study on uncertain graphs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.risk.worlds.uncertain_graph import UncertainGraphWorld
from ...plots.risk.uncertain_path import draw_edges, draw_vertices, places
from .._study_figures import _figure, _plain, _save
from .uncertain_graph import UncertainGraphMission
from .uncertain_graph_study import LEVEL, METHODS, STEPS

if TYPE_CHECKING:
    import pandas as pd

COLOURS = {
    "rags": "#332288", "rags-unobserved": "#8877CC", "a-star": "#DDAA33", "greedy": "#CC3377", "d-star-lite": "#117733",
    "hindsight": "#777777",
}  # fmt: skip

MOST = 99.0
"""Percentile at which histograms end: their last bin holds what lies beyond."""


def boxes(walks: pd.DataFrame, path: Path) -> None:
    """Excess of each method: quartiles, whiskers at 5 and 95 percent, means as diamonds; the axis is linear up to 1 percent."""
    figure = _figure(11.0, 3.8)
    levels = list(dict.fromkeys(walks[LEVEL]))
    axes = np.atleast_1d(figure.subplots(1, len(levels), sharey=True))
    most = float(walks.groupby([LEVEL, "method"])["excess"].quantile(0.95).max())
    for ax, level in zip(axes, levels, strict=True):
        own = [walks[(walks[LEVEL] == level) & (walks["method"] == method)]["excess"].to_numpy() for method in METHODS]
        drawn = ax.boxplot(own, whis=(5, 95), showfliers=False, showmeans=True, patch_artist=True, medianprops={"color": "white"})
        for box, mean, method in zip(drawn["boxes"], drawn["means"], METHODS, strict=True):
            box.set(facecolor=COLOURS[method], edgecolor=COLOURS[method])
            mean.set(marker="D", markersize=4, markerfacecolor="white", markeredgecolor="#222222")
        ax.set_yscale("symlog", linthresh=1.0)
        ax.set_ylim(0.0, max(1.5 * most, 1.0))
        ax.set_xticks(range(1, len(METHODS) + 1), list(METHODS), rotation=30, ha="right")
        _plain(ax, _name(level))
    axes[0].set_ylabel("percent above the cheapest path in hindsight", fontsize=9)
    _save(figure, path)


def histograms(walks: pd.DataFrame, path: Path) -> None:
    """How often each method's excess came to how much, one row a level."""
    levels = list(dict.fromkeys(walks[LEVEL]))
    figure = _figure(12.0, 1.0 + 1.9 * len(levels))
    axes = np.atleast_2d(figure.subplots(len(levels), len(METHODS), sharey=True))
    for row, level in zip(axes, levels, strict=True):
        for ax, method in zip(row, METHODS, strict=True):
            values = walks[(walks[LEVEL] == level) & (walks["method"] == method)]["excess"].to_numpy()
            most = max(float(np.percentile(values, MOST)), 1e-9)
            ax.hist(
                np.minimum(values, most), bins=30, range=(0.0, most), weights=np.full(len(values), 1.0 / len(values)), color=COLOURS[method]
            )
            ax.axvline(values.mean(), color="#222222", linewidth=0.9)
            _plain(ax, method)
        row[0].set_ylabel(f"share of walks,\n{_name(level)}", fontsize=9)
    for ax in axes[-1]:
        ax.set_xlabel("excess, percent", fontsize=9)
    _save(figure, path)


def walks(path: Path, graph: int = 1, draw: int = 1, **settings: Any) -> None:
    """What each policy walks on one graph under one draw of its costs, beside the cheapest path in hindsight."""
    figure = _figure(12.0, 4.4)
    shown = {name: how for name, how in METHODS.items() if name != "rags-unobserved"}
    axes = figure.subplots(1, len(shown), sharex=True, sharey=True)
    for ax, (method, how) in zip(axes, shown.items(), strict=True):
        best, world = (_walked(name, graph, draw, **settings) for name in ("hindsight", how["policy"]))
        at = places(world.graph)
        draw_edges(ax, world.graph, at)
        ax.plot(*at[best.path].T, color=COLOURS["hindsight"], linewidth=5.0, alpha=0.45, solid_capstyle="round", label="in hindsight")
        ax.plot(*at[world.path].T, color=COLOURS[method], linewidth=2.0, solid_capstyle="round")
        draw_vertices(ax, world.graph, at)
        ax.set_aspect("equal")
        ax.axis("off")
        ax.set_title(f"{method}: {world.cost:.1f}, {world.metrics()['excess']:.1f} % above", loc="left", fontsize=10)
    _save(figure, path)


def _walked(policy: str, graph: int, draw: int, **settings: Any) -> UncertainGraphWorld:
    mission = UncertainGraphMission()
    world = mission.world(draw, graph=graph, **settings)
    go = mission.policies()[policy]
    for _ in range(STEPS):
        world.step(go(world.observe()))
    return world


def _name(level: Any) -> str:
    return f"variances to {level:g}" if isinstance(level, float) else str(level)
