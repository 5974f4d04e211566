"""Walks through graphs of uncertain costs, after Skeele (2016), chapter 5: how much more than in hindsight each policy pays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.risk.worlds.uncertain_graph import UncertainGraphWorld
from ...missions.risk.uncertain_graph import UncertainGraphMission
from ...plots.drawing import plain
from ...plots.risk.uncertain_path import draw_edges, draw_vertices, places
from ..findings import LOST, Finding
from ..frames import HALF, frame_table, framed, mean_interval, play
from ..processes import Done, spread
from ..study import Figure, Report, StudySetting, study

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

VARIANCES, SCENES = (5.0, 10.0, 20.0), ("empty", "small-cluster", "cluster", "trees")
"""Largest variances of the source, and scenes like those of its images."""

ALL_ALIKE = "all policies meet the same graphs and costs; excess in percent of the cheapest path in hindsight, intervals over graphs"


def walked(setting: StudySetting, key: str, levels: Sequence[Any], draws: int, **settings: Any) -> Done:
    """Walks of all policies on every graph, level and draw; ``setting.instances`` graphs."""
    columns = ("cost", "hindsight", "excess", "arrived")
    tasks = [
        (
            "uncertain-graph", METHODS, STEPS, draw, {"graph": graph, key: level, **settings}, {LEVEL: level, "graph": graph},
            columns, True,
        )
        for graph in setting.seeds for draw in range(1, draws + 1) for level in levels
    ]  # fmt: skip
    done = spread(play, tasks, setting.jobs, setting.told, lambda task: f"graph {task[5]['graph']}, draw {task[3]}")
    lost = [row for row in done.rows if not row["arrived"]]
    if lost:
        raise AssertionError(f"{lost[0]['method']} does not arrive on graph {lost[0]['graph']}, draw {lost[0]['seed']}")
    return done


@study(
    "uncertain-roadmaps",
    "risk-aware graph search, A*, greedy and D* Lite on random roadmaps of uncertain costs",
    20,
    short=2,
    source="Skeele (2016), section 5.5.1, Fig. 5.5",
    claim="RAGS has the mean of A* with fewer outliers, greedy decays with the variance, and RAGS beats D* in all cases",
)
def uncertain_roadmaps(setting: StudySetting) -> Report:
    levels, draws = (VARIANCES, 100) if setting.full else (VARIANCES[-1:], 3)
    done = walked(setting, "variance", levels, draws)
    return reported("uncertain-roadmaps", uncertain_roadmaps.summary, done, "Fig. 5.5", setting, variance=levels[-1])


@study(
    "uncertain-rasters",
    "the same policies on synthetic images of fields and trees",
    16,
    short=1,
    source="Skeele (2016), sections 5.6 and 5.7, Figs. 5.6 to 5.9",
    claim="the same trends as on random graphs, on graphs made of 64 aerial images",
)
def uncertain_rasters(setting: StudySetting) -> Report:
    scenes, draws = (SCENES, 25) if setting.full else (SCENES[-1:], 2)
    raster = {"roadmap": "raster-graph", "vertices": 150}
    done = walked(setting, "scene", scenes, draws, **raster)
    return reported("uncertain-rasters", uncertain_rasters.summary, done, "Fig. 5.9", setting, scene=scenes[-1], **raster)


def reported(name: str, summary: str, done: Done, figure: str, setting: StudySetting, **drawn: Any) -> Report:
    """The report of a comparison; ``drawn`` are the settings of the graph on which walks are shown."""
    walks = framed(done.rows)
    rows = excess(walks)
    images = "; the aerial images and the sizes of the filters are not published, and scenes are drawn here" if "scene" in drawn else ""
    claims = [Finding(f"{figure}: excess over hindsight", "plotted", "see the table", LOST, f"the plots' numbers are lost{images}")]
    last = next(reversed(drawn.values())) if "scene" not in drawn else drawn["scene"]
    worst = walks[(walks["method"] == "a-star") & (walks[LEVEL] == last)].nlargest(1, "excess")
    shown = [walks_figure(name, int(worst["graph"].iloc[0]), int(worst["seed"].iloc[0]), **drawn)] if len(worst) else []
    return Report(
        name, summary, frame_table("Excess, percent: distribution of each policy, and how far rags lies above it on the same graphs", rows),
        tuple(rows), tuple(done.rows), figures=(boxes_figure(name, walks), histograms_figure(name, walks), *shown), notes=(ALL_ALIKE,),
        findings=(*claims, *findings(walks, rows)), **done.progress(),
    )  # fmt: skip


def excess(walks: pd.DataFrame) -> list[dict[str, Any]]:
    """Distribution of each method's excess at each level, and how far rags lies above it on the same draws."""
    rows = []
    for level, alike in walks.groupby(LEVEL, sort=False):
        means = alike.pivot_table(index="graph", columns="method", values="excess")
        for method in METHODS:
            own = alike[alike["method"] == method]["excess"]
            mean, half = mean_interval(means[method])
            above, above_half = mean_interval(means["rags"] - means[method])
            rows.append(
                {
                    LEVEL: level, "method": method, "walks": len(own), "mean": mean, f"mean{HALF}": half,
                    **{f"q{share}": float(own.quantile(share / 100)) for share in (50, 75, 95)}, "largest": float(own.max()),
                    "optimal": float((own <= 1e-9).mean()), "rags_above": above, f"rags_above{HALF}": above_half,
                }
            )  # fmt: skip
    return rows


def findings(walks: pd.DataFrame, rows: Sequence[dict[str, Any]]) -> list[Finding]:
    """The source's claims at each level."""
    known = {(row[LEVEL], row["method"]): row for row in rows}
    levels = list(dict.fromkeys(level for level, _ in known))
    found = []
    for other, what, claim in (("a-star", "mean of rags against A*", "no higher"), ("greedy", "mean of rags against greedy", "lower"),
                               ("d-star-lite", "mean of rags against D* Lite", "lower")):  # fmt: skip
        for level in levels:
            row = known[level, other]
            why = "an exact D* replans on the whole graph, rags on its first set of paths" if other == "d-star-lite" else "too few graphs"
            found.append(
                Finding.of_lead(f"{what}, {_name(level)}", claim, -row["rags_above"], row[f"rags_above{HALF}"], "points in favour", why)
            )
    for level, alike in walks.groupby(LEVEL, sort=False):
        tails = alike.groupby(["graph", "method"])["excess"].quantile(0.95).unstack()
        lead, half = mean_interval(tails["a-star"] - tails["rags"])
        found.append(
            Finding.of_lead(f"95 % quantile of each graph, {_name(level)}", "fewer outliers than A*", lead, half, "points in favour")
        )
    if len(levels) > 1 and all(isinstance(level, float) for level in levels):
        greedy = walks[walks["method"] == "greedy"].pivot_table(index="graph", columns=LEVEL, values="excess")
        lead, half = mean_interval((greedy[levels[-1]] - greedy[levels[0]]).dropna())
        what = f"greedy with variances to {levels[-1]:g} against {levels[0]:g}"
        found.append(Finding.of_lead(what, "gets worse", lead, half, "points", "its detours cost more than variances do"))
    return found


def boxes_figure(name: str, walks: pd.DataFrame) -> Figure:
    """Excess of each method: quartiles, whiskers at 5 and 95 percent, means as diamonds; the axis is linear up to 1 percent."""
    levels = list(dict.fromkeys(walks[LEVEL]))

    def draw(figure: Any) -> None:
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
            plain(ax, _name(level))
        axes[0].set_ylabel("percent above the cheapest path in hindsight", fontsize=9)

    return Figure(name, draw, (max(3.4 * len(levels), 6.0), 3.8))


def histograms_figure(name: str, walks: pd.DataFrame) -> Figure:
    """Distribution of each method's excess, one row per level."""
    levels = list(dict.fromkeys(walks[LEVEL]))

    def draw(figure: Any) -> None:
        axes = np.atleast_2d(figure.subplots(len(levels), len(METHODS), sharey=True))
        for row, level in zip(axes, levels, strict=True):
            for ax, method in zip(row, METHODS, strict=True):
                values = walks[(walks[LEVEL] == level) & (walks["method"] == method)]["excess"].to_numpy()
                most = max(float(np.percentile(values, MOST)), 1e-9)
                shares = np.full(len(values), 1.0 / len(values))
                ax.hist(np.minimum(values, most), bins=30, range=(0.0, most), weights=shares, color=COLOURS[method])
                ax.axvline(values.mean(), color="#222222", linewidth=0.9)
                plain(ax, method)
            row[0].set_ylabel(f"share of walks,\n{_name(level)}", fontsize=9)
        for ax in axes[-1]:
            ax.set_xlabel("excess, percent", fontsize=9)

    return Figure(f"{name}-histograms", draw, (12.0, 1.0 + 1.9 * len(levels)))


def walks_figure(name: str, graph: int, seed: int, **settings: Any) -> Figure:
    """Walk of each policy on one graph under one draw of its costs, beside the cheapest path in hindsight."""

    def draw(figure: Any) -> None:
        shown = {method: how for method, how in METHODS.items() if method != "rags-unobserved"}
        axes = figure.subplots(1, len(shown), sharex=True, sharey=True)
        best = _walked("hindsight", graph, seed, **settings)
        at = places(best.graph)
        for ax, (method, how) in zip(axes, shown.items(), strict=True):
            world = _walked(how["policy"], graph, seed, **settings)
            draw_edges(ax, world.graph, at)
            for lines in ax.collections:
                lines.set_rasterized(True)  # thousands of edges: as vectors they would be most of a page
            ax.plot(*at[best.path].T, color=COLOURS["hindsight"], linewidth=5.0, alpha=0.45, solid_capstyle="round", label="in hindsight")
            ax.plot(*at[world.path].T, color=COLOURS[method], linewidth=2.0, solid_capstyle="round")
            draw_vertices(ax, world.graph, at)
            ax.set_aspect("equal")
            ax.axis("off")
            ax.set_title(f"{method}: {world.cost:.1f}, {world.metrics()['excess']:.1f} % above", loc="left", fontsize=10)

    return Figure(f"{name}-walks", draw, (12.0, 4.0))


def _walked(policy: str, graph: int, seed: int, **settings: Any) -> UncertainGraphWorld:
    mission = UncertainGraphMission()
    world = mission.world(seed, graph=graph, **settings)
    go = mission.policies()[policy]
    for _ in range(STEPS):
        world.step(go(world.observe()))
    return world


def _name(level: Any) -> str:
    return f"variances to {level:g}" if isinstance(level, float) else str(level)
