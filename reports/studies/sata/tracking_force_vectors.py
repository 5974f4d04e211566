"""Tracking: greedy against the force vectors of Parker, after Sung (2019), section 3.5.4."""

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...plots.drawing import plain
from ..findings import LOST, Finding
from ..frames import HALF, apart, frame_table, framed, mean_interval, play
from ..processes import spread
from ..study import Report, StudySetting, figure, study

PARKER: dict[str, dict[str, Any]] = {
    "greedy": {"heuristic": "sequential-greedy"},
    "greedy-stay-first": {"heuristic": "sequential-greedy", "order": "fixed"},
    "force-vector": {"policy": "force-vector"},
    "random": {"heuristic": "random"},
    "exact": {"solver": "highs"},
    "stay": {"policy": "stay"},
}
"""The source's greedy goes through the robots by their numbers; it does not say which of equally good primitives it takes: here a
random one, and with ``greedy-stay-first`` rather the robot's own place. ``stay`` tells what the start alone is worth."""

COLOURS = dict(zip(PARKER, ("#332288", "#8877CC", "#DDAA33", "#777777", "#117733", "#BBBBBB"), strict=True))

TARGETS = (10, 20, 30)

NOTES = (
    "all methods meet the same targets; intervals are of confidence 95 % over runs, leads are taken run by run",
    "kept: observed before and after a step; the breakpoints of forces are ours",
)

_ERRORS: dict[str, Any] = {"error_kw": {"elinewidth": 1.0, "ecolor": "#222222"}, "capsize": 2.0}


@study(
    "tracking-force-vectors",
    "greedy against force vectors: targets observed in single steps and long runs",
    10,
    short=2,
    source="Sung (2019), section 3.5.4, Fig. 3.17",
    claim="greedy observes more targets than Parker's force vectors, in single steps, in long runs and in time averages",
)
def tracking_force_vectors(setting: StudySetting) -> Report:
    """See ``Study.run``; twenty single steps to a long run."""
    counts, steps = (TARGETS, 200) if setting.full else (TARGETS[:2], 5)
    tasks = [
        ("tracking", PARKER, length, seed, {"scenario": "matlab", "targets": count}, {"targets": count, "run": kind},
         ("step", "observed", "kept"))
        for first in setting.seeds for count in counts
        for kind, length, seed in (
            ("long", steps, first), *(("single", 1, 20 * first - k) for k in (range(20) if setting.full else range(2)))
        )
    ]  # fmt: skip
    done = spread(play, tasks, setting.jobs, setting.told, lambda task: f"{task[5]['targets']} targets, {task[5]['run']} run {task[3]}")
    rows = force_vector_rows(done.rows)
    return Report(
        "tracking-force-vectors", tracking_force_vectors.summary,
        frame_table("Targets observed by a method, and its lead over force vectors on the same targets", rows),
        tuple(rows), tuple(done.rows),
        figures=(force_vectors_figure(rows),), notes=NOTES,
        findings=tuple(force_vector_findings(rows)), **done.progress(),
    )  # fmt: skip


def force_vector_rows(logs: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Targets observed and kept in single steps, and the time averages of long runs, each with its lead over force vectors."""
    table = framed(logs)
    single, long = table[table["run"] == "single"], table[table["run"] == "long"]
    averages = long.groupby(["targets", "method", "seed"], as_index=False)["observed"].mean()
    rows = []
    for count, method in itertools.product(sorted(set(table["targets"])), dict.fromkeys(table["method"])):
        row: dict[str, Any] = {"targets": count, "method": method}
        for key, values, what in (("single", single, "observed"), ("kept", single, "kept"), ("average", averages, "observed")):
            alike = values[values["targets"] == count]
            row[key], row[key + HALF] = mean_interval(alike[alike["method"] == method][what])
            if len(alike):
                row[f"{key}_lead"], row[f"{key}_lead{HALF}"] = apart(alike, what, method, "force-vector")
        rows.append(row)
    return rows


def force_vector_findings(rows: Sequence[dict[str, Any]]) -> list[Finding]:
    """The source's claims for each number of targets."""
    known = {(row["targets"], row["method"]): row for row in rows}
    counts = sorted({count for count, _ in known})
    findings = [
        Finding("Fig. 3.17: targets observed", "plotted", "see the table", LOST, "the plots' numbers and Parker's breakpoints are lost")
    ]
    for key, what in (("single", "single steps"), ("kept", "targets kept in single steps"), ("average", "time averages")):
        for count in counts:
            row = known[count, "greedy"]
            why = "a step is seldom worth more than the start is; force vectors spread robots, which pays where targets are few"
            if f"{key}_lead" in row:
                lead, half = row[f"{key}_lead"], row[f"{key}_lead{HALF}"]
                title = f"greedy against force vectors, {what}, {count} targets"
                findings.append(Finding.of_lead(title, "greedy above", lead, half, "", why))
    for method in ("greedy", "force-vector"):
        means = [known[count, method]["average"] for count in counts]
        said = ", ".join(f"{mean:.3g}" for mean in means)
        findings.append(
            Finding.of_fact(f"{method} over the number of targets", "grows", said, all(a < b for a, b in itertools.pairwise(means)))
        )
    return findings


@figure("tracking-force-vectors", 9.5, 3.8)
def force_vectors_figure(figure: Any, rows: Sequence[dict[str, Any]]) -> None:
    """Targets observed by each method, for each number of targets, with intervals."""
    axes = figure.subplots(1, 2, sharey=True)
    methods, counts = list(dict.fromkeys(r["method"] for r in rows)), sorted({r["targets"] for r in rows})
    width = 0.8 / len(methods)
    for ax, key, title in zip(axes, ("single", "average"), ("single steps", "time averages of long runs"), strict=True):
        for k, method in enumerate(methods):
            own = {r["targets"]: r for r in rows if r["method"] == method}
            at = np.arange(len(counts)) + (k - (len(methods) - 1) / 2) * width
            means, halves = ([own[count][name] for count in counts] for name in (key, key + HALF))
            ax.bar(at, means, width * 0.92, yerr=halves, color=COLOURS[method], label=method, **_ERRORS)
        ax.set_xticks(range(len(counts)), [str(count) for count in counts])
        ax.set_xlabel("targets", fontsize=9)
        plain(ax, title)
    axes[0].set_ylabel("targets observed, with intervals", fontsize=9)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(methods), frameon=False, fontsize=9)
