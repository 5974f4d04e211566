"""The comparison of Skeele (2016), chapter 5, played again: how much more than in hindsight each policy pays.

Run as ``python -m waybound.reports.missions.uncertain_graph_study --out FOLDER [--short]``.

- Random roadmaps (Fig. 5.5, Table 5.3): 20 graphs, 100 draws of their costs, three levels of variance.
- Synthetic rasters in place of the source's aerial images (Fig. 5.9): four scenes.

All policies meet the same graphs and costs. Excess is in percent of the cheapest path in hindsight. Draws on one graph are alike, so
standard errors are those of the graphs' means.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from waybound.instances.atomic import atomic_write

from ....instances.risk.worlds.uncertain_graph import UncertainGraphWorld
from ...plots.risk.uncertain_path import draw_edges, draw_vertices, places
from .._study_command import study_command
from .._study_figures import _figure, _plain, _save
from .._study_tables import markdown, records
from .uncertain_graph import UncertainGraphMission

if TYPE_CHECKING:
    import pandas as pd

METHODS: dict[str, dict[str, Any]] = {
    "rags": {"policy": "rags"},
    "rags-unobserved": {"policy": "rags", "observe": False},
    "a-star": {"policy": "a-star"},
    "greedy": {"policy": "greedy"},
    "d-star-lite": {"policy": "d-star-lite"},
}

COLOURS = {
    "rags": "#332288", "rags-unobserved": "#8877CC", "a-star": "#DDAA33", "greedy": "#CC3377", "d-star-lite": "#117733",
    "hindsight": "#777777",
}  # fmt: skip

MOST = 99.0
"""Percentile at which histograms end: the last bin holds all values beyond."""

STEPS = 60
"""Steps of a run: more than any policy needs on these graphs."""

LEVEL = "level"
"""Column of the variance or the scene."""


@dataclass(frozen=True)
class Size:
    """Size of a study."""

    variances: tuple[float, ...] = (5.0, 10.0, 20.0)
    graphs: int = 20
    draws: int = 100
    scenes: tuple[str, ...] = ("empty", "small-cluster", "cluster", "trees")
    raster_graphs: int = 16
    raster_draws: int = 25


SHORT = Size(variances=(20.0,), graphs=2, draws=3, scenes=("trees",), raster_graphs=1, raster_draws=2)


def plays(levels: Sequence[Any], key: str, graphs: int, draws: int, **settings: Any) -> pd.DataFrame:
    """One row a walk: level, graph, draw, method, cost, hindsight, excess, edges."""
    import pandas as pd

    from waybound import run

    rows = []
    for level in levels:
        for graph in range(1, graphs + 1):
            for draw in range(1, draws + 1):
                for method, how in METHODS.items():
                    log = run("uncertain-graph", steps=STEPS, seed=draw, graph=graph, **{key: level}, **settings, **how)
                    if log.attrs["limit"] == "interrupt":
                        raise KeyboardInterrupt
                    last = log.iloc[-1]
                    if not last["arrived"]:
                        raise AssertionError(f"{method} does not arrive on graph {graph}, draw {draw}")
                    figures = {name: float(last[name]) for name in ("cost", "hindsight", "excess")}
                    rows.append({LEVEL: level, "graph": graph, "draw": draw, "method": method, **figures})
    return pd.DataFrame(rows)


def excess_table(walks: pd.DataFrame) -> pd.DataFrame:
    """Distribution of each method's excess at each level, and how far rags lies above it on the same draws."""
    import pandas as pd

    rows = []
    for level, alike in walks.groupby(LEVEL, sort=False):
        means = alike.pivot_table(index="graph", columns="method", values="excess")
        for method in METHODS:
            own = alike[alike["method"] == method]["excess"]
            apart = means["rags"] - means[method]
            error = float(apart.std(ddof=1)) / math.sqrt(len(apart)) if len(apart) > 1 else math.nan
            quantiles = {f"q{share}": float(own.quantile(share / 100)) for share in (50, 75, 95)}
            rows.append(
                {
                    LEVEL: level, "method": method, "mean": float(own.mean()), **quantiles, "largest": float(own.max()),
                    "optimal": float((own <= 1e-9).mean()), "rags_above": float(apart.mean()), "error": error,
                }
            )  # fmt: skip
    return pd.DataFrame(rows)


def trends(table: pd.DataFrame) -> list[tuple[str, str]]:
    """The source's trends, and the verdict on each."""
    rows = {(row[LEVEL], row["method"]): row for row in records(table)}
    levels = list(dict.fromkeys(level for level, _ in rows))
    verdicts = []
    for other, claim in (("a-star", "rags below A* in the mean"), ("greedy", "rags below greedy"), ("d-star-lite", "rags below D* Lite"),
                         ("rags-unobserved", "observing helps rags")):  # fmt: skip
        said = []
        for level in levels:
            above, error = rows[level, other]["rags_above"], rows[level, other]["error"]
            verdict = "yes" if above < -2 * error else "no" if above > 2 * error else "undecided"
            said.append(f"{level} {verdict} ({above:+.2f} +- {error:.2f} points)")
        verdicts.append((claim, "; ".join(said)))
    tails = [f"{level} {rows[level, 'rags']['q95']:.2f} against {rows[level, 'a-star']['q95']:.2f}" for level in levels]
    verdicts.append(("rags' upper tail, the 95 % quantile, beside A*'s", "; ".join(tails)))
    return verdicts


def draw_boxes(walks: pd.DataFrame, path: Path) -> None:
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


def draw_histograms(walks: pd.DataFrame, path: Path) -> None:
    """Distribution of each method's excess, one row a level."""
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


def draw_walks(path: Path, graph: int = 1, draw: int = 1, **settings: Any) -> None:
    """Walk of each policy on one graph under one draw of its costs, beside the cheapest path in hindsight."""
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


def study(folder: Path, size: Size) -> str:
    """Play everything, write it into ``folder``, and return the summary."""
    roadmaps = plays(size.variances, "variance", size.graphs, size.draws)
    rasters = plays(size.scenes, "scene", size.raster_graphs, size.raster_draws, roadmap="raster-graph", vertices=150)
    text = "# Uncertain graphs: excess over the cheapest path in hindsight, percent\n"
    for name, head, walks in (
        ("roadmaps", f"Random roadmaps: {size.graphs} graphs x {size.draws} draws, by largest variance", roadmaps),
        ("rasters", f"Synthetic rasters: {size.raster_graphs} graphs x {size.raster_draws} draws, by scene", rasters),
    ):
        table = excess_table(walks)
        text += f"\n## {head}\n\n{markdown(table)}\n" + "".join(f"- {what}: {said}\n" for what, said in trends(table))
        atomic_write(folder / f"{name}.csv", table.to_csv(index=False))
        atomic_write(folder / f"walks_{name}.csv", walks.to_csv(index=False))
        draw_boxes(walks, folder / f"{name}.png")
        draw_histograms(walks, folder / f"histograms_{name}.png")
    last = roadmaps[(roadmaps[LEVEL] == size.variances[-1]) & (roadmaps["method"] == "a-star")]
    worst = last.nlargest(1, "excess").iloc[0]
    draw_walks(folder / "walks.png", int(worst["graph"]), int(worst["draw"]), variance=size.variances[-1])
    atomic_write(folder / "summary.md", text)
    return text


def main(arguments: list[str] | None = None) -> int:
    """Play the study and print its summary."""
    return study_command(
        "uncertain_graph_study", __doc__, lambda folder, short: study(folder, SHORT if short else Size()), arguments, "walks"
    )


if __name__ == "__main__":
    sys.exit(main())
