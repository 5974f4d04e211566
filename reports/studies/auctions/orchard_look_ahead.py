"""Looking further than the next bin in the orchard, after Zhang (2015), section 3.6."""

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
    "assignment": {"solver": "lapjv"},
    "schedule": {"solver": "interval-scheduling", "plan": "makespan"},
}
"""The next bin by the auction, or by an assignment of idle robots; a schedule of all robots and standing bins, its first trips begun."""

COLOURS = dict(zip(METHODS, ("#DDAA33", "#33AADD", "#332288"), strict=True))

TEAMS = (2, 4, 8, 12)


@study(
    "orchard-look-ahead",
    "schedules of all standing bins beside the next bin alone, on five lanes",
    6,
    short=1,
    source="Zhang (2015), section 3.6",
    claim="only the first bin of a plan matters: later ones add noise, as other robots take them",
)
def orchard_look_ahead(setting: StudySetting) -> Report:
    teams = TEAMS if setting.full else TEAMS[-2:-1]
    tasks = [
        ("orchard", METHODS, 10_000, seed, {"rows": 5, "robots": robots}, {"robots": robots}, ("finished", "idle_worker_steps"), True)
        for seed in setting.seeds for robots in teams
    ]  # fmt: skip
    done = spread(play, tasks, setting.jobs, setting.told, lambda task: f"{task[4]['robots']} robots, day {task[3]}")
    days = framed(done.rows)
    rows = look_ahead_rows(days)
    findings = [Finding("plans over several bins", "unsatisfactory", "see the table", LOST, "no numbers, and no description of the plans")]
    for robots, alike in days.groupby("robots"):
        lead, half = apart(alike, "finished", "schedule", "auction")
        why = "a schedule knows where all standing bins are best fetched, which pays where robots are few"
        findings.append(Finding.of_lead(f"{robots} robots: schedule above the auction", "no better", lead, half, "steps", why))
    return Report(
        "orchard-look-ahead", orchard_look_ahead.summary, frame_table("Steps until 80 bins are home, and above the auction", rows),
        tuple(rows), tuple(done.rows), figures=(_figure(framed(rows)),), findings=tuple(findings),
        notes=("new bins are brought ahead by all; a schedule is solved anew at every decision, its first trips are begun",),
        **done.progress(),
    )  # fmt: skip


def look_ahead_rows(days: "pd.DataFrame") -> list[dict[str, Any]]:
    """Mean steps of each method, and how far above the auction on the same days."""
    rows = []
    for robots, alike in days.groupby("robots"):
        for method in METHODS:
            row: dict[str, Any] = {"robots": int(str(robots)), "method": method, "days": alike["seed"].nunique()}
            row["steps"], row[f"steps{HALF}"] = mean_interval(alike[alike["method"] == method]["finished"])
            row["above"], row[f"above{HALF}"] = apart(alike, "finished", method, "auction")
            rows.append(row)
    return rows


@figure("orchard-look-ahead", 6.5, 3.2)
def _figure(figure: Any, rows: "pd.DataFrame") -> None:
    """Steps above the auction's on the same days, over the number of robots."""
    ax = figure.subplots()
    for method, colour in COLOURS.items():
        own = rows[rows["method"] == method]
        band(ax, own["robots"], own["above"], own[f"above{HALF}"], color=colour, marker="o", markersize=3, label=method)
    ax.set_xlabel("robots", fontsize=9)
    ax.legend(frameon=False, fontsize=8)
    plain(ax, "steps above the auction, on the same days")
