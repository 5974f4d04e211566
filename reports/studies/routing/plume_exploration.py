"""Plume exploration after Sung (2019), chapter 4: times and bounds, what of the bounds is true, and what planning in the loop loses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ....solving.request import Request
from ....solving.solve import solve
from ...missions.routing.plume_exploration import PlumeExploration, covering, lawn_mower
from ...missions.running import run
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import HALF, completed, decision_times, film_of, frame_table, framed, loop_means, mean_interval, times_apart
from ..processes import called, spread
from ..study import Clip, Fault, Report, StudySetting, figure, study, thinned
from .plume_bounds import longest_time, proved_ratio, shortest_time

if TYPE_CHECKING:
    import pandas as pd

SWEEPS: dict[str, tuple[float, ...]] = {
    "cells": (40, 80, 120, 160, 200),
    "robots": (1, 2, 4, 10, 20, 40),
    "speed": (1.5, 2.0, 2.5, 3.0, 5.0),
}
"""Levels around 120 cells, 20 robots and a speed of 2.5 times that of the plume: the source's defaults; its other levels are lost."""

LOOPS: dict[str, dict[str, Any]] = {
    "exact": {"solver": "branch-price-cut"},
    "greedy-assignment": {"heuristic": "greedy-assignment"},
    "depth-first": {"policy": "depth-first"},
    "lawn-mower": {"policy": "lawn-mower"},
}
"""Deciders on small plumes; the lawn mower is told a rectangle around the plume."""

LOOPED = "Small plumes: means, percent above the shortest exploration in hindsight, and points lost against exact plans"

NOTES = (
    "plumes grow by cells drawn evenly beside those before: the source's generator is not described",
    "intervals are of confidence 95 % over plumes; all methods meet the same ones",
    "the lawn mower is told the rectangle around the plume; its transit does not count in sweeps, and does on small plumes",
)

LABELS = ("depth first, with its range", "upper bound (4.5)", "lower bound (4.8)", "lawn mower, no bound")

UNSHARED = "the way to the first branches is not shared: the time of 20 robots has a part that does not grow with the cells"

SMALL: dict[str, Any] = {"cells": 14, "robots": 3}


def swept(seed: int, key: str, level: float) -> list[dict[str, Any]]:
    """A depth-first exploration, and its bounds: a task for ``spread``."""
    mission = PlumeExploration()
    settings: dict[str, Any] = {key: level if key == "speed" else int(level)}
    log = run(mission, policy="depth-first", seed=seed, **settings)
    w, tree = mission.played, mission.tree
    size, wind = (len(w.cells), len(w.robots)), math.hypot(*w.drift)
    row = {
        "sweep": key, "level": level, "seed": seed, "time": float(log["clock"].iloc[-1]), "finished": float(log["finished"].iloc[-1]),
        "longest": longest_time(size[0], tree.depth, size[1], w.speed, wind), "shortest": shortest_time(*size, w.speed, wind),
        "lawn_mower": lawn_mower(w.observe().box, size[1], w.speed, w.drift)[1],
    }  # fmt: skip
    return [row]


def looped(seed: int) -> list[dict[str, Any]]:
    """All of ``LOOPS`` on one small plume, and its shortest exploration: a task for ``spread``."""
    rows: list[dict[str, Any]] = []
    mission = PlumeExploration()
    for method, how in LOOPS.items():
        log = completed(mission, seed=seed, **SMALL, **how)
        rows.append(
            {"method": method, "seed": seed, "time": float(log["clock"].iloc[-1]), "finished": float(log["finished"].iloc[-1]),
             **decision_times(log)}
        )  # fmt: skip
    w = mission.played
    whole = covering(w.start, [(w.start, 0.0)] * len(w.robots), sorted(w.cells - {w.start}), w.speed, w.drift, "hindsight")
    best = solve(whole, Request(solver="branch-price-cut", time_limit=60.0))
    assert isinstance(best.objective, float) and isinstance(best.bound, float)
    ratio = proved_ratio(len(w.robots), w.speed, math.hypot(*w.drift))
    known = {"hindsight": best.objective, "bound": best.bound, "proved_ratio": ratio}
    return [{**row, **known, "above": 100.0 * (float(row["time"]) / best.objective - 1.0)} for row in rows]


@study(
    "plume-exploration",
    "depth-first exploration of drifting plumes: times, bounds, and planning in the loop against hindsight",
    100,
    short=6,
    source="Sung (2019), chapter 4, Fig. 4.7, lemmas 3 to 6, theorems 4 and 5",
    claim="times stay well below the upper bound, grow with the plume and fall with robots and speed; a competitive ratio O(R / log R)",
)
def plume_exploration(setting: StudySetting) -> Report:
    levels = [(key, level) for key, own in SWEEPS.items() for level in own[:: 1 if setting.full else 2]]
    tasks = [(looped, seed) for seed in setting.seeds] + [(swept, seed, *one) for seed in setting.seeds for one in levels]
    done = spread(called, tasks, setting.jobs, setting.told, lambda t: f"seed {t[1]}: {t[2:] or 'loops'}")
    played_rows, times = times_apart(done.rows)
    loops = framed(played_rows, "method")
    sweeps = framed(played_rows, "sweep")
    rows, faults = means(sweeps), broken_bounds(played_rows)
    played = film_of(PlumeExploration(), setting.seed, robots=6, cells=60, policy="depth-first")
    return Report(
        "plume-exploration", plume_exploration.summary, frame_table("Depth-first exploration: means, and bounds", rows), tuple(rows),
        tuple(played_rows), thinned(faults), len(faults), figures=(sweeps_figure(sweeps),) if len(sweeps) else (), notes=NOTES,
        findings=tuple(findings(sweeps)), further=(frame_table(LOOPED, loop_means(loops, ("time", "above"), "above", most=False)), times),
        clips=(Clip(lambda: played, "six robots explore a plume of 60 cells depth first"),), **done.progress(),
    )  # fmt: skip


def means(sweeps: pd.DataFrame) -> list[dict[str, Any]]:
    """Each level of each sweep: time with its interval, least and largest, and means of the bounds."""
    rows: list[dict[str, Any]] = []
    for (key, level), own in sweeps.groupby(["sweep", "level"], sort=False) if len(sweeps) else ():
        time, half = mean_interval(own["time"])
        bounds = {name: float(own[name].mean()) for name in ("longest", "shortest", "lawn_mower")}
        row = {"sweep": key, "level": level, "runs": len(own), "time": time, f"time{HALF}": half}
        rows.append({**row, "least": float(own["time"].min()), "most": float(own["time"].max()), **bounds})
    return rows


def broken_bounds(rows: Sequence[dict[str, Any]]) -> list[Fault]:
    """Explorations that do not end, or that contradict lemma 3, lemma 4, the proved ratio or the optimum in hindsight."""
    faults = []
    for row in rows:
        where = f"seed {row['seed']}, {row.get('method') or '{sweep} {level:g}'.format(**row)}"
        most = row["longest"] if "sweep" in row else row["proved_ratio"] * row["hindsight"] if row["method"] == "depth-first" else math.inf
        least = row["shortest"] if "sweep" in row else row["bound"]
        if not row["finished"]:
            faults.append(Fault("answer", f"{where}: not explored in full", None, "exploration"))
        elif not least * (1 - 1e-9) <= row["time"] <= most * (1 + 1e-9):
            faults.append(Fault("bound", f"{where}: {row['time']:.9g} is not from {least:.9g} to {most:.9g}", None, "bound"))
    return faults


def findings(sweeps: pd.DataFrame) -> list[Finding]:
    """The source's trends, each by pairs of the same seeds."""
    found = [Finding("Fig. 4.7: times and bounds", "plotted", "see the table", LOST, "the plots' numbers and the generator are lost")]
    for key, sign in (("cells", 1), ("robots", -1), ("speed", -1)) if len(sweeps) else ():
        own = sweeps[sweeps["sweep"] == key]
        levels = sorted(own["level"].unique())
        times, longest = (own.pivot_table(index="seed", columns="level", values=name) for name in ("time", "longest"))
        first, last = levels[0], levels[-1]
        said = f"{key} {first:g} to {last:g}"
        found.append(
            Finding.of_lead(f"time, {said}", f"{'grows' if sign > 0 else 'falls'}", *mean_interval(sign * (times[last] - times[first])))
        )
        if key == "cells":
            share, half = mean_interval(times[last] / times[first] / (last / first) - 1.0)
            found.append(Finding.of_near(f"growth of the time, {said}", "in proportion", share, half, 0.1, UNSHARED))
            spreads = (times - times.mean()).abs()
            found.append(Finding.of_lead(f"mean deviation of the time, {said}", "grows", *mean_interval(spreads[last] - spreads[first])))
        elif key == "speed":
            found.append(Finding.of_lead(f"upper bound, {said}", "falls", *mean_interval(longest[first] - longest[last])))
        else:
            rises = int((longest[levels].diff(axis=1) > 1e-9).any(axis=1).sum())
            said_rises = f"at some step for {rises} of {len(longest)} plumes"
            found.append(Finding.of_fact(f"upper bound, {said}", "rises too", said_rises, rises > 0, "falls throughout on so few plumes"))
        room, half = mean_interval(1.0 - own["time"].groupby(own["seed"]).sum() / own["longest"].groupby(own["seed"]).sum())
        found.append(Finding.of_lead(f"time below the upper bound, share of it, {said}", "well below", room, half))
    return found


@figure("plume-exploration", 11.0, 4.0)
def sweeps_figure(figure: Any, sweeps: pd.DataFrame) -> None:
    """Times (mean, least and largest) and bounds over each sweep."""
    axes = figure.subplots(1, len(SWEEPS))
    for ax, key in zip(axes, SWEEPS, strict=True):
        own = sweeps[sweeps["sweep"] == key].groupby("level")
        mean = own.mean(numeric_only=True)
        ax.fill_between(mean.index, own["time"].min(), own["time"].max(), color=COLOURS[0], alpha=0.15, linewidth=0)
        for name, colour, label in zip(("time", "longest", "shortest", "lawn_mower"), COLOURS, LABELS, strict=False):
            ax.plot(mean.index, mean[name], color=colour, marker="o", markersize=3, label=label)
        ax.set_yscale("log")
        ax.set_xlabel(key, fontsize=9)
        plain(ax, "time" if key == "cells" else "")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=9)
