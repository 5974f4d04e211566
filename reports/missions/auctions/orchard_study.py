"""Days in the orchard after Zhang (2015), chapter 3: how much of the gain is the auction's, and how much that of bringing bins ahead.

Run as ``python -m waybound.reports.missions.orchard_study --out FOLDER [--short]``.

- Ablation: choice of bins (greedy, auction) by delivery of new ones (baseline, proposed), for 2 to 20 robots, and 4 and 8 groups. The
  source compares the first with the last of the four alone.
- Auctions: how many were held among several robots, and how many of them an assignment beats.
- Small orchards: the rules beside the optimum of the whole day.

All rules meet the same days. Intervals are of confidence 95 %, by Student's t; differences are taken day by day.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from waybound.instances.atomic import atomic_write
from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.auctions.orchard_rules import OrchardRules, draw_routes

from .._study_command import study_command
from .._study_figures import _band, _figure, _plain, _save
from .._study_tables import markdown, mean_interval, records

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
        row: dict[str, Any] = {"groups": groups, "robots": robots, "method": method, "least": alike["least"].iloc[0]}
        for key in ("steps", "returned", "idle"):
            row[key], row[f"{key}_half"] = mean_interval(alike[key])
        rows.append(row)
    return pd.DataFrame(rows)


def effects_table(days: pd.DataFrame) -> pd.DataFrame:
    """Steps that each change saves on the same day, in percent of the baseline's: the auction with either delivery, the delivery with
    either choice, both."""
    import pandas as pd

    rows = []
    for (groups, robots), alike in days.groupby(["groups", "robots"], sort=False):
        steps = alike.pivot_table(index="seed", columns="method", values="steps")
        row: dict[str, Any] = {"groups": groups, "robots": robots}
        for name, (before, after, _) in EFFECTS.items():
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
    changes = {
        "both changes": "both",
        "the auction alone": "auction (baseline)",
        "the auction where new bins are brought ahead": "auction (proposed)",
        "bringing new bins ahead alone": "delivery (greedy)",
    }
    verdicts = []
    effects = records(effects_table(days))
    for groups, (change, name) in product(dict.fromkeys(row["groups"] for row in effects), changes.items()):
        own = [row for row in effects if row["groups"] == groups]
        less, more = ([row["robots"] for row in own if sign * row[name] > row[f"{name} half"]] for sign in (1, -1))
        verdicts.append((f"{groups} groups, {change}", f"shorter for {_ranges(less)}, longer for {_ranges(more)} robots"))
    return verdicts


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


def ablation_figure(steps: pd.DataFrame, effects: pd.DataFrame, path: Path) -> None:
    """One row a number of groups: steps of each method over the number of robots, and what each change saves; bands are the intervals."""
    from matplotlib.ticker import NullFormatter, ScalarFormatter

    groups = sorted(set(steps["groups"]))
    figure = _figure(11.0, 0.6 + 3.6 * len(groups))
    axes = figure.subplots(len(groups), 2, squeeze=False, sharex=True)
    for (left, right), count in zip(axes, groups, strict=True):
        own = steps[steps["groups"] == count]
        for method, colour in COLOURS.items():
            line = own[own["method"] == method]
            _band(left, line["robots"], line["steps"], line["steps_half"], color=colour, label=method)
        floor = own.drop_duplicates("robots")
        left.plot(floor["robots"], floor["least"], color="#222222", linewidth=0.9, linestyle=(0, (5, 3)), label="no rule can take fewer")
        left.set_yscale("log")
        left.set_yticks([100, 200, 400, 800])
        left.yaxis.set_major_formatter(ScalarFormatter())
        left.yaxis.set_minor_formatter(NullFormatter())
        left.set_ylabel("steps until all bins are home", fontsize=9)
        _plain(left, f"{count} groups: steps")
        saved = effects[effects["groups"] == count]
        for effect, (_, _, colour) in EFFECTS.items():
            _band(right, saved["robots"], saved[effect], saved[f"{effect} half"], color=colour, label=effect)
        right.axhline(0.0, color="#999999", linewidth=0.8)
        right.set_ylabel("percent of the baseline's steps saved", fontsize=9)
        _plain(right, f"{count} groups: what each change saves on the same day")
    for ax in axes[-1]:
        ax.set_xlabel("robots", fontsize=9)
        ax.locator_params(axis="x", integer=True)
    axes[0][0].legend(frameon=False, fontsize=8)
    figure.legend(*axes[0][1].get_legend_handles_labels(), loc="outside lower right", ncols=len(EFFECTS), frameon=False, fontsize=8)
    _save(figure, path)


def study(folder: Path, size: Size) -> str:
    """Play everything, write it into ``folder``, and return the summary."""
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
    ablation_figure(tables["steps"][1], tables["effects"][1], folder / "orchard.png")
    atomic_write(folder / "summary.md", text)
    return text


def main(arguments: list[str] | None = None) -> int:
    """Play the study and print its summary."""
    return study_command("orchard_study", __doc__, lambda folder, short: study(folder, SHORT if short else Size()), arguments, "days")
