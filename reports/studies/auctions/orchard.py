"""Days in the orchard after Zhang (2015), chapter 3: how much of the gain is the auction's, and how much that of bringing bins ahead."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

from ....instances.auctions.orchard_grid import OrchardGrid
from ....instances.auctions.orchard_rules import OrchardRules, draw_routes
from ...plots.drawing import band, plain
from ..findings import LOST, NOT, SIGN, UNDECIDED, Finding
from ..frames import HALF, apart, frame_table, framed, mean_interval
from ..processes import spread
from ..study import Figure, Report, StudySetting, study

if TYPE_CHECKING:
    import pandas as pd

CHOICES, DELIVERIES = ("greedy", "auction"), ("baseline", "proposed")

METHODS = tuple(f"{choice}+{delivery}" for delivery, choice in product(DELIVERIES, CHOICES))

COLOURS = {"greedy+baseline": "#777777", "auction+baseline": "#DDAA33", "greedy+proposed": "#33AADD", "auction+proposed": "#332288"}

EFFECTS = {
    "auction (baseline)": ("greedy+baseline", "auction+baseline", "#DDAA33"),
    "auction (proposed)": ("greedy+proposed", "auction+proposed", "#CC3377"),
    "delivery (greedy)": ("greedy+baseline", "greedy+proposed", "#33AADD"),
    "delivery (auction)": ("auction+baseline", "auction+proposed", "#117733"),
    "both": ("greedy+baseline", "auction+proposed", "#332288"),
}
"""Methods before and after each change, and its colour."""

HORIZON = 150
"""Steps, 15 hours: the source counts the bins returned by then."""

TEAMS, GROUPS = tuple(range(2, 21)), (4, 8)
"""Robots, and groups of pickers, of the source."""

FACTORIAL = (
    "the thesis prints no numbers, seeds or numbers of days; its method and its baseline differ in two rules, which are told apart here",
    "all rules meet the same days; intervals are of confidence 95 % over days, effects are taken day by day",
)


def days_of(seed: int, teams: tuple[int, ...], groups: tuple[int, ...]) -> list[dict[str, Any]]:
    """One day by all rules, for every team: its steps and other figures, and the least steps of any rule."""
    from ...missions.auctions.orchard_days.days import least_makespan, play_day

    rows = []
    for pickers, robots in product(groups, teams):
        rules = OrchardRules(OrchardGrid(10, 10), robots, pickers)
        least = least_makespan(rules)
        for method in METHODS:
            day = play_day(rules, seed, *method.split("+"))
            rows.append(
                {
                    "groups": pickers, "robots": robots, "seed": seed, "method": method, "steps": day.makespan,
                    "returned": day.returned_by(HORIZON), "idle": day.idle_steps * rules.pickers, "auctions": day.auctions,
                    "beaten": day.beaten, "least": least,
                }
            )  # fmt: skip
    return rows


@study(
    "orchard",
    "bins fetched by choice (greedy, auction) and delivery (baseline, proposed), told apart",
    100,
    short=3,
    source="Zhang (2015), sections 3.4 and 3.5, Figs. 3.2 to 3.4",
    claim="the auction needs fewer steps and returns more bins than the greedy baseline, for 2 to 20 robots",
)
def orchard(setting: StudySetting) -> Report:
    teams, groups = (TEAMS, GROUPS) if setting.full else ((2, 8), (4,))
    tasks = [(seed, teams, groups) for seed in setting.seeds]
    done = spread(days_of, tasks, setting.jobs, setting.told, lambda task: f"day {task[0]}")
    days = framed(done.rows)
    steps, effects = steps_rows(days), effects_rows(days)
    return Report(
        "orchard", orchard.summary,
        frame_table(f"Steps until all bins are home, bins by step {HORIZON}, steps for which pickers wait; means of days", steps),
        tuple(steps), tuple(done.rows), figures=(ablation_figure(framed(steps), framed(effects)),), notes=FACTORIAL,
        findings=tuple(findings(days, effects)),
        further=(
            frame_table("Percent of greedy+baseline's steps saved on the same days", effects),
            frame_table("Auctions of several robots, and those that an assignment of the same robots beats", auctions_rows(days)),
        ),
        **done.progress(),
    )  # fmt: skip


def steps_rows(days: pd.DataFrame) -> list[dict[str, Any]]:
    """Mean steps of each method with intervals, bins returned by the horizon, and steps for which pickers wait."""
    rows = []
    for (groups, robots, method), alike in days.groupby(["groups", "robots", "method"], sort=False):
        row: dict[str, Any] = {"groups": groups, "robots": robots, "method": method, "least": int(alike["least"].iloc[0])}
        for key in ("steps", "returned", "idle"):
            row[key], row[key + HALF] = mean_interval(alike[key])
        rows.append(row)
    return rows


def effects_rows(days: pd.DataFrame) -> list[dict[str, Any]]:
    """Steps that each change saves on the same day, in percent of the baseline's: the auction with either delivery, the delivery with
    either choice, both."""
    rows = []
    for (groups, robots), alike in days.groupby(["groups", "robots"], sort=False):
        steps = alike.pivot_table(index="seed", columns="method", values="steps")
        row: dict[str, Any] = {"groups": groups, "robots": robots}
        for name, (before, after, _) in EFFECTS.items():
            row[name], row[name + HALF] = mean_interval(100.0 * (steps[before] - steps[after]) / steps["greedy+baseline"])
        row["both wins"] = float((steps["auction+proposed"] < steps["greedy+baseline"]).mean())
        row["bins"], row[f"bins{HALF}"] = apart(alike, "returned", "auction+proposed", "greedy+baseline")
        rows.append(row)
    return rows


def auctions_rows(days: pd.DataFrame) -> list[dict[str, Any]]:
    """Auctions of several robots in all days, and those that an assignment of the same robots beats."""
    rows = []
    for (groups, method), alike in days[days["method"].str.startswith("auction")].groupby(["groups", "method"], sort=False):
        held, beaten = int(alike["auctions"].sum()), int(alike["beaten"].sum())
        rows.append({"groups": groups, "method": method, "auctions": held, "beaten": beaten, "share": beaten / held if held else 0.0})
    return rows


def findings(days: pd.DataFrame, effects: list[dict[str, Any]]) -> list[Finding]:
    """The source's claims, with the effects of its two changes separated."""
    found = [Finding("Figs. 3.2 to 3.4: steps and bins", "plotted", "see the table", LOST, "the plots' numbers are lost")]
    for groups in dict.fromkeys(row["groups"] for row in effects):
        own = [row for row in effects if row["groups"] == groups]
        for what, key, claim in (
            ("auction and delivery together: steps", "both", "fewer than the baseline"),
            ("auction and delivery together: bins by step 150", "bins", "more than the baseline"),
            ("auction alone: steps", "auction (baseline)", "credited with the gain"),
            ("auction where new bins are brought ahead: steps", "auction (proposed)", "credited with the gain"),
        ):
            better, worse = ([row["robots"] for row in own if sign * row[key] > row[key + HALF]] for sign in (1, -1))
            said = f"better for {ranges(better)}{' robots' if better else ''}, worse for {ranges(worse)}"
            why = "the delivery rule, which the auction is credited with, brings new bins ahead by itself"
            verdict = NOT if worse else SIGN if len(better) == len(own) else UNDECIDED
            reason = {NOT: why, UNDECIDED: "the intervals of the others hold both"}.get(verdict, "")
            found.append(Finding(f"{groups} groups, {what}", claim, said, verdict, reason))
    first = days[(days["groups"] == days["groups"].min()) & (days["method"] == "auction+proposed")]
    enough = sorted(int(robots) for robots in set(first["robots"]) if first[first["robots"] == robots]["steps"].mean() <= HORIZON)
    found.append(
        Finding.of_fact(
            "large teams finish 160 bins within 150 steps (text on Fig. 3.3)", "yes", f"teams that do: {ranges(enough)}", bool(enough),
            "the distances alone take 2,200 steps of one robot, so that fewer than 15 cannot; groups wait for bins beyond",
        )
    )  # fmt: skip
    return found


def ranges(numbers: list[int]) -> str:
    """Numbers as text, runs of consecutive ones as ``2-5``."""
    if not numbers:
        return "none"
    runs = [[numbers[0], numbers[0]]]
    for number in numbers[1:]:
        if number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def ablation_figure(steps: pd.DataFrame, effects: pd.DataFrame) -> Figure:
    """One row per number of groups: steps of each method over the number of robots, and what each change saves; bands are the intervals."""
    groups = sorted(set(steps["groups"]))

    def draw(figure: Any) -> None:
        from matplotlib.ticker import NullFormatter, ScalarFormatter

        axes = figure.subplots(len(groups), 2, squeeze=False, sharex=True)
        for (left, right), count in zip(axes, groups, strict=True):
            own = steps[steps["groups"] == count]
            for method, colour in COLOURS.items():
                line = own[own["method"] == method]
                band(left, line["robots"], line["steps"], line["steps" + HALF], color=colour, label=method)
            floor = own.drop_duplicates("robots")
            left.plot(
                floor["robots"], floor["least"], color="#222222", linewidth=0.9, linestyle=(0, (5, 3)), label="no rule can take fewer"
            )
            left.set_yscale("log")
            left.set_yticks([100, 200, 400, 800])
            left.yaxis.set_major_formatter(ScalarFormatter())
            left.yaxis.set_minor_formatter(NullFormatter())
            left.set_ylabel("steps until all bins are home", fontsize=9)
            plain(left, f"{count} groups: steps")
            saved = effects[effects["groups"] == count]
            for effect, (_, _, colour) in EFFECTS.items():
                band(right, saved["robots"], saved[effect], saved[effect + HALF], color=colour, label=effect)
            right.axhline(0.0, color="#999999", linewidth=0.8)
            right.set_ylabel("percent of the baseline's steps saved", fontsize=9)
            plain(right, f"{count} groups: what each change saves on the same day")
        for ax in axes[-1]:
            ax.set_xlabel("robots", fontsize=9)
            ax.locator_params(axis="x", integer=True)
        axes[0][0].legend(frameon=False, fontsize=8)
        figure.legend(*axes[0][1].get_legend_handles_labels(), loc="outside lower right", ncols=len(EFFECTS), frameon=False, fontsize=8)

    return Figure("orchard", draw, (11.0, 0.6 + 3.6 * len(groups)))


# -- small orchards, beside the optimum of the whole day ------------------------------------------------------------------


def small_day(seed: int, robots: int) -> list[dict[str, Any]]:
    """One day of two lanes of four trees with fixed routes of groups: the last step of each rule, and of the optimum."""
    import numpy as np

    from ....formulations.auctions.orchard_day import OrchardDay
    from ....instances.auctions.orchard_jobs import OrchardJobs
    from ....instances.generators import Draw
    from ....solving.request import Request
    from ....solving.solve import solve
    from ...missions.auctions.orchard_days.days import play_day

    rules = OrchardRules(OrchardGrid(2, 6), robots, 2, bins_per_cell=1)
    start = draw_routes(rules, Draw(np.random.Generator(np.random.PCG64(seed))))
    best = solve(OrchardDay(OrchardJobs.of_routes(rules, start)), Request(solver="interval-scheduling", bound_time=0.0))
    row: dict[str, Any] = {"robots": robots, "seed": seed, "optimum": best.objective, "status": best.status}
    return [row | {method: play_day(rules, seed, *method.split("+"), start=start).makespan for method in METHODS}]


@study(
    "orchard-optimum",
    "rules of the orchard beside the optimum of small days",
    10,
    short=1,
    source="Zhang (2015), chapter 3; the optimum is not in the source",
    claim="none: the source compares its rules with each other alone",
)
def orchard_optimum(setting: StudySetting) -> Report:
    tasks = [(seed, m) for seed in setting.seeds for m in ((1, 2, 3) if setting.full else (3,))]
    done = spread(small_day, tasks, setting.jobs, setting.told, lambda task: f"{task[1]} robots, day {task[0]}")
    rows = []
    for robots in dict.fromkeys(row["robots"] for row in done.rows):
        alike = [row for row in done.rows if row["robots"] == robots and row["status"] == "optimal"]
        row: dict[str, Any] = {"robots": robots, "days": len(alike)}
        for method in METHODS:
            row[method], row[method + HALF] = mean_interval([one[method] / one["optimum"] for one in alike])
        rows.append(row)
    return Report(
        "orchard-optimum", orchard_optimum.summary, frame_table("Last step over the optimum's, means of days", rows), tuple(rows),
        tuple(done.rows), notes=("the optimum knows the routes of the groups, and so the requests, beforehand",), **done.progress(),
    )  # fmt: skip
