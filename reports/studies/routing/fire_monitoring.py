"""Fire monitoring after Skeele (2016), chapter 3: weighted greedy against circling, tours, exact patrols in the loop, and the optimum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ...missions.routing.fire_monitoring import FireMonitoring, least_possible
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import HALF, apart, completed, decision_times, film_of, frame_table, framed, intervals, mean_interval, times_apart
from ..processes import spread
from ..study import Clip, Fault, Report, StudySetting, figure, study, thinned

if TYPE_CHECKING:
    import pandas as pd

THRESHOLDS = (0.25, 0.35, 0.45)
"""beta of Figs. 3.4 to 3.6."""

PAIR: dict[str, dict[str, Any]] = {"weighted-greedy": {"policy": "weighted-greedy"}, "circling": {"policy": "circling"}}

LOOPS: dict[str, dict[str, Any]] = {
    "exact patrol": {"policy": "exact"},
    "weighted-greedy": {"policy": "weighted-greedy"},
    "tour, highs": {"solver": "highs", "decide": "on-arrival"},
    "tour, pure-greedy": {"heuristic": "pure-greedy", "decide": "on-arrival"},
}
"""Deciders besides circling, on moving fires at beta 0.35 and over fronts that stand still."""

STILL: dict[str, Any] = {"still": True, "hotspots": 5, "radius": 0.0}

ALPHAS = (0.0, 0.25, 1.0, 2.0)

EVERY = 5
"""Steps between points of the curves of J."""

NOTES = (
    "J is the sum over live hotspots of the longest that each has waited, in steps; its mean over a run, then over fires",
    "intervals are of confidence 95 % over fires; all methods meet the same ones, since a fire takes no notice of the aircraft",
    "still fronts: J after 120 steps (40 in the short form); hotspots must be reached; the best patrol along cheapest paths is proved",
    "straight: the optimum of flights that may cross the fire at no cost, a bound for every policy",
)


def monitored(seed: int, full: bool) -> list[dict[str, Any]]:
    """All runs over one fire: a task for ``spread``."""
    steps, horizon = (200, 120) if full else (40, 40)
    plays: list[tuple[str, str, dict[str, Any]]] = [
        (f"{beta:g}", method, {**how, "threshold": beta}) for beta in THRESHOLDS for method, how in PAIR.items()
    ]
    if full:
        plays += [("no wind", method, {**how, "elongation": 0.0}) for method, how in PAIR.items()]
        plays += [("alpha", f"{alpha:g}", {"policy": "weighted-greedy", "threshold": 0.35, "alpha": alpha}) for alpha in ALPHAS]
    plays += [("loop", method, {**how, "threshold": 0.35}) for method, how in LOOPS.items()]
    plays += [("still", method, {**STILL, "look_ahead": horizon, **how}) for method, how in LOOPS.items()]
    rows = []
    for kind, method, how in plays:
        mission = FireMonitoring()
        log = completed(mission, seed=seed, steps=horizon if kind == "still" else steps, **how)
        row = {
            "kind": kind, "method": method, "seed": seed, "waits": float(log["worst_waits"].mean()),
            "final": float(log["worst_waits"].iloc[-1]), "hotspots": float(log["hotspots"].mean()),
            "over_fire": float(log["over_fire"].iloc[-1]), "curve": log["worst_waits"].iloc[EVERY - 1 :: EVERY].tolist(),
            **decision_times(log),
        }  # fmt: skip
        rows.append(row)
    return [*rows, {"kind": "bound", "method": "best", "seed": seed, **optimum(seed, horizon)}]


def optimum(seed: int, steps: int) -> dict[str, float]:
    """J of the best patrol of the front of this seed that stands still, along cheapest paths and straight; NaN where it took too long."""
    mission = FireMonitoring()
    world = mission.world(seed, **STILL)
    o = world.observe()
    straight = least_possible(o.hotspots, o.place, o.speed, STILL["radius"], steps)
    total, _, planned = mission.patrol(o, steps)
    return {"patrol": float(total) if planned == steps else math.nan, "straight": float(straight) if straight >= 0 else math.nan}


@study(
    "fire-monitoring",
    "monitoring of hotspots of a spreading fire: weighted greedy against circling, tours and exact patrols, and the optimum",
    100,
    short=2,
    source="Skeele (2016), chapter 3, Figs. 3.4 to 3.6",
    claim="weighted greedy keeps J below that of circling the perimeter, for each threshold of intensity",
)
def fire_monitoring(setting: StudySetting) -> Report:
    tasks = [(seed, setting.full) for seed in setting.seeds]
    done = spread(monitored, tasks, setting.jobs, setting.told, lambda task: f"seed {task[0]}")
    observed, times = times_apart(done.rows)
    table = framed(observed)
    rows, faults = means(table), broken_bounds(table)
    played = film_of(FireMonitoring(), setting.seed, policy="weighted-greedy", steps=150)
    return Report(
        "fire-monitoring", fire_monitoring.summary, frame_table("Moving fires: means of J, its end, and points lost", rows), tuple(rows),
        tuple(observed), thinned(faults), len(faults), figures=(curves(table),), notes=NOTES, findings=tuple(findings(table)),
        further=(frame_table("Fronts that stand still: J, and percent above the best patrol", still_means(table)), times),
        clips=(Clip(lambda: played, "weighted greedy returns to the hotspots of a fire that the wind drives"),), **done.progress(),
    )  # fmt: skip


def means(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Each method on moving fires; ``lost`` is how far its mean J lies above that of weighted greedy, or of the exact patrol, in steps."""
    rows: list[dict[str, Any]] = []
    moving = table[~table["kind"].isin(["still", "bound"])]
    for (kind, method), own in moving.groupby(["kind", "method"], sort=False):
        row: dict[str, Any] = {"beta or setting": kind, "decided by": method, "runs": len(own)}
        row |= intervals(own, ("waits", "final", "hotspots", "over_fire"))
        if kind == "loop":
            row["lost"], row[f"lost{HALF}"] = apart(moving[moving["kind"] == "loop"], "waits", str(method), "exact patrol")
        rows.append(row)
    return rows


def against_best(table: pd.DataFrame) -> pd.DataFrame:
    """Runs over fronts that stand still, with percent above the best patrol and above straight flights."""
    best = table[table["kind"] == "bound"].set_index("seed")
    still = table[table["kind"] == "still"].copy()
    for name in ("patrol", "straight"):
        still[name] = 100.0 * (still["final"] / still["seed"].map(best[name]) - 1.0)
    return still


def still_means(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Each method over fronts that stand still."""
    shown = {"final": "J", "patrol": "above the best patrol", "straight": "above straight"}
    still = against_best(table).rename(columns=shown)
    return [
        {"decided by": method, "runs": len(own), **intervals(own, shown.values())} for method, own in still.groupby("method", sort=False)
    ]


def broken_bounds(table: pd.DataFrame) -> list[Fault]:
    """Runs that beat the proved bound, and exact patrols that do not end as planned."""
    faults = []
    for row in against_best(table).to_dict("records"):
        where = f"seed {row['seed']}, {row['method']}"
        if row["straight"] < -1e-9:
            faults.append(Fault("bound", f"{where}: J of {row['final']:g} is below the bound", None, "bound"))
        if row["method"] == "exact patrol" and abs(row["patrol"]) > 1e-9:
            faults.append(Fault("answer", f"{where}: J of {row['final']:g} is not that of the plan", None, "patrol"))
    return faults


UNLIKE = "the seven fires are lost, and ours are synthetic"


def findings(table: pd.DataFrame) -> list[Finding]:
    """The source's claims, by pairs of the same fires; and what planning loses, which it does not ask."""
    found = [Finding("Figs. 3.4 to 3.6: J over time", "plotted", "see the figure", LOST, "the plots' numbers and the fires are lost")]
    sparse, kinds = table[table["kind"] == "0.45"], table["kind"].unique()
    for beta in (*(f"{beta:g}" for beta in THRESHOLDS), "no wind"):
        if beta in kinds:
            own = table[table["kind"] == beta]
            lead, half = apart(own, "waits", "circling", "weighted-greedy")
            what = f"beta {beta}" if beta != "no wind" else "no wind, beta 0.25, where the hotspots lie all around"
            found.append(Finding.of_lead(f"J of circling above that of weighted greedy, {what}", "above", lead, half, "steps", UNLIKE))
    dense = table[table["kind"] == "0.25"]
    fewer = (dense.groupby("seed")["hotspots"].mean() - sparse.groupby("seed")["hotspots"].mean()).dropna()
    found.append(Finding.of_lead("hotspots at beta 0.25 above those at 0.45", "more", *mean_interval(fewer)))
    for method in PAIR if table["seed"].nunique() > 2 else ():  # two lie equally far from their mean
        spreads = [own[own["method"] == method].set_index("seed")["waits"] for own in (sparse, dense)]
        wider = (spreads[0] - spreads[0].mean()).abs() - (spreads[1] - spreads[1].mean()).abs()
        why = "J itself is smaller where there are fewer hotspots"
        found.append(
            Finding.of_lead(f"deviation of J between fires, beta 0.45 above 0.25, {method}", "larger", *mean_interval(wider), "steps", why)
        )
    loops, still = table[table["kind"] == "loop"], against_best(table)
    for method in list(LOOPS)[1:]:
        why = "the exact patrol holds hotspots for fixed, and they move"
        lead, half = apart(loops, "waits", method, "exact patrol")
        found.append(Finding.of_lead(f"moving fires: J of {method} above the exact patrol", "not in the source", lead, half, "steps", why))
        lead, half = mean_interval(still[still["method"] == method]["patrol"].dropna())
        found.append(Finding.of_lead(f"still fronts: J of {method} above the best patrol", "not in the source", lead, half, "%"))
    return found


@figure("fire-monitoring", 10.0, 3.6)
def curves(figure: Any, table: pd.DataFrame) -> None:
    """J over time, mean and one standard error over fires, for each threshold: the counterpart of Figs. 3.4 to 3.6."""
    axes = figure.subplots(1, len(THRESHOLDS), sharey=True)
    for ax, beta in zip(axes, THRESHOLDS, strict=True):
        for colour, method in zip(COLOURS, PAIR, strict=False):
            own = table[(table["kind"] == f"{beta:g}") & (table["method"] == method)]["curve"]
            _band(ax, own.tolist(), colour, method)
        ax.set_xlabel(f"step, beta {beta:g}", fontsize=9)
        plain(ax, "J, steps" if beta == THRESHOLDS[0] else "")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False, fontsize=9)


def _band(ax: Any, runs: Sequence[Sequence[float]], colour: str, label: str) -> None:
    import numpy as np

    length = min(map(len, runs))  # a fire that has burnt out ends its run
    values = np.array([run[:length] for run in runs])
    at, mean = EVERY * np.arange(1, length + 1), values.mean(axis=0)
    error = values.std(axis=0, ddof=1) / np.sqrt(len(values)) if len(values) > 1 else 0.0 * mean
    ax.plot(at, mean, color=colour, label=label)
    ax.fill_between(at, mean - error, mean + error, color=colour, alpha=0.2, linewidth=0)
