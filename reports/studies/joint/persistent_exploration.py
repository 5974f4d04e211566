"""Persistent exploration after Mitchell (2020), chapters 3 and 6: approaches, parameters, and what greedy assignment loses in the loop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.routing.problem import RoutingProblem
from ....instances.routing.occupancy_maps import DecayMap
from ....instances.worlds import World
from ....solving.request import Request
from ....solving.solve import solve
from ...missions.joint.persistent_exploration import PersistentExploration
from ...missions.mission import Decision
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import apart, completed, decision_times, film_of, frame_table, framed, mean_interval, method_means, times_apart
from ..processes import spread
from ..study import Clip, Fault, Report, StudySetting, figure, study, thinned

if TYPE_CHECKING:
    import pandas as pd

PLACE: dict[str, Any] = {"rows": 25, "columns": 25, "robots": 2}

SYSTEM: dict[str, Any] = {"heuristic": "greedy-assignment"}

CHANGES: dict[str, Any] = {"shortest": 600.0, "longest": 600.0, "period": 100.0}
"""Settings of the runs after Mitchell (2020), chapter 3. A cell that changes does so every 300 s. The robots are not told: their estimate
of this time begins at 100 s, and they correct it from what they see."""

RUNS: dict[str, dict[str, Any]] = {
    "system": SYSTEM,
    "pure greedy, 0": {"policy": "pure-greedy", "distance_weight": 0.0},
    "pure greedy, 1": {"policy": "pure-greedy", "distance_weight": 1.0},
    "one waypoint": {**SYSTEM, "waypoints": 1},
    "one robot": {**SYSTEM, "robots": 1},
    "no misfit": {**SYSTEM, "misfit_weight": 0.0},
    "misfit only": {**SYSTEM, "utility": "chi-square"},
    "reach 15 m": {**SYSTEM, "reach": 15.0},
    "12 beams": {**SYSTEM, "beams": 12},
    "speed 3.3 m/s": {**SYSTEM, "speed": 10.0 / 3.0},
    "endurance 900 s": {**SYSTEM, "endurance": 900.0},
    "advance 120 s": {**SYSTEM, "advance": 120.0},
    "independent": {**SYSTEM, "phases": "independent"},
    "60 % change": {**SYSTEM, "dynamic": 0.6},
    "decay": {**SYSTEM, "model": "decay", **CHANGES},
    "static": {**SYSTEM, "model": "static", **CHANGES},
}
"""One parameter changed at a time, as in Tables 6.3 to 6.8, scaled; ``decay`` and ``static`` are the two maps of chapter 3."""
SHORT = ("system", "pure greedy, 1", "one robot", "decay", "static")

LOOPS: dict[str, dict[str, Any]] = {"exact": {"solver": "cpsat"}, "greedy-assignment": SYSTEM}

SELECTED = 4  # waypoints of a round in ``LOOPS``: each round is solved to the optimum

MEASURES = ("entropy", "divergence", "late", "missed", "unobserved", "converged", "aloft", "crossed")

NOTES = (
    "means over the last third of a run, unobserved, crossed and converged of the whole; intervals are of confidence 95 % over worlds",
    "all runs of a seed meet the same changes; a place of 50 x 50 m, two robots of 2 m/s, 1,200 s",
    "converged: first second with no more than 1.1 times the entropy of the last third; late: percent of the period since a change",
    "lost: percent of the rewards of plans below those of the best for the same waypoints, which are proved; longer: of the longest routes",
    "gap: percent by which selections of waypoints may be below the best ones, by the largest gains that are left",
)


class Examined(PersistentExploration):
    """The mission with rewards and longest routes of its plans, and those of the best plans for the same problems."""

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        sums = np.zeros(5)
        for d in decisions:
            if isinstance(d.problem, RoutingProblem) and d.solution is not None:
                own = d.solution
                proved = own if own.status == "optimal" else solve(d.problem, Request(solver="cpsat", time_limit=60.0, bound_time=0.0))
                assert isinstance(proved.objective, list) and isinstance(own.objective, list)
                sums += [*own.objective, *proved.objective, proved.status != "optimal"]
        names = ("collected", "longest", "best", "shortest", "unproved")
        return {**super().measures(decisions, world), **dict(zip(names, sums.tolist(), strict=True))}


def figures_of(log: pd.DataFrame) -> dict[str, float]:
    """Measures of a run, by its log."""
    tail = log.iloc[-(len(log) // 3) :]
    row = {key: float(tail[key].mean()) for key in ("entropy", "divergence", "late", "missed")}
    below = log["clock"][log["entropy"] <= 1.1 * row["entropy"]]
    whole = {
        "unobserved": float(log["unobserved"].iloc[-1]),
        "crossed": float(log["crossed"].iloc[-1]),
        "aloft": float(log["aloft"].mean()),
    }
    return {**row, **whole, "converged": float(below.iloc[0]), "robots_lost": float(log["lost"].iloc[-1])}


def explored(seed: int, names: Sequence[str], steps: int) -> list[dict[str, Any]]:
    """Runs of ``RUNS``, and of ``LOOPS`` for a third as long, in one world each: a task for ``spread``."""
    rows: list[dict[str, Any]] = []
    tasks = [("run", name, PersistentExploration(), steps, RUNS[name]) for name in names]
    tasks += [("loop", name, Examined(), steps // 3, {"waypoints": SELECTED, **how}) for name, how in LOOPS.items()]
    for kind, name, mission, length, how in tasks:
        log = completed(mission, seed=seed, steps=length, **{**PLACE, **how})
        row: dict[str, Any] = {"kind": kind, "seed": seed, "method": name, **figures_of(log)}
        if kind == "loop":
            row["lost"] = 100.0 * (1.0 - log["collected"].sum() / log["best"].sum())
            row["longer"] = 100.0 * (log["longest"].sum() / log["shortest"].sum() - 1.0)
            row["gap"] = float(log["selection_gap"].mean())
            own = (log["status"] != "optimal")[log["problems"] > 0] if name == "exact" else log["unproved"]
            row["unproved"] = float(own.sum())
        map_ = mission.played.map
        if isinstance(map_, DecayMap) and map_.learning:
            change = np.isfinite(mission.played.terrain.period).ravel()
            seen = (mission.played.ever & ~mission.played.terrain.known).ravel()
            row["learnt"], row["learnt_static"] = (float(np.median(map_.period[seen & part])) for part in (change, ~change))
        rows.append({**row, **decision_times(log)})
    return rows


@study(
    "persistent-exploration",
    "persistent exploration: the system against pure greedy, its parameters, two models of cells, and greedy against exact plans",
    100,
    short=2,
    source="Mitchell (2020), chapters 3 and 6, Tables 6.3 to 6.8",
    claim="the system converges faster, to 59 % of the entropy and 71 % of the divergence of pure greedy; robots count more than waypoints",
)
def persistent_exploration(setting: StudySetting) -> Report:
    names, steps = (tuple(RUNS), 120) if setting.full else (SHORT, 30)
    done = spread(explored, [(seed, names, steps) for seed in setting.seeds], setting.jobs, setting.told, lambda task: f"seed {task[0]}")
    observed, times = times_apart(done.rows)
    table = framed(observed)
    runs, loops = table[table["kind"] == "run"], table[table["kind"] == "loop"]
    rows, faults = method_means(runs, names, MEASURES, "run"), broken(observed)
    looped = method_means(loops, LOOPS, (*MEASURES[:5], "lost", "longer", "gap"), "run")
    played = film_of(PersistentExploration(), setting.seed, steps=40, **SYSTEM, **{**PLACE, "robots": 3})
    return Report(
        "persistent-exploration", persistent_exploration.summary, frame_table("Means of runs", rows), tuple(rows), tuple(observed),
        thinned(faults), len(faults), (runs_figure(runs, names),), NOTES, findings=tuple(findings(runs, loops, names)),
        further=(frame_table(f"{SELECTED} waypoints a round, means", looped), times),
        clips=(Clip(lambda: played, "three robots keep a map up to date: cells told rightly and surely"),), **done.progress(),
    )  # fmt: skip


def broken(rows: Sequence[dict[str, Any]]) -> list[Fault]:
    """Robots that did not come home, and plans of the exact loop, or that greedy ones are held against, that are not proved."""
    told = {"robots_lost": "{:g} robots are lost", "unproved": "{:g} steps have a plan that is not proved"}
    return [
        Fault("answer", f"seed {row['seed']}, {row['method']}: {text.format(row[key])}", None, row["method"])
        for row in rows
        for key, text in told.items()
        if row.get(key, 0.0) > 0
    ]


FRESH = "pure greedy plans with the newest map at every waypoint, and a map this small has no far side to forget"

SATURATED = "a place this small is seen in full anyway"

GAPS = "cells of a block that change together hide each other; single ones leave gaps to look through"

CLAIMS: tuple[tuple[str, str, str, str, str, int, str], ...] = (
    ("Table 6.3: entropy", "below 60 %", "entropy", "system", "pure greedy, 1", -1, FRESH),
    ("Table 6.3: divergence", "71 %", "divergence", "system", "pure greedy, 1", -1, FRESH),
    ("Table 6.3: time to converge", "22 % faster", "converged", "system", "pure greedy, 1", -1, FRESH),
    ("Table 6.3: response", "shorter", "late", "system", "pure greedy, 1", -1, FRESH),
    ("Table 6.3: cells not observed", "fewer", "unobserved", "system", "pure greedy, 1", -1, SATURATED),
    ("Table 6.4: entropy, six waypoints against one", "4 % less", "entropy", "system", "one waypoint", -1, SATURATED),
    ("Table 6.4: entropy, two robots against one", "less", "entropy", "system", "one robot", -1, SATURATED),
    ("Table 6.4: divergence, two robots against one", "less", "divergence", "system", "one robot", -1, SATURATED),
    ("Table 6.4: time to converge, two robots against one", "shorter", "converged", "system", "one robot", -1, SATURATED),
    ("Table 6.5: entropy, advance = horizon", "more", "entropy", "advance 120 s", "system", 1, SATURATED),
    ("Table 6.6: entropy, misfit only against none", "30 % less", "entropy", "misfit only", "no misfit", -1, SATURATED),
    ("Table 6.6: divergence, misfit only against none", "17 % less", "divergence", "misfit only", "no misfit", -1, SATURATED),
    ("Table 6.7: entropy, 5/3 of the speed", "12.5 % less", "entropy", "speed 3.3 m/s", "system", -1, SATURATED),
    ("Table 6.7: divergence, three times the endurance", "4 % less", "divergence", "endurance 900 s", "system", -1, SATURATED),
    ("Table 6.8: entropy, 15 m against 12 m", "less", "entropy", "reach 15 m", "system", -1, SATURATED),
    ("Table 6.8: entropy, 12 beams against 36", "more", "entropy", "12 beams", "system", 1, SATURATED),
    ("6.5: divergence, independent against clustered", "worse", "divergence", "independent", "system", 1, GAPS),
    ("6.5: divergence, 60 % of blocks change against 40 %", "worse", "divergence", "60 % change", "system", 1, SATURATED),
    ("Fig. 3.7: entropy, static against learnt decay", "lower", "entropy", "static", "decay", -1, SATURATED),
    ("Fig. 3.7: divergence, static against learnt decay", "higher", "divergence", "static", "decay", 1, SATURATED),
)  # fmt: skip
"""Claims: text, direction, measure, method, the other, sign, and the reason where it does not come out."""

EARLY = "cells change four times in a run of 1,200 s, and the filter begins at 100 s"

MAPS_LOST = "map, sensor noise, run length and seeds are lost, the source is in space and ours in the plane"


def findings(runs: pd.DataFrame, loops: pd.DataFrame, names: Sequence[str]) -> list[Finding]:
    """Claims by pairs of the same seeds, what is learnt of periods, and what greedy assignment loses."""
    found = [Finding("Tables 3.1 and 6.3 to 6.8: values", "printed", "see the tables", LOST, MAPS_LOST)]
    for what, claim, key, method, other, sign, why in CLAIMS:
        if method in names and other in names:
            lead, half = apart(runs, key, method, other)
            found.append(Finding.of_lead(f"{what}, {'above' if sign > 0 else 'below'} by", claim, sign * lead, half, "", why))
    learnt = runs[runs["method"] == "decay"]
    near = mean_interval(learnt["learnt"] / 300.0 - 1.0)
    found.append(Finding.of_near("Fig. 3.8: learnt period of cells that change every 300 s", "near it", *near, 0.25, EARLY))
    grown = mean_interval(learnt["learnt_static"] - learnt["learnt"])
    found.append(Finding.of_lead("Fig. 3.8: learnt period of static cells, longer by", "grows", *grown, "s"))
    if "endurance 900 s" in names:
        aloft = mean_interval(runs[runs["method"] == "endurance 900 s"]["aloft"] / 2.0 - 1.0)
        found.append(Finding.of_near("Table 6.7: robots in the air, three times the endurance", "2.98 of 3", *aloft, 0.05))
    for key, most in (("entropy", 0.05), ("divergence", 0.1)):
        pairs = loops.pivot_table(index="seed", columns="method", values=key)
        share, half = mean_interval(pairs["greedy-assignment"] / pairs["exact"] - 1.0)
        what = f"Table 6.3: {key}, greedy plans against exact ones"
        found.append(Finding.of_near(what, "within noise", share, half, most, "exact plans are the better ones"))
    return found


@figure("persistent-exploration", 11.0, 4.6)
def runs_figure(figure: Any, runs: pd.DataFrame, names: Sequence[str]) -> None:
    """Entropy, divergence, response and time to converge of each run, with intervals."""
    panels = {
        "entropy": "entropy, bits",
        "divergence": "divergence, bits",
        "late": "late, % of the period",
        "converged": "converged, s",
    }
    axes = figure.subplots(1, len(panels), sharey=True)
    for ax, (key, title) in zip(axes, panels.items(), strict=True):
        for k, name in enumerate(names):
            mean, half = mean_interval(runs[runs["method"] == name][key])
            ax.barh(k, mean, 0.7, xerr=np.nan_to_num(half), color=COLOURS[0 if name == "system" else 1], capsize=2.0)
        plain(ax, "")
        ax.set_xlabel(title, fontsize=9)
    axes[0].set_yticks(range(len(names)), names, fontsize=8)
    axes[0].invert_yaxis()
