"""Exploration under unreliable communication after Skeele (2016), chapter 4: what relays and sacrifices bring, and what planning loses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ....solving.request import Request
from ....solving.solve import solve
from ...missions.routing.unreliable_communication import UnreliableCommunication, hindsight
from ...missions.running import run
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import HALF, apart, completed, decision_times, film_of, frame_table, framed, intervals, loop_means, mean_interval, times_apart
from ..processes import called, spread
from ..study import Clip, Fault, Report, StudySetting, figure, study, thinned

if TYPE_CHECKING:
    import pandas as pd

FLOORS: dict[str, dict[str, Any]] = {"rooms": {"width": 120, "height": 40}, "blocks": {"width": 50, "height": 50}}
"""The source's complex and simple map, of which the sizes alone are known."""

POINTS = ((2, 120), (4, 120), (8, 120), (4, 60), (4, 240))
"""Robots and battery; those of the source are lost."""

METHODS: dict[str, dict[str, Any]] = {
    "home": {"rule": "home"},
    "sacrifice": {},
    "no meetings": {"period": 1_000_000},
    "radio": {"period": 1_000_000, "near": True},
    "for ever": {"patience": 0},
    "printed": {"rule": "printed"},
}
"""Rules of return: without roles; by the text; the same without ways to meetings; and with radios that bridge the last steps; with
relays that wait for ever; by the printed algorithm."""

LABELS = {
    "sacrifice": "by the text, period of 60", "no meetings": "without ways to meetings", "radio": "the same by radio",
    "for ever": "relays wait for ever",
}  # fmt: skip

LOOPS: dict[str, dict[str, Any]] = {
    "exact": {"solver": "branch-price-cut"},
    "greedy-assignment": {"heuristic": "greedy-assignment"},
    "pure-greedy": {"heuristic": "pure-greedy"},
    "nearest-frontier": {"policy": "nearest-frontier"},
    "home": {"policy": "nearest-frontier", "rule": "home"},
}
"""Deciders in mazes; the last one without roles."""

MAZE: dict[str, Any] = {"map": "rooms", "room": 2, "width": 13, "height": 9, "robots": 2, "battery": 20, "sight": 0, "reach": 3}

LOOPED = "Mazes, two robots: means of the cells returned, in percent of the bound in hindsight, and points lost against exact plans"

NOTES = (
    "percent of the floor whose map is at the base at the end; intervals are of confidence 95 % over floors, the same ones for all",
    "a relay waits for 100 steps, but for ever where it says so, as in the source",
)

VAIN = "ways to meetings and waits in vain cost more than sacrifices bring"


def last_row(mission: UnreliableCommunication, seed: int, **how: Any) -> dict[str, Any]:
    """The end of a run, with the milliseconds of a step."""
    log = completed(mission, seed=seed, **how)
    kept = {name: float(log[name].iloc[-1]) for name in ("returned", "explored", "energy", "step")}
    return {"seed": seed, **kept, **decision_times(log)}


def swept(seed: int, floor: str, robots: int, battery: int) -> list[dict[str, Any]]:
    """All of ``METHODS`` on one floor: a task for ``spread``."""
    point = {"robots": robots, "battery": battery}
    return [
        {"floor": floor, **point, "method": method}
        | last_row(UnreliableCommunication(), seed, policy="nearest-frontier", map=floor, **FLOORS[floor], **point, **how)
        for method, how in METHODS.items()
    ]


def looped(seed: int) -> list[dict[str, Any]]:
    """All of ``LOOPS`` in one maze, and its bound: a task for ``spread``."""
    mission = UnreliableCommunication()
    rows: list[dict[str, Any]] = [
        {"loop": True, "method": method} | last_row(mission, seed, **MAZE, **how) for method, how in LOOPS.items()
    ]
    best = solve(hindsight(mission.played, MAZE["battery"]), Request(solver="branch-price-cut", time_limit=60.0))
    assert isinstance(best.bound, float)
    most = float(np.floor(best.bound + 1e-6)) + 1.0  # and the base
    cells = [row["returned"] * float(mission.played.free.sum()) / 100.0 for row in rows]
    return [{**row, "cells": own, "most": most, "share": 100.0 * own / most} for row, own in zip(rows, cells, strict=True)]


@study(
    "unreliable-communication",
    "exploration with relays and sacrifices against robots that fly home, and planning in the loop against hindsight",
    100,
    short=2,
    source="Skeele (2016), section 4.4, Fig. 4.4",
    claim="the roles bring 5 to 18 % more of the map to the base, never less; more so with more robots",
)
def unreliable_communication(setting: StudySetting) -> Report:
    points = [(floor, *point) for floor in FLOORS for point in (POINTS if setting.full else POINTS[:3:2])]
    tasks = [(looped, seed) for seed in setting.seeds] + [(swept, seed, *one) for seed in setting.seeds for one in points]
    done = spread(called, tasks, setting.jobs, setting.told, lambda t: f"seed {t[1]}: {t[2:] or 'loops'}")
    played, times = times_apart(done.rows)
    loops = framed(played, "loop")
    sweeps = framed(played, "floor")
    rows, faults = means(sweeps), broken(played)
    film = film_of(UnreliableCommunication(), setting.seed, policy="nearest-frontier", robots=4)
    return Report(
        "unreliable-communication", unreliable_communication.summary, frame_table("Percent of the floor that the base knows", rows),
        tuple(rows), tuple(played), thinned(faults), len(faults), figures=(gains_figure(rows),) if rows else (), notes=NOTES,
        findings=tuple(findings(sweeps)), further=(frame_table(LOOPED, loop_means(loops, ("cells", "share"), "share", most=True)), times),
        clips=(Clip(lambda: film, "four robots among rooms; m: to a meeting, w: waits, r: returns, s: searches its relay, d: done"),),
        **done.progress(),
    )  # fmt: skip


def means(sweeps: pd.DataFrame) -> list[dict[str, Any]]:
    """Each method at each point: percent returned, explored, and the gain over robots without roles, in points and in percent."""
    rows: list[dict[str, Any]] = []
    for (floor, robots, battery), own in sweeps.groupby(["floor", "robots", "battery"], sort=False) if len(sweeps) else ():
        for method in METHODS:
            part = own[own["method"] == method]
            row: dict[str, Any] = {"floor": floor, "robots": robots, "battery": battery, "method": method, "runs": len(part)}
            row |= intervals(part, ("returned", "explored"))
            row["gain"], row[f"gain{HALF}"] = apart(own, "returned", method, "home")
            rows.append({**row, "gain_percent": 100.0 * row["gain"] / (row["returned"] - row["gain"])})
    return rows


def broken(rows: Sequence[dict[str, Any]]) -> list[Fault]:
    """Runs that return more than was explored or than hindsight allows, or overdraw a battery."""
    faults = []
    for row in rows:
        where = f"seed {row['seed']}, {row['method']}"
        if row["returned"] > row["explored"] * (1 + 1e-12) or row["energy"] < 0:
            faults.append(Fault("answer", f"{where}: more returned than explored, or an overdrawn battery", None, row["method"]))
        if row.get("share", 0.0) > 100.0 * (1 + 1e-12):
            faults.append(Fault("bound", f"{where}: {row['cells']:.6g} cells returned, at most {row['most']:.6g}", None, "bound"))
    return faults


def corridor(rule: str, robots: int, battery: int = 64) -> float:
    """The farthest cell of a corridor whose map is returned, as a share of the battery; ``robots`` pass it on in a chain."""
    mission = UnreliableCommunication()
    how: dict[str, Any] = {"map": "corridor", "width": battery + 2, "sight": 0, "reach": 0, "roles": "chain", "period": 1_000_000}
    run(mission, policy="nearest-frontier", robots=robots, battery=battery, rule=rule, **how)
    return float(mission.played.returned.sum() - 1) / battery


def findings(sweeps: pd.DataFrame) -> list[Finding]:
    """The source's claims, each by pairs of the same seeds."""
    reached = {(rule, n): corridor(rule, n) for rule, n in (("home", 2), ("sacrifice", 2), ("sacrifice", 3), ("printed", 2))}
    shown = ", ".join(f"{rule} of {n}: {value:g}" for (rule, n), value in reached.items())
    found = [
        Finding("Fig. 4.4: percent explored", "plotted", "see the table", LOST, "its numbers, batteries, ranges and maps are lost"),
        Finding.of_fact(
            "corridor: farthest cell returned, in batteries", "1/2; 3/4; 7/8; 1/2 by the printed rule", shown,
            [*reached.values()] == [0.5, 0.75, 0.875, 0.5], exact=True, why="the automaton is not that of the formula",
        ),
    ]  # fmt: skip
    if not len(sweeps):
        return found
    table = sweeps.pivot_table(index=["floor", "robots", "battery", "seed"], columns="method", values="returned")
    gains = table.sub(table["home"], axis=0)
    for method, label in LABELS.items():
        own = gains[method]
        at = [(f"{f} {r} x {b}", *mean_interval(part)) for (f, r, b), part in own.groupby(["floor", "robots", "battery"], sort=False)]
        ours = f"{min(lead for _, lead, _ in at):.1f} to {max(lead for _, lead, _ in at):.1f} points"
        rooms, eight = own.unstack("robots").loc["rooms"].xs(120, level="battery"), own.loc[("blocks", 8, 120)]
        found += [
            Finding.of_points(f"gain at each point, {label}", "5 to 18 %, never negative", at, ours, VAIN),
            Finding.of_lead(f"gain, mean of all points, {label}", "positive", *mean_interval(own.groupby("seed").mean()), "points", VAIN),
            Finding.of_lead(
                f"gain of 8 robots over that of 2, rooms, {label}", "grows", *mean_interval(rooms[8] - rooms[2]), "points", VAIN
            ),
            Finding.of_lead(f"gain of 8 robots, blocks, {label}", "substantial", *mean_interval(eight), "points", VAIN),
        ]
    printed = (table["sacrifice"] - table["printed"]).groupby("seed").mean()
    found.append(Finding.of_lead("text over print, mean of all points", "not stated", *mean_interval(printed), "points"))
    return found


@figure("unreliable-communication", 11.0, 3.8)
def gains_figure(figure: Any, rows: Sequence[dict[str, Any]]) -> None:
    """Gains over robots without roles, by robots and by battery, on both floors."""
    panels = [(floor, key) for floor in FLOORS for key in ("robots", "battery")]
    for ax, (floor, key) in zip(figure.subplots(1, len(panels), sharey=True), panels, strict=True):
        fixed, level = ("battery", 120) if key == "robots" else ("robots", 4)
        for method, colour in zip(LABELS, COLOURS, strict=False):
            own = [row for row in rows if (row["floor"], row["method"], row[fixed]) == (floor, method, level)]
            at, gain, half = np.array(sorted((row[key], row["gain"], row[f"gain{HALF}"]) for row in own), dtype=float).reshape(-1, 3).T
            ax.plot(at, gain, color=colour, marker="o", markersize=3, label=method)
            ax.fill_between(at, gain - half, gain + half, color=colour, alpha=0.15, linewidth=0)
        ax.axhline(0.0, color="#999999", linewidth=0.8)
        ax.set_title(floor, fontsize=9, loc="right")
        ax.set_xlabel(key, fontsize=9)
        plain(ax, "gain, points" if (floor, key) == panels[0] else "")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False, fontsize=9)
