"""Search and tracking after Sung (2019), chapter 2: clutter, beginnings and planners, and what planning in the loop loses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from ....instances.worlds import World
from ....solving.request import Request
from ....solving.solve import solve
from ...missions.mission import Decision
from ...missions.sata.search_and_track import SearchAndTrack
from ...plots.drawing import COLOURS, plain
from ..findings import LOST, Finding
from ..frames import apart, completed, decision_times, film_of, frame_table, framed, mean_interval, method_means, times_apart
from ..processes import spread
from ..study import Clip, Report, StudySetting, figure, study

if TYPE_CHECKING:
    import pandas as pd

FLIGHTS: dict[str, dict[str, Any]] = {
    "10 % clutter": {"policy": "lawn-mower"},
    "0 % clutter": {"policy": "lawn-mower", "clutter": 0.0},
    "20 % clutter": {"policy": "lawn-mower", "clutter": 0.2},
    "under": {"policy": "lawn-mower", "initial": 5},
    "over": {"policy": "lawn-mower", "initial": 15},
    "no repulsion": {"policy": "lawn-mower", "repulsion": "none"},
    "largest, under": {"policy": "largest-gaussian", "initial": 5},
    "largest, exact": {"policy": "largest-gaussian"},
    "largest, over": {"policy": "largest-gaussian", "initial": 15},
}
"""One robot: ten components at the start and 10 % clutter but where said; under and over: five and fifteen."""

LOOPS: dict[str, dict[str, Any]] = {
    "exact": {"solver": "highs"},
    "sequential-greedy": {"heuristic": "sequential-greedy"},
    "random": {"heuristic": "random"},
    "lawn-mower": {"policy": "lawn-mower"},
}

TEAM: dict[str, Any] = {"robots": 3, "plan_every": 20, "target_step": 0.05, "robot_step": 2.0}

MEASURES = (
    "ospa", "found", "missed", "components", "tracks", "weight", "track_weight", "closest", "next_closest", "variance",
)  # fmt: skip

PRINTED: dict[str, dict[str, str]] = {
    "components": {"0 % clutter": "9.2995", "10 % clutter": "17.8844", "20 % clutter": "22.5303", "under": "18.4820", "over": "17.8883"},
    "tracks": {"0 % clutter": "6.6800", "10 % clutter": "8.1645", "20 % clutter": "8.8030", "under": "9.5336", "over": "8.5219"},
    "weight": {"0 % clutter": "16.4074", "10 % clutter": "18.6284", "20 % clutter": "19.4675", "under": "19.4229", "over": "18.3695"},
    "track_weight": {"0 % clutter": "14.9232", "10 % clutter": "15.6775", "20 % clutter": "15.4238", "under": "16.3315", "over": "15.4196"},
    "closest": {"0 % clutter": "3.0311", "10 % clutter": "2.3603", "20 % clutter": "2.5529", "under": "3.0930", "over": "3.3152"},
    "next_closest": {"0 % clutter": "8.2450", "10 % clutter": "7.0569", "20 % clutter": "7.0451", "under": "7.3006", "over": "7.5527"},
}
"""Tables 2.1 to 2.4."""

SEEDS_LOST = "the source's seeds, noise, motion and hyperparameters are not told; means over other runs"

NOTES = (
    "means over the steps of a run, then over runs, with intervals of confidence 95 %; all methods meet the same targets",
    "found: targets with a confirmed track within 10 m; missed: the others; closest, next closest: Mahalanobis distances to tracks",
    "the short form flies 2 m a step, one sweep in 600 steps; in full it is 0.5 m, three sweeps in 7,278",
    "lost: percent of the worth of a plan below the best for the same state; only the exact loop proves each plan",
)


class Examined(SearchAndTrack):
    """The mission with what each plan loses against the optimum of its own problem."""

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        worth = [math.nan, math.nan]
        for d in decisions:
            if isinstance(d.problem, WinnerTakesAllSATA) and d.solution is not None and isinstance(d.solution.objective, float):
                best = solve(d.problem, Request(solver="highs", time_limit=60.0, bound_time=0.0))
                if best.status == "optimal" and isinstance(best.objective, float):
                    worth = [d.solution.objective, best.objective]
        return {**super().measures(decisions, world), "lost": 100.0 * (1.0 - worth[0] / worth[1])}


def flown(seed: int, steps: int, robot_step: float) -> list[dict[str, Any]]:
    """All of ``FLIGHTS`` in one world, and of ``LOOPS`` in one of a team: a task for ``spread``."""
    rows: list[dict[str, Any]] = []
    tasks = [("flight", name, steps, {"robot_step": robot_step, **how}, SearchAndTrack) for name, how in FLIGHTS.items()]
    tasks += [("loop", name, 300, {**TEAM, **how}, Examined) for name, how in LOOPS.items()]
    for kind, name, length, how, mission in tasks:
        log = completed(mission(), seed=seed, steps=length, **how)
        row: dict[str, Any] = {"kind": kind, "seed": seed, "method": name, **{key: float(log[key].mean()) for key in MEASURES}}
        row["variance_worst"] = float(log["variance"].max())
        row["lost"] = float(log["lost"].mean()) if "lost" in log else math.nan
        rows.append({**row, **decision_times(log, log["problems"] >= (kind == "loop" and "policy" not in how))})
    return rows


@study(
    "search-and-track",
    "search and tracking with a PHD filter: clutter, beginnings, repulsion, planners, and greedy plans against exact ones",
    20,
    short=2,
    source="Sung (2019), chapter 2, Tables 2.1 to 2.5",
    claim="repulsion at the border of the field of view avoids false negatives; the largest Gaussian finds fewer targets than a lawn mower",
)
def search_and_track(setting: StudySetting) -> Report:
    steps, robot_step = (7278, 0.5) if setting.full else (600, 2.0)
    done = spread(flown, [(seed, steps, robot_step) for seed in setting.seeds], setting.jobs, setting.told, lambda task: f"seed {task[0]}")
    observed, times = times_apart(done.rows)
    table = framed(observed)
    flights, loops = table[table["kind"] == "flight"], table[table["kind"] == "loop"]
    rows, looped = (method_means(table, methods, (*MEASURES, "lost")) for table, methods in ((flights, FLIGHTS), (loops, LOOPS)))
    played = film_of(SearchAndTrack(), setting.seed, steps=300, heuristic="sequential-greedy", **TEAM)
    return Report(
        "search-and-track", search_and_track.summary, frame_table("One robot: means of steps and runs", rows),
        tuple(rows), tuple(observed),
        figures=(loop_figure(loops),), notes=NOTES, findings=tuple(findings(flights, loops)),
        further=(frame_table("Teams of three: means, and percent of the worth that plans lose", looped), times),
        clips=(Clip(lambda: played, "three robots share out what the filter is least sure of, greedily"),), **done.progress(),
    )  # fmt: skip


PUSHED = "what is pushed out is out of sight, and stays a track where there is no target"

UNLIKE = "the source's noise and hyperparameters are lost; ours differ"

CLAIMS: tuple[tuple[str, str, str, str, str, int, str], ...] = (
    ("OSPA without (2.11) against with it", "larger", "ospa", "no repulsion", "10 % clutter", 1, PUSHED),
    ("Mahalanobis distance to the closest track without (2.11)", "larger", "closest", "no repulsion", "10 % clutter", 1, PUSHED),
    ("number of tracks without (2.11) against with it", "fewer (false negatives)", "tracks", "no repulsion", "10 % clutter", -1, UNLIKE),
    ("targets without a track within 10 m, without (2.11) against with it", "more (false negatives)", "missed", "no repulsion",
     "10 % clutter", 1, "what is pushed out is 11 m off: a track more, but seldom one that is near the target"),
    ("components, 20 % against 0 % clutter", "more", "components", "20 % clutter", "0 % clutter", 1, UNLIKE),
    ("tracks, 20 % against 0 % clutter", "more", "tracks", "20 % clutter", "0 % clutter", 1, UNLIKE),
    ("sum of weights, 20 % against 0 % clutter", "larger", "weight", "20 % clutter", "0 % clutter", 1,
     "without clutter each detection must be of some component, however far, and pulls it along"),
    ("largest covariance in a run, largest-Gaussian against lawn mower", "smaller", "variance_worst", "largest, exact", "10 % clutter", -1,
     "the largest is that of the start, or of what is out of reach, with both"),
    ("mean largest covariance, largest-Gaussian against lawn mower", "smaller", "variance", "largest, exact", "10 % clutter", -1, UNLIKE),
    ("tracks, largest-Gaussian against lawn mower", "fewer targets", "tracks", "largest, exact", "10 % clutter", -1, UNLIKE),
    ("targets found, largest-Gaussian against lawn mower", "fewer targets", "found", "largest, exact", "10 % clutter", -1,
     "it flies to where targets were said to be, and leaves out what holds none"),
)  # fmt: skip
"""Claims: text, direction, measure, method, the other, sign, and the reason where it does not come out."""


def findings(flights: pd.DataFrame, loops: pd.DataFrame) -> list[Finding]:
    """Claims, each by pairs of the same seeds; printed means beside ours; and what greedy plans lose."""
    found = []
    for what, claim, key, method, other, sign, why in CLAIMS:
        lead, half = apart(flights, key, method, other)
        found.append(Finding.of_lead(f"{what}, {'above' if sign > 0 else 'below'} by", claim, sign * lead, half, "", why))
    over, half = mean_interval(flights[flights["method"] == "10 % clutter"]["weight"] - 10.0)
    found.append(Finding.of_lead("sum of weights above the ten targets", "overestimated", over, half, "", UNLIKE))
    for key, printed in PRINTED.items():
        ours = flights.groupby("method")[key].mean()
        own = ", ".join(f"{ours[method]:.4g}" for method in printed)
        what = f"Tables 2.1 to 2.4: {key.replace('_', ' ')} ({', '.join(printed)})"
        found.append(Finding(what, ", ".join(printed.values()), own, LOST, SEEDS_LOST))
    for key, sign in (("ospa", 1), ("found", -1), ("variance", 1)):
        lead, half = apart(loops, key, "sequential-greedy", "exact")
        found.append(
            Finding.of_lead(
                f"greedy plans against exact ones, {key}, worse by", "not in the source", sign * lead, half, "", "greedy is better"
            )
        )
    return found


@figure("search-and-track", 11.0, 3.6)
def loop_figure(figure: Any, loops: pd.DataFrame) -> None:
    """OSPA, targets found and largest covariance of each way to decide, with intervals; what plans lose in the last panel."""
    panels = {"ospa": "OSPA, m", "found": "targets found", "variance": "largest trace, m2", "lost": "plans below the optimum, %"}
    for ax, (key, title) in zip(figure.subplots(1, len(panels)), panels.items(), strict=True):
        for k, name in enumerate(LOOPS):
            mean, half = mean_interval(loops[loops["method"] == name][key].dropna())
            ax.bar(k, mean, 0.8, yerr=half, color=COLOURS[k], label=name, capsize=2.0)
        ax.set_xticks([])
        plain(ax, title)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=9)
