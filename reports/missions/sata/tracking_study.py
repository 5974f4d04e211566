"""Tracking experiments of Sung (2019), chapter 3, played again: tables, figures and an animation.

Run as ``python -m waybound.reports.missions.tracking_study --out FOLDER [--short]``.

- MATLAB against Parker (Fig. 3.17): greedy, exact, random and the force vectors, over (a) single steps, (b) all steps of long runs and
  (c) their time averages, Parker's metric.
- Gazebo, greedy (Figs 3.9 to 3.13): what was predicted of each step beside what came true, with binary and inverse-distance weights.
- Gazebo, local (Figs 3.14 to 3.16): the bottleneck by exact, rounded, local and greedy answers.

All methods meet the same worlds: the same seeds give the same targets. The source prints no figures; its trends are the yardstick.
"""

from __future__ import annotations

import itertools
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from waybound.instances.atomic import atomic_write

from .._study_command import study_command
from .._study_figures import _figure, _plain, _save
from .._study_tables import markdown, records

if TYPE_CHECKING:
    import pandas as pd

Method = dict[str, Any]

PARKER: dict[str, Method] = {
    "greedy": {"heuristic": "sequential-greedy"},
    "greedy-stay-first": {"heuristic": "sequential-greedy", "order": "fixed"},
    "force-vector": {"policy": "force-vector"},
    "random": {"heuristic": "random"},
    "exact": {"solver": "highs"},
    "stay": {"policy": "stay"},
}
"""The source's greedy goes through the robots by their numbers; it does not say which of equally good primitives it takes: here a
random one, and with ``greedy-stay-first`` rather the robot's own place. ``stay`` tells what the start alone is worth."""

WEIGHTS: dict[str, Method] = {
    "binary": {"heuristic": "sequential-greedy", "weights": "binary"},
    "inverse-distance": {"heuristic": "sequential-greedy", "weights": "inverse-distance"},
    "binary, noisy": {"heuristic": "sequential-greedy", "weights": "binary", "noise": 0.25},
    "inverse-distance, noisy": {"heuristic": "sequential-greedy", "weights": "inverse-distance", "noise": 0.25},
}
"""``noisy``: coordinates are measured with a standard deviation of a twentieth of the sensing range."""

BOTTLENECK: dict[str, Method] = {
    "exact": {"solver": "highs", "problem": "bottleneck"},
    "lp-rounding": {"heuristic": "lp-rounding", "problem": "bottleneck"},
    "local": {"heuristic": "local", "problem": "bottleneck"},
    "greedy": {"heuristic": "greedy", "problem": "bottleneck"},
    "random": {"heuristic": "random", "problem": "bottleneck"},
    "stay": {"policy": "stay"},
}
"""``lp-rounding`` and ``local`` solve the fractional problem; each robot then takes its largest share."""


@dataclass(frozen=True)
class Size:
    """Amount of play; the defaults are the source's, a Gazebo step being one cycle of planning (8 s, and 2 s for the local one)."""

    targets: tuple[int, ...] = (10, 20, 30)
    instances: int = 200
    steps: int = 200
    trials: int = 10
    gazebo_steps: int = 22
    local_steps: int = 20
    film_steps: int = 100


SHORT = Size(targets=(10, 20), instances=3, steps=5, trials=2, gazebo_steps=4, local_steps=3, film_steps=3)


def plays(methods: dict[str, Method], seeds: range, steps: int, **settings: Any) -> pd.DataFrame:
    """Logs of all methods and seeds, one below the other, with columns ``method`` and ``seed``."""
    import pandas as pd

    from waybound import run

    logs = []
    for name, method in methods.items():
        for seed in seeds:
            log = run("tracking", steps=steps, seed=seed, **settings, **method)
            if log.attrs.pop("limit") == "interrupt":
                raise KeyboardInterrupt
            log.attrs.clear()
            logs.append(log.assign(method=name, seed=seed))
    return pd.concat(logs, ignore_index=True)


def against_parker(size: Size) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Single steps, and long runs: one row a step, with the number of targets."""
    import pandas as pd

    single: list[pd.DataFrame] = []
    long: list[pd.DataFrame] = []
    for count in size.targets:
        for rows, seeds, steps in ((single, size.instances, 1), (long, size.trials, size.steps)):
            rows.append(plays(PARKER, range(1, seeds + 1), steps, scenario="matlab", targets=count).assign(targets=count))
    return pd.concat(single, ignore_index=True), pd.concat(long, ignore_index=True)


def parker_table(single: pd.DataFrame, long: pd.DataFrame) -> pd.DataFrame:
    """Targets observed: mean and deviation of (a), (b), (c), and how far (a) and (c) lie above the force vectors, seed by seed; for (a)
    also of targets kept: observed before and after the step."""
    import pandas as pd

    averages = long.groupby(["targets", "method", "seed"], as_index=False)["observed"].mean()
    rows = []
    figures = (("a_kept", single, "kept"), ("a", single, "observed"), ("b", long, "observed"), ("c", averages, "observed"))
    for count, method in itertools.product(sorted(set(long["targets"])), dict.fromkeys(long["method"])):
        row: dict[str, Any] = {"targets": count, "method": method}
        for key, values, what in figures:
            alike = pd.DataFrame(values[values["targets"] == count])
            own = alike[alike["method"] == method][what]
            row |= {f"{key}_mean": own.mean(), f"{key}_std": own.std(ddof=0)}
            if key != "b":
                row[f"{key}_lead"], row[f"{key}_lead_error"] = paired_lead(alike, what, str(method), "force-vector")
        rows.append(row)
    return pd.DataFrame(rows)


def paired_lead(values: pd.DataFrame, what: str, method: str, other: str) -> tuple[float, float]:
    """Mean difference of a column between two methods on the same seeds, and its standard error."""
    table = values.pivot_table(index="seed", columns="method", values=what)
    difference = table[method] - table[other]
    return float(difference.mean()), float(difference.std(ddof=1) / math.sqrt(len(difference))) if len(difference) > 1 else math.nan


def weights_table(logs: pd.DataFrame) -> pd.DataFrame:
    """Mean estimated and actual figures, and the mean of each step's |estimated - actual| / actual, for numbers and values."""
    import pandas as pd

    rows = []
    for method, log in logs.groupby("method", sort=False):
        row: dict[str, Any] = {"weights": method}
        for what in ("targets", "value"):
            estimated, actual = log[f"estimated_{what}"], log[f"actual_{what}"]
            row |= {f"estimated_{what}": estimated.mean(), f"actual_{what}": actual.mean()}
            row[f"{what}_error"] = ((estimated - actual).abs() / actual.where(actual > 0)).mean()
        rows.append({**row, "observed": log["observed"].mean()})
    return pd.DataFrame(rows)


def bottleneck_table(logs: pd.DataFrame) -> pd.DataFrame:
    """Worst-covered target as predicted and as it came true, share of candidates covered, and targets observed."""
    import pandas as pd

    rows = []
    for method, log in logs.groupby("method", sort=False):
        row: dict[str, Any] = {
            "method": method,
            "observed": log["observed"].mean(),
            "observed_std": log.groupby("seed")["observed"].mean().std(ddof=0),
        }
        if log["candidates"].notna().any():
            row |= {
                "objective": log["objective"].mean(), "estimated_value": log["estimated_value"].mean(),
                "actual_value": log["actual_value"].mean(), "steps_all_covered": (log["estimated_value"] > 0).mean(),
                "share_estimated": log["estimated_targets"].sum() / log["candidates"].sum(),
                "share_actual": log["actual_targets"].sum() / log["candidates"].sum(),
            }  # fmt: skip
        rows.append(row)
    return pd.DataFrame(rows)


def trends(parker: pd.DataFrame, weights: pd.DataFrame) -> list[tuple[str, str]]:
    """The source's trends, and the findings on each."""
    findings = []
    rows: dict[tuple[int, str], dict[str, Any]] = {(row["targets"], row["method"]): row for row in records(parker)}
    counts = sorted({count for count, _ in rows})
    for key, what in (("a_kept", "targets kept in single steps"), ("a", "single steps"), ("c", "time averages")):
        said = []
        for count in counts:
            lead, error = (float(rows[count, "greedy"][f"{key}_{figure}"]) for figure in ("lead", "lead_error"))
            verdict = "yes" if lead > 2 * error else "no" if lead < -2 * error else "undecided"
            said.append(f"{count} targets {verdict} ({lead:+.2f} +- {error:.2f})")
        findings.append((f"greedy above force vectors, {what}", "; ".join(said)))
    for method in ("greedy", "force-vector"):
        grows = all(a < b for a, b in itertools.pairwise(rows[count, method]["c_mean"] for count in counts))
        findings.append((f"{method} grows with the number of targets", "yes" if grows else "no"))
    errors = {row["weights"]: float(row["value_error"]) for row in records(weights)}
    for kind in ("", ", noisy"):
        near, far = errors[f"binary{kind}"], errors[f"inverse-distance{kind}"]
        verdict = f"{'yes' if far > near else 'no'} ({far:.2%} against {near:.2%})"
        findings.append((f"inverse-distance estimates differ more from the actual{kind}", verdict))
    return findings


# -- figures -------------------------------------------------------------------------------------------------------------


COLOURS = {
    "greedy": "#332288", "greedy-stay-first": "#8877CC", "force-vector": "#DDAA33", "random": "#777777", "exact": "#117733",
    "stay": "#BBBBBB", "lp-rounding": "#33AADD", "local": "#CC3377",
    "binary": "#332288", "inverse-distance": "#CC3377", "binary, noisy": "#33AADD", "inverse-distance, noisy": "#DDAA33",
}  # fmt: skip
"""Colours of methods and of weights; alike ones never meet in one picture."""

_ERRORS: dict[str, Any] = {"error_kw": {"elinewidth": 1.0, "ecolor": "#222222"}, "capsize": 2.0}


def draw_parker(table: pd.DataFrame, path: Path) -> None:
    """Targets observed by each method, for each number of targets: (a), (b) and (c), with standard deviations."""
    figure = _figure(11.0, 3.8)
    axes = figure.subplots(1, 3, sharey=True)
    methods, counts = list(dict.fromkeys(table["method"])), sorted(set(table["targets"]))
    width = 0.8 / len(methods)
    for ax, key, title in zip(axes, "abc", ("(a) single steps", "(b) all steps of long runs", "(c) time averages"), strict=True):
        for k, method in enumerate(methods):
            own = table[table["method"] == method].set_index("targets").loc[counts]
            at = np.arange(len(counts)) + (k - (len(methods) - 1) / 2) * width
            ax.bar(at, own[f"{key}_mean"], width * 0.92, yerr=own[f"{key}_std"], color=COLOURS[method], label=method, **_ERRORS)
        ax.set_xticks(range(len(counts)), [str(count) for count in counts])
        ax.set_xlabel("targets", fontsize=9)
        _plain(ax, title)
    axes[0].set_ylabel("targets observed: mean, standard deviation", fontsize=9)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(methods), frameon=False, fontsize=9)
    _save(figure, path)


def draw_weights(logs: pd.DataFrame, path: Path) -> None:
    """Estimated against actual, all steps: number of targets, and value of the objective; a step on the diagonal came true."""
    figure = _figure(9.0, 4.4)
    axes = figure.subplots(1, 2)
    for ax, what, title in zip(axes, ("targets", "value"), ("number of targets", "value, relative to the largest"), strict=True):
        for k, (method, log) in enumerate(logs.groupby("method", sort=False)):
            estimated, actual = log[f"estimated_{what}"].to_numpy(), log[f"actual_{what}"].to_numpy()
            scale = 1.0 if what == "targets" else max(np.nanmax(estimated), np.nanmax(actual), 1e-9)
            ax.plot(actual / scale, estimated / scale, "ox"[k % 2], color=COLOURS[str(method)], markersize=4, alpha=0.6, label=str(method))
        low, high = min(ax.get_xlim()[0], ax.get_ylim()[0]), max(ax.get_xlim()[1], ax.get_ylim()[1])
        ax.plot([low, high], [low, high], color="#999999", linewidth=0.8, linestyle=(0, (5, 3)))
        ax.set_xlabel("actual", fontsize=9)
        ax.set_ylabel("estimated", fontsize=9)
        _plain(ax, title)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    _save(figure, path)


def draw_bottleneck(table: pd.DataFrame, path: Path) -> None:
    """Share of the candidates that stay covered, and targets observed, by method."""
    figure = _figure(9.0, 3.6)
    axes = figure.subplots(1, 2)
    known = table.dropna(subset=["share_actual"])
    at = np.arange(len(known))
    axes[0].bar(at - 0.2, known["share_estimated"], 0.38, color=[COLOURS[m] for m in known["method"]], alpha=0.45)
    axes[0].bar(at + 0.2, known["share_actual"], 0.38, color=[COLOURS[m] for m in known["method"]])
    axes[0].set_xticks(at, known["method"], fontsize=8)
    axes[0].set_ylim(0, 1.05)
    _plain(axes[0], "share of candidates covered: estimated (pale), actual")
    axes[1].bar(
        range(len(table)), table["observed"], 0.7, yerr=table["observed_std"], color=[COLOURS[m] for m in table["method"]], **_ERRORS
    )
    axes[1].set_xticks(range(len(table)), table["method"], fontsize=8)
    _plain(axes[1], "targets observed: time average")
    _save(figure, path)


# -- the whole study -----------------------------------------------------------------------------------------------------


def study(folder: Path, size: Size) -> str:
    """Play everything, write it into ``folder``, and return the summary."""
    from waybound import run

    from ..animation import Film
    from .tracking import Tracking

    single, long = against_parker(size)
    seeds = range(1, size.trials + 1)
    gazebo = plays(WEIGHTS, seeds, size.gazebo_steps, scenario="gazebo-greedy")
    local = plays(BOTTLENECK, seeds, size.local_steps, scenario="gazebo-local")
    tables = {
        "parker": parker_table(single, long), "weights": weights_table(gazebo), "bottleneck": bottleneck_table(local),
    }  # fmt: skip
    heads = {
        "parker": f"MATLAB against Parker: targets observed. (a) {size.instances} single steps; (b) all steps and (c) time averages of "
        f"{size.trials} runs of {size.steps} steps; lead over force-vector on the same seeds, with its standard error",
        "weights": f"Gazebo, greedy: estimated and actual, {size.trials} runs of {size.gazebo_steps} steps",
        "bottleneck": f"Gazebo, local: bottleneck, {size.trials} runs of {size.local_steps} steps",
    }
    text = "# Tracking study\n"
    for key, table in tables.items():
        text += f"\n## {heads[key]}\n\n{markdown(table)}"
        atomic_write(folder / f"{key}.csv", table.to_csv(index=False))
    text += "\n## Trends of the source\n\n" + "".join(f"- {what}: {said}\n" for what, said in trends(tables["parker"], tables["weights"]))
    for name, log in (("single_steps", single), ("long_runs", long), ("gazebo_greedy", gazebo), ("gazebo_local", local)):
        atomic_write(folder / f"log_{name}.csv", log.to_csv(index=False))
    draw_parker(tables["parker"], folder / "parker.png")
    draw_weights(gazebo, folder / "weights.png")
    draw_bottleneck(tables["bottleneck"], folder / "bottleneck.png")
    mission = Tracking()
    film = Film(mission)
    run(mission, steps=size.film_steps, seed=1, scenario="matlab", watch=film, **PARKER["greedy"])
    film.save(folder / "tracking.gif")
    atomic_write(folder / "summary.md", text)
    return text


def main(arguments: list[str] | None = None) -> int:
    """Play the study and print its summary."""
    return study_command(
        "tracking_study", __doc__, lambda folder, short: study(folder, SHORT if short else Size()), arguments, "steps",
        "tables, figures and the animation",
    )  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
