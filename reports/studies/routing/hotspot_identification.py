"""Hotspot identification after Sung (2019), chapter 5: Table 5.1 and Fig. 5.4 again, and what plans in the loop lose against hindsight."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.routing.problem import RoutingProblem
from ....instances.worlds import World
from ....solving.request import Request
from ....solving.solve import solve
from ...missions.mission import Decision
from ...missions.routing.hotspot_identification import HotspotIdentification, picture_route
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import HALF, apart, completed, decision_times, film_of, frame_table, framed, mean_interval, method_means, times_apart
from ..processes import spread
from ..study import Clip, Fault, Report, StudySetting, figure, study, thinned

if TYPE_CHECKING:
    import pandas as pd

SCHEDULES = ("decreasing", "increasing")

BOUNDS: dict[str, dict[str, Any]] = {
    f"{which}{' window' * near} {schedule}": {"policy": f"{which}-variance{'-window' * near}", "schedule": schedule}
    for near in (False, True)
    for which in ("current", "future")
    for schedule in SCHEDULES
}
"""The source's eight strategies; ``PRINTED`` has them in the same order."""

METHODS: dict[str, dict[str, Any]] = {
    **BOUNDS,
    "block UCL": {"policy": "block-ucl"},
    **{f"boustrophedon {height} m": {"policy": "boustrophedon", "altitudes": str(height)} for height in (70, 40, 10)},
    **{
        f"flat {height} m {schedule}": {"policy": "future-variance-window", "schedule": schedule, "altitudes": str(height)}
        for height in (70, 40, 10)
        for schedule in SCHEDULES
    },
    "greedy routes": {"heuristic": "greedy-orienteering"},
}
"""Table 5.1, and orienteering routes, which are ours; flat: future variance with a window at one altitude."""

PRINTED = (
    "47.65", "49.39", "57.40", "59.46", "62.94", "61.49", "71.28", "71.60", "35.13", "35.86", "34.81", "28.73",
    "65.81", "66.93", "63.89", "69.23", "44.48", "47.56", None,
)  # fmt: skip
"""Table 5.1, point, mean in percent."""
VARIANTS: dict[str, dict[str, Any]] = {"prior of 5": {"deviation": 5.0}, "dependent cells": {"cells": "dependent"}}
"""``BOUNDS`` again: with half the deviation of the prior, which is by default about that of the fields; and with another mean variance."""

BUDGETS = (50, 100, 200, 400)

LOOPS: dict[str, dict[str, Any]] = {
    "exact": {"solver": "branch-price-cut"},
    "greedy-orienteering": {"heuristic": "greedy-orienteering"},
    **{policy: {"policy": policy} for policy in ("future-variance", "current-variance", "boustrophedon")},
}

SMALL: dict[str, Any] = {"size": 8, "altitudes": "10,20", "budget": 40, "sensing_time": 4, "candidates": 12}

LOOPED = (
    "Small fields: means, percent of intensity collected below hindsight, points lost against exact routes, and percent that a route loses"
)

NOTES = (
    "point: intensity where the largest is believed, in percent of the largest; arm: the same of sums over footprints",
    "intervals are of confidence 95 % over fields; all methods meet the same ones",
    "collected: mean intensities of footprints, each arm once; hindsight is the most that any flight could collect, by orienteering",
    "sensing time, kernel, noise, window and fields of the source are lost: docs/missions/hotspot-identification.md has ours",
)

KERNEL = "beta weighs a variance against a mean, so that it depends on the unit of the intensity and on the kernel, which is lost"
SHARED = "with our noise and time a sweep from higher up shows most of the field"
FLAT = "with these variances no confidence bound is largest higher up, so that three altitudes are the lowest one"


class Examined(HotspotIdentification):
    """The mission with what each route loses against the best of its own problem."""

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        lost = 0.0
        for d in decisions:
            if isinstance(d.problem, RoutingProblem) and d.solution is not None and isinstance(d.solution.objective, float):
                best = solve(d.problem, Request(solver="branch-price-cut", time_limit=60.0, bound_time=0.0))
                assert isinstance(best.objective, float)
                lost = 100.0 * (1.0 - d.solution.objective / best.objective) if best.status == "optimal" else np.nan
        return {**super().measures(decisions, world), "lost": lost}


def flown(seed: int, kind: str, name: str, mission: HotspotIdentification, how: Mapping[str, Any]) -> dict[str, Any]:
    """A row of one run: its last step, and times of decisions."""
    log = completed(mission, seed=seed, **how)
    kept = ("point", "arm", "collected", "pictures", "left")
    row = {"kind": kind, "method": name, "seed": seed, **{key: float(log[key].iloc[-1]) for key in kept}}
    row["lost"] = float(log["lost"][log["problems"] > 0].mean()) if "lost" in log else np.nan
    return {**row, **decision_times(log)}


def series(seed: int, full: bool) -> list[dict[str, Any]]:
    """All runs in one field, and in a small one: a task for ``spread``."""
    rows = [flown(seed, "table", name, HotspotIdentification(), how) for name, how in METHODS.items()]
    for kind, other in VARIANTS.items() if full else ():
        rows += [flown(seed, kind, name, HotspotIdentification(), {**other, **how}) for name, how in BOUNDS.items()]
    for budget in BUDGETS if full else ():
        how = {"budget": budget, **BOUNDS["future window increasing"]}
        rows.append({**flown(seed, "budget", "future window increasing", HotspotIdentification(), how), "budget": float(budget)})
    loops = []
    for name, how in LOOPS.items():
        mission = Examined() if "heuristic" in how else HotspotIdentification()
        loops.append(flown(seed, "loop", name, mission, {**SMALL, **how}))
    return rows + against_hindsight(loops, mission, seed)


def against_hindsight(rows: list[dict[str, Any]], mission: HotspotIdentification, seed: int) -> list[dict[str, Any]]:
    """The rows with the most that a flight could have collected in the small field, its proved bound, and how far below each is."""
    o = mission.world(seed, **SMALL).observe()
    rewards = o.arms.means(mission.played.values)
    whole = picture_route(o.place, o.arms.places, rewards, o.sensing_time, o.left, "hindsight")
    best = solve(whole, Request(solver="branch-price-cut", time_limit=60.0))
    assert isinstance(best.objective, float) and isinstance(best.bound, float)
    known = {"hindsight": best.objective, "bound": best.bound, "proved": best.status == "optimal"}
    return [{**row, **known, "below": 100.0 * (1.0 - row["collected"] / best.objective)} for row in rows]


@study(
    "hotspot-identification",
    "hotspots found from several altitudes: confidence bounds, windows, sweeps, and routes in the loop against hindsight",
    100,
    short=2,
    source="Sung (2019), chapter 5, Table 5.1 and Fig. 5.4",
    claim="future variance is better than current, a window better than none, and all better than block UCL and boustrophedon",
)
def hotspot_identification(setting: StudySetting) -> Report:
    done = spread(series, [(seed, setting.full) for seed in setting.seeds], setting.jobs, setting.told, lambda task: f"seed {task[0]}")
    observed, times = times_apart(done.rows)
    table = framed(observed)
    kinds: dict[str, pd.DataFrame] = {kind: table[table["kind"] == kind] for kind in ("table", *VARIANTS, "budget", "loop")}
    rows, faults = method_means(kinds["table"], METHODS, ("point", "arm", "collected", "pictures")), broken_bounds(observed)
    for row, printed in zip(rows, PRINTED, strict=True):
        row["published point"] = printed
    loops = method_means(kinds["loop"], LOOPS, ("point", "collected", "below", "lost"))
    for row in loops:
        row["points lost"], row[f"points lost{HALF}"] = apart(kinds["loop"], "point", "exact", row["method"])
    varied = {kind: method_means(kinds[kind], BOUNDS, ("point", "arm")) for kind in VARIANTS if len(kinds[kind])}
    others = [frame_table(f"With {kind}: means", own) for kind, own in varied.items()]
    played = film_of(HotspotIdentification(), setting.seed, heuristic="greedy-orienteering")
    return Report(
        "hotspot-identification", hotspot_identification.summary, frame_table("Table 5.1 again: means", rows), tuple(rows),
        tuple(observed), thinned(faults), len(faults), figures=(figure_of(kinds["table"], kinds["budget"]),), notes=NOTES,
        findings=tuple(findings(kinds)), further=(frame_table(LOOPED, loops), *others, times),
        clips=(Clip(lambda: played, "greedy routes among the arms of the largest confidence bounds"),), **done.progress(),
    )  # fmt: skip


def broken_bounds(rows: Sequence[dict[str, Any]]) -> list[Fault]:
    """Flights beyond their time, shares beyond 100 %, collections beyond the bound in hindsight, and hindsight without a proof."""
    faults = []
    for row in rows:
        where = f"seed {row['seed']}, {row['kind']}, {row['method']}"
        if row["left"] < 0.0 or max(row["point"], row["arm"]) > 100.0 * (1 + 1e-9):
            faults.append(Fault("answer", f"{where}: {row['left']:g} left, {row['point']:g} and {row['arm']:g} %", None, "flight"))
        if not row.get("proved", True):
            faults.append(Fault("bound", f"{where}: the most in hindsight is not proved", None, "hindsight"))
        if "bound" in row and not row["collected"] <= row["bound"] * (1 + 1e-9):
            faults.append(Fault("bound", f"{where}: {row['collected']:.9g} is above {row['bound']:.9g}", None, "bound"))
    return faults


def findings(kinds: Mapping[str, pd.DataFrame]) -> list[Finding]:
    """The source's order of methods, each by pairs of the same fields."""
    table, budgets = kinds["table"], kinds["budget"]

    def ahead(what: str, claim: str, pairs: Sequence[tuple[str, str]], why: str, of: pd.DataFrame = table) -> Finding:
        points = [(f"{one} / {other}", *apart(of, "point", one, other)) for one, other in pairs]
        leads = [lead for _, lead, _ in points]
        return Finding.of_points(f"{what}: point", claim, points, f"leads {min(leads):.3g} to {max(leads):.3g} points", why)

    variances = [(name.replace("current", "future"), name) for name in BOUNDS if name.startswith("current")]
    windows = [(name.replace(" ", " window ", 1), name) for name in BOUNDS if "window" not in name]
    found = [
        ahead("future against current variance", "better in all four pairs", variances, KERNEL),
        ahead("window against none", "better in all four pairs", windows, KERNEL),
        ahead("each strategy against block UCL", "better", [(name, "block UCL") for name in BOUNDS], KERNEL),
    ]
    for height in (70, 40, 10):
        pairs = [(name, f"boustrophedon {height} m") for name in BOUNDS]
        found.append(ahead(f"each strategy against boustrophedon at {height} m", "better", pairs, SHARED))
    flat = [(f"flat {height} m {schedule}", f"current window {schedule}") for height in (70, 40) for schedule in SCHEDULES]
    found.append(ahead("one altitude, 70 or 40 m, against current variance with a window", "better", flat, FLAT))
    lead, half = apart(table, "point", "future window increasing", "flat 40 m increasing")
    share = float(table[table["method"] == "flat 40 m increasing"]["point"].mean())
    what = "three altitudes against 40 m, the best one, future variance with a window: point"
    found.append(Finding.of_near(what, "within one sigma, 7 %", lead / share, half / share, 0.07, FLAT))
    for kind in VARIANTS if len(budgets) else ():
        found.append(ahead(f"future against current variance, {kind}", "better in all four pairs", variances, KERNEL, kinds[kind]))
        found.append(ahead(f"window against none, {kind}", "better in all four pairs", windows, KERNEL, kinds[kind]))
    if len(budgets):
        by = budgets.pivot_table(index="seed", columns="budget", values="point")
        levels = np.array(by.columns, dtype=np.float64)
        found.append(Finding.of_lead("Fig. 5.4: point, budget 50 to 400", "grows", *mean_interval(by[levels[-1]] - by[levels[0]])))
        early, late = ((by[b] - by[a]) / (b - a) for a, b in (levels[[0, 1]], levels[[-2, -1]]))
        what = "Fig. 5.4: gain a unit of budget, 50 to 100 against 200 to 400"
        found.append(Finding.of_lead(what, "less and less (about a logarithm)", *mean_interval(early - late)))
    ours = ", ".join(f"{table[table['method'] == name]['point'].mean():.4g}" for name in list(METHODS)[:-1])
    lost = "sensing time, kernel, noise, window and fields are lost; ours are other ones"
    return [*found, Finding("Table 5.1: point, in the order of the table", ", ".join(filter(None, PRINTED)), ours, LOST, lost)]


@figure("hotspot-identification", 11.0, 5.0)
def figure_of(figure: Any, table: pd.DataFrame, budgets: pd.DataFrame) -> None:
    """Point of each method with its interval, and over the budget."""
    left, right = figure.subplots(1, 2, width_ratios=(2.2, 1.0))
    for k, name in enumerate(METHODS):
        mean, half = mean_interval(table[table["method"] == name]["point"])
        colour = COLOURS[0 if name in BOUNDS else 1 if "flat" in name else 2 if "routes" in name else 3]
        left.barh(-k, mean, 0.75, xerr=half, color=colour, capsize=2.0)
    left.set_yticks([-k for k in range(len(METHODS))], list(METHODS), fontsize=8)
    plain(left, "largest intensity found, %")
    for budget, own in budgets.groupby("budget") if len(budgets) else ():
        mean, half = mean_interval(own["point"])
        right.errorbar(budget, mean, half, fmt="o", color=COLOURS[0], capsize=2.0)
    right.set_xscale("log", base=2)
    right.set_xticks(BUDGETS, [str(budget) for budget in BUDGETS])
    right.set_xlabel("budget, future variance with a window", fontsize=9)
    plain(right, "largest intensity found, %")
