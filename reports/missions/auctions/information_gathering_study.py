"""Partition against auction in information gathering, after Zhang (2015), chapter 4.

Run as ``python -m waybound.reports.missions.information_gathering_study --out FOLDER [--short]``.

Teams of 2 to 5 robots empty ten sensors for 1,000 steps. The sensors are shared out once (distributed sampling, tours by urgency with a
look-ahead of one or three stops, or by literal urgency), or by an auction in a fixed order whenever a robot is back. All methods meet the
same sensors. Intervals are of confidence 95 %, by Student's t; differences are taken run by run.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from waybound.instances.atomic import atomic_write

from .._study_command import study_command
from .._study_figures import _band, _figure, _plain, _save
from .._study_tables import markdown, mean_interval, records

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

METRICS = {"gain": 1, "idle": -1, "loss": -1}
"""1 for what should be large, -1 for what should be small."""


@dataclass(frozen=True)
class Size:
    """Teams, runs and steps; steps, sensors and robots are the source's."""

    robots: tuple[int, ...] = (2, 3, 4, 5)
    runs: int = 40
    steps: int = 1000


SHORT = Size(robots=(2, 3), runs=2, steps=60)


def plays(size: Size) -> pd.DataFrame:
    """One row a run: robots, seed, method and the metrics at its end."""
    import pandas as pd

    from waybound import run

    rows = []
    for robots, seed, (method, how) in product(size.robots, range(1, size.runs + 1), METHODS.items()):
        log = run("information-gathering", steps=size.steps, seed=seed, robots=robots, **how)
        if log.attrs["limit"] == "interrupt":
            raise KeyboardInterrupt
        last = log.iloc[-1]
        rows.append({"robots": robots, "seed": seed, "method": method, **{name: float(last[name]) for name in METRICS}})
    return pd.DataFrame(rows)


def means_table(runs: pd.DataFrame) -> pd.DataFrame:
    """Mean of each metric with its interval, and by how much it lies above the auction's on the same runs."""
    import pandas as pd

    rows = []
    for robots, alike in runs.groupby("robots", sort=False):
        for method in METHODS:
            row: dict[str, Any] = {"robots": robots, "method": method}
            for name in METRICS:
                values = alike.pivot_table(index="seed", columns="method", values=name)
                row[name], row[f"{name}_half"] = mean_interval(values[method])
                row[f"{name}_above"], row[f"{name}_above_half"] = mean_interval(values[method] - values["auction"])
            rows.append(row)
    return pd.DataFrame(rows)


def trends(table: pd.DataFrame) -> list[tuple[str, str]]:
    """The source's trends, and whether they were found."""
    rows = {(row["robots"], row["method"]): row for row in records(table)}
    teams = sorted({robots for robots, _ in rows})
    verdicts = []
    for name, sign in METRICS.items():
        said = []
        for robots in teams:
            row = rows[robots, "partition, look-ahead 3"]
            above, half = sign * row[f"{name}_above"], row[f"{name}_above_half"]
            verdict = "yes" if above > half else "no" if above < -half else "undecided"
            said.append(f"{robots} robots {verdict} ({row[f'{name}_above']:+.0f} +- {half:.0f})")
        verdicts.append((f"partition better than the auction in {name}", "; ".join(said)))
    for method in ("auction", "partition, look-ahead 3"):
        gains = [rows[robots, method]["gain"] for robots in teams]
        verdicts.append((f"{method}: gain grows with the team", "yes" if gains == sorted(gains) else "no"))
    apart = [abs(rows[m, "partition, look-ahead 1"]["gain"] / rows[m, "partition, look-ahead 3"]["gain"] - 1.0) for m in teams]
    verdict = f"{'yes' if max(apart) < 0.05 else 'no'} (gain by {max(apart):.1%} at most)"
    verdicts.append(("look-ahead of one and of three stops differ slightly", verdict))
    return verdicts


def metrics_figure(table: pd.DataFrame, path: Path) -> None:
    """Each metric over the number of robots, and below it its lead over the auction on the same runs; bands are the intervals."""
    figure = _figure(11.0, 6.6)
    axes = figure.subplots(2, len(TITLES), sharex=True)
    for column, (name, title) in enumerate(TITLES.items()):
        for ax, key in zip(axes[:, column], (name, f"{name}_above"), strict=True):
            for method, colour in COLOURS.items():
                own = table[table["method"] == method]
                _band(ax, own["robots"], own[key], own[f"{key}_half"], 0.22, color=colour, marker="o", markersize=3, label=method)
        axes[0, column].set_ylim(bottom=0)
        axes[1, column].set_xlabel("robots", fontsize=9)
        axes[1, column].locator_params(axis="x", integer=True)
        _plain(axes[0, column], title)
        _plain(axes[1, column], "above the auction, on the same runs")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=len(COLOURS), frameon=False, fontsize=9)
    _save(figure, path)


def study(folder: Path, size: Size) -> str:
    """Play everything, write it into ``folder``, and return the summary."""
    runs = plays(size)
    table = means_table(runs)
    text = f"# Information gathering: partition against auction, {size.runs} runs of {size.steps} steps\n\n{markdown(table)}\n"
    text += "## Trends of the source\n\n" + "".join(f"- {what}: {said}\n" for what, said in trends(table))
    atomic_write(folder / "means.csv", table.to_csv(index=False))
    atomic_write(folder / "runs.csv", runs.to_csv(index=False))
    metrics_figure(table, folder / "gathering.png")
    atomic_write(folder / "summary.md", text)
    return text


def main(arguments: list[str] | None = None) -> int:
    """Play the study and print its summary."""
    return study_command(
        "information_gathering_study", __doc__, lambda folder, short: study(folder, SHORT if short else Size()), arguments, "steps"
    )
