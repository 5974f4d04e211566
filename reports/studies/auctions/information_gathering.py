"""Partition against auction in information gathering, after Zhang (2015), chapter 4."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ...plots.drawing import band, plain
from ..findings import LOST, Finding
from ..frames import HALF, apart, frame_table, framed, mean_interval, play
from ..processes import spread
from ..study import Report, StudySetting, figure, study

if TYPE_CHECKING:
    import pandas as pd

METHODS: dict[str, dict[str, Any]] = {
    "auction": {"policy": "auction"},
    "partition, look-ahead 1": {"policy": "partition", "look_ahead": 1},
    "partition, look-ahead 3": {"policy": "partition", "look_ahead": 3},
    "partition, literal urgency": {"policy": "partition", "look_ahead": 3, "urgency": "literal", "edges": "clique"},
}
"""The literal urgency grows with the distance where it is negative, as printed; all pairs of a part are among its costs then."""

COLOURS = dict(zip(METHODS, ("#DDAA33", "#33AADD", "#332288", "#CC3377"), strict=True))

TITLES = {"gain": "units brought home", "idle": "steps for which sensors were full", "loss": "units not gathered"}

BETTER = {"gain": 1, "idle": -1, "loss": -1}
"""1 for what should be large, -1 for what should be small."""

TEAMS, STEPS = (2, 3, 4, 5), 1000
"""The source's."""

NOTES = (
    "the thesis prints no numbers, seeds, runs, rates or size of the grid: 20 x 20 cells and rates of 1 to 5 here",
    "all methods meet the same sensors; intervals are of confidence 95 % over runs, differences are taken run by run",
)


@study(
    "information-gathering",
    "sensors emptied by a partition with tours, or by an auction whenever a robot is back",
    40,
    short=2,
    source="Zhang (2015), section 4.5, Figs. 4.2 and 4.3",
    claim="the partition is better than the auction in gain, idle time and loss, for 2 to 5 robots",
)
def information_gathering(setting: StudySetting) -> Report:
    teams, steps = (TEAMS, STEPS) if setting.full else (TEAMS[:2], 60)
    tasks = [
        ("information-gathering", METHODS, steps, seed, {"robots": robots}, {"robots": robots}, tuple(TITLES), True)
        for seed in setting.seeds for robots in teams
    ]  # fmt: skip
    done = spread(play, tasks, setting.jobs, setting.told, lambda task: f"{task[4]['robots']} robots, run {task[3]}")
    runs = framed(done.rows)
    rows = means(runs)
    return Report(
        "information-gathering", information_gathering.summary,
        frame_table(f"Means of runs of {steps} steps, and how far above the auction on the same runs", rows), tuple(rows), tuple(done.rows),
        figures=(metrics_figure(framed(rows)),), notes=NOTES, findings=tuple(findings(runs, rows)), **done.progress(),
    )  # fmt: skip


def means(runs: pd.DataFrame) -> list[dict[str, Any]]:
    """Mean of each metric with its interval, and by how much it lies above the auction's on the same runs."""
    rows = []
    for robots, alike in runs.groupby("robots", sort=True):
        for method in METHODS:
            row: dict[str, Any] = {"robots": int(str(robots)), "method": method, "runs": int((alike["method"] == method).sum())}
            for name in TITLES:
                row[name], row[name + HALF] = mean_interval(alike[alike["method"] == method][name])
                row[f"{name}_above"], row[f"{name}_above{HALF}"] = apart(alike, name, method, "auction")
            rows.append(row)
    return rows


def findings(runs: pd.DataFrame, rows: list[dict[str, Any]]) -> list[Finding]:
    """The source's claims, team by team."""
    known = {(row["robots"], row["method"]): row for row in rows}
    teams = sorted({robots for robots, _ in known})
    found = [Finding("Figs. 4.2 and 4.3: gain, idle time and loss", "plotted", "see the table", LOST, "the plots' numbers are lost")]
    for robots in teams:
        row = known[robots, "partition, look-ahead 3"]
        found += [
            Finding.of_lead(
                f"{robots} robots, {name}", "partition better than auction", sign * row[f"{name}_above"], row[f"{name}_above{HALF}"],
                why="the auction allocates anew whenever a robot is back, the partition never",
            )
            for name, sign in BETTER.items()
        ]  # fmt: skip
    gains = [known[robots, "partition, look-ahead 3"]["gain"] for robots in teams]
    said = ", ".join(f"{gain:.0f}" for gain in gains)
    found.append(Finding.of_fact("gain of the partition", "grows with the team", said, all(a < b for a, b in pairwise(gains))))
    near, far = "partition, look-ahead 1", "partition, look-ahead 3"
    for robots in teams:
        alike = runs[runs["robots"] == robots]
        lead, half = (value / known[robots, far]["gain"] for value in apart(alike, "gain", near, far))
        found.append(Finding.of_near(f"{robots} robots, look-ahead of one against three", "differ slightly", lead, half, 0.05))
    if {4, 5} <= set(teams):
        four, five = (runs[(runs["method"] == "auction") & (runs["robots"] == robots)].set_index("seed")["gain"] for robots in (4, 5))
        lead, half = (value / four.mean() for value in mean_interval((five - four).dropna()))
        found.append(Finding.of_near("auction, a fifth robot", "4 and 5 almost equal", lead, half, 0.05, "a robot more brings more here"))
    return found


@figure("information-gathering", 11.0, 6.6)
def metrics_figure(figure: Any, table: pd.DataFrame) -> None:
    """Each metric over the number of robots, and below it its lead over the auction on the same runs; bands are the intervals."""
    axes = figure.subplots(2, len(TITLES), sharex=True)
    for column, (name, title) in enumerate(TITLES.items()):
        for ax, key in zip(axes[:, column], (name, f"{name}_above"), strict=True):
            for method, colour in COLOURS.items():
                own = table[table["method"] == method]
                band(ax, own["robots"], own[key], own[key + HALF], 0.22, color=colour, marker="o", markersize=3, label=method)
        axes[0, column].set_ylim(bottom=0)
        axes[1, column].set_xlabel("robots", fontsize=9)
        axes[1, column].locator_params(axis="x", integer=True)
        plain(axes[0, column], title)
        plain(axes[1, column], "above the auction, on the same runs")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=len(COLOURS), frameon=False, fontsize=9)
