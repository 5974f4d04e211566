"""Days in the orchard after Zhang (2015), chapter 3: how much of the gain is the auction's, and how much that of bringing bins ahead.

Run as ``python -m waybound.reports.missions.orchard_study --out FOLDER [--short]``.

- Ablation: choice of bins (greedy, auction) by delivery of new ones (baseline, proposed), for 2 to 20 robots, and 4 and 8 groups. The
  source compares the first with the last of the four alone.
- Auctions: how many were held among several robots, and how many of them an assignment beats.
- Small orchards: the rules beside the optimum of the whole day.

All rules meet the same days. Intervals are of confidence 95 %, by Student's t; differences are taken day by day.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from waybound.instances.atomic import atomic_write
from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.auctions.orchard_rules import OrchardRules, draw_routes

from .._study_command import study_command
from .._study_tables import markdown, records
from ._mean_intervals import mean_interval

if TYPE_CHECKING:
    import pandas as pd

CHOICES, DELIVERIES = ("greedy", "auction"), ("baseline", "proposed")

METHODS = tuple(f"{choice}+{delivery}" for delivery, choice in product(DELIVERIES, CHOICES))

HORIZON = 150
"""Steps, 15 hours: the source counts the bins returned by then."""


@dataclass(frozen=True)
class Size:
    """Teams and days."""

    robots: tuple[int, ...] = tuple(range(2, 21))
    groups: tuple[int, ...] = (4, 8)
    days: int = 100
    small: int = 10
    small_robots: tuple[int, ...] = (1, 2, 3)


SHORT = Size(robots=(2, 8), groups=(4,), days=3, small=1, small_robots=(3,))


def ablation(size: Size) -> pd.DataFrame:
    """One row a day: groups, robots, seed, method, its steps and other figures, and the least steps of any rule."""
    import pandas as pd

    from .orchard_days.days import least_makespan, play_day

    rows = []
    for groups, robots in product(size.groups, size.robots):
        rules = OrchardRules(OrchardGrid(10, 10), robots, groups)
        least = least_makespan(rules)
        for seed, method in product(range(1, size.days + 1), METHODS):
            choice, delivery = method.split("+")
            day = play_day(rules, seed, choice, delivery)
            rows.append(
                {
                    "groups": groups, "robots": robots, "seed": seed, "method": method, "steps": day.makespan,
                    "returned": day.returned_by(HORIZON), "idle": day.idle_steps * rules.pickers, "auctions": day.auctions,
                    "beaten": day.beaten, "least": least,
                }
            )  # fmt: skip
    return pd.DataFrame(rows)


def steps_table(days: pd.DataFrame) -> pd.DataFrame:
    """Mean steps of each method with intervals, bins returned by the horizon, and steps for which pickers wait."""
    import pandas as pd

    rows = []
    for (groups, robots, method), alike in days.groupby(["groups", "robots", "method"], sort=False):
        steps, half = mean_interval(alike["steps"])
        returned, returned_half = mean_interval(alike["returned"])
        idle, idle_half = mean_interval(alike["idle"])
        rows.append(
            {
                "groups": groups, "robots": robots, "method": method, "least": alike["least"].iloc[0], "steps": steps, "steps_half": half,
                "returned": returned, "returned_half": returned_half, "idle": idle, "idle_half": idle_half,
            }
        )  # fmt: skip
    return pd.DataFrame(rows)


def effects_table(days: pd.DataFrame) -> pd.DataFrame:
    """Steps that each change saves on the same day, in percent of the baseline's: the auction with either delivery, the delivery with
    either choice, both."""
    import pandas as pd

    pairs = {
        "auction (baseline)": ("greedy+baseline", "auction+baseline"), "auction (proposed)": ("greedy+proposed", "auction+proposed"),
        "delivery (greedy)": ("greedy+baseline", "greedy+proposed"), "delivery (auction)": ("auction+baseline", "auction+proposed"),
        "both": ("greedy+baseline", "auction+proposed"),
    }  # fmt: skip
    rows = []
    for (groups, robots), alike in days.groupby(["groups", "robots"], sort=False):
        steps = alike.pivot_table(index="seed", columns="method", values="steps")
        row: dict[str, Any] = {"groups": groups, "robots": robots}
        for name, (before, after) in pairs.items():
            row[name], row[f"{name} half"] = mean_interval(100.0 * (steps[before] - steps[after]) / steps["greedy+baseline"])
        row["both wins"] = float((steps["auction+proposed"] < steps["greedy+baseline"]).mean())
        rows.append(row)
    return pd.DataFrame(rows)


def auctions_table(days: pd.DataFrame) -> pd.DataFrame:
    """Auctions of several robots in all days, and those that an assignment of the same robots beats."""
    own = days[days["method"].str.startswith("auction")]
    table = own.groupby(["groups", "method", "robots"], as_index=False, sort=False)[["auctions", "beaten"]].sum()
    return table.assign(share=table["beaten"] / table["auctions"].where(table["auctions"] > 0))


def small_table(size: Size) -> pd.DataFrame:
    """Whole days of two lanes of four trees: the rules' last steps over the optimum's, with fixed routes of groups."""
    import numpy as np
    import pandas as pd

    from waybound import OrchardDay, OrchardJobs, solve
    from waybound.instances.generators import Draw

    from .orchard_days.days import play_day

    rows = []
    for robots, seed in product(size.small_robots, range(1, size.small + 1)):
        rules = OrchardRules(OrchardGrid(2, 6), robots, 2, bins_per_cell=1)
        start = draw_routes(rules, Draw(np.random.Generator(np.random.PCG64(seed))))
        best = solve(OrchardDay(OrchardJobs.of_routes(rules, start)), "interval-scheduling", bound_time=0.0)
        row: dict[str, Any] = {"robots": robots, "seed": seed, "optimum": best.objective, "status": best.status}
        rows.append(row | {method: play_day(rules, seed, *method.split("+"), start=start).makespan for method in METHODS})
    return pd.DataFrame(rows)


def small_summary(days: pd.DataFrame) -> pd.DataFrame:
    """Mean ratio of each method to the optimum."""
    import pandas as pd

    rows = []
    for robots, alike in days.groupby("robots"):
        row: dict[str, Any] = {"robots": robots, "days": len(alike), "optimum": float(alike["optimum"].mean())}
        for method in METHODS:
            row[method], row[f"{method} half"] = mean_interval(alike[method] / alike["optimum"])
        rows.append(row)
    return pd.DataFrame(rows)


def trends(days: pd.DataFrame) -> list[tuple[str, str]]:
    """The source's trends, and whether they were found."""
    found = []
    effects = records(effects_table(days))
    for groups in dict.fromkeys(row["groups"] for row in effects):
        own = [row for row in effects if row["groups"] == groups]

        def said(name: str, own: list[dict[str, Any]] = own) -> str:
            less, more = ([row["robots"] for row in own if sign * row[name] > row[f"{name} half"]] for sign in (1, -1))
            return f"shorter for {_ranges(less)}, longer for {_ranges(more)} robots"

        found.append((f"{groups} groups, both changes", said("both")))
        found.append((f"{groups} groups, the auction alone", said("auction (baseline)")))
        found.append((f"{groups} groups, the auction where new bins are brought ahead", said("auction (proposed)")))
        found.append((f"{groups} groups, bringing new bins ahead alone", said("delivery (greedy)")))
    return found


def _ranges(numbers: list[int]) -> str:
    """Numbers as text, runs of consecutive ones as ``2-5``."""
    if not numbers:
        return "no"
    runs = [[numbers[0], numbers[0]]]
    for number in numbers[1:]:
        if number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def study(folder: Path, size: Size) -> str:
    """Play everything, write it into ``folder``, and return the summary."""
    from . import _orchard_figures as figures

    days, small = ablation(size), small_table(size)
    tables = {
        "steps": (f"Steps until all are home, bins by step {HORIZON}, waiting; means of {size.days} days", steps_table(days)),
        "effects": ("Percent of greedy+baseline's steps saved on the same days", effects_table(days)),
        "auctions": ("Auctions of several robots, and those that an assignment beats", auctions_table(days)),
        "small": ("Small orchards: last step over the optimum's", small_summary(small)),
    }  # fmt: skip
    text = "# Days in the orchard\n"
    for key, (head, table) in tables.items():
        text += f"\n## {head}\n\n{markdown(table)}"
        atomic_write(folder / f"{key}.csv", table.to_csv(index=False))
    text += "\n## Trends\n\n" + "".join(f"- {what}: {said}\n" for what, said in trends(days))
    atomic_write(folder / "days.csv", days.to_csv(index=False))
    atomic_write(folder / "small_days.csv", small.to_csv(index=False))
    figures.ablation(tables["steps"][1], tables["effects"][1], folder / "orchard.png")
    atomic_write(folder / "summary.md", text)
    return text


def main(arguments: list[str] | None = None) -> int:
    """Play the study and print its summary."""
    return study_command("orchard_study", __doc__, lambda folder, short: study(folder, SHORT if short else Size()), arguments, "days")


if __name__ == "__main__":
    sys.exit(main())
