"""Tracking by the bottleneck: the local algorithm beside the optimum, after Sung (2019), section 3.5.3."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...plots.drawing import plain
from ..findings import LOST, Finding
from ..frames import HALF, by_method, frame_table, mean_interval, play
from ..processes import spread
from ..study import Report, StudySetting, figure, study

BOTTLENECK: dict[str, dict[str, Any]] = {
    "exact": {"solver": "highs", "problem": "bottleneck"},
    "lp-rounding": {"heuristic": "lp-rounding", "problem": "bottleneck"},
    "local": {"heuristic": "local", "problem": "bottleneck"},
    "greedy": {"heuristic": "greedy", "problem": "bottleneck"},
    "random": {"heuristic": "random", "problem": "bottleneck"},
    "stay": {"policy": "stay"},
}
"""``lp-rounding`` and ``local`` solve the fractional problem; each robot then takes its largest share."""


COLOURS = dict(zip(BOTTLENECK, ("#117733", "#33AADD", "#CC3377", "#332288", "#777777", "#BBBBBB"), strict=True))

NOTES = ("all methods meet the same targets; intervals are of confidence 95 % over runs, leads are taken run by run",)

_ERRORS: dict[str, Any] = {"error_kw": {"elinewidth": 1.0, "ecolor": "#222222"}, "capsize": 2.0}


@study(
    "tracking-bottleneck",
    "the local algorithm tracks targets beside the optimum, rounding, greedy and random choice",
    10,
    short=2,
    source="Sung (2019), section 3.5.3, Figs. 3.14 to 3.16",
    claim="the local algorithm is comparable to the optimum; one instance is shown",
)
def tracking_bottleneck(setting: StudySetting) -> Report:
    """See ``Study.run``; 20 steps of 2 s are the source's 40 s."""
    keep = ("step", "observed", "candidates", "objective", "estimated_targets", "actual_targets", "estimated_value", "actual_value")
    tasks: list[Any] = [
        ("tracking", BOTTLENECK, 20 if setting.full else 3, seed, {"scenario": "gazebo-local"}, {}, keep) for seed in setting.seeds
    ]
    done = spread(play, tasks, setting.jobs, setting.told, lambda task: f"run {task[3]}")
    rows = bottleneck_rows(done.rows)
    known = {row["method"]: row for row in rows}
    said = ", ".join(f"{name} {known[name]['share_actual']:.3g}" for name in ("exact", "local", "random"))
    near = known["local"]["share_actual"] >= 0.9 * known["exact"]["share_actual"]
    findings = (
        Finding("Fig. 3.16: the paths", "drawn", "see the table", LOST, "one instance, whose seed and targets are lost"),
        Finding.of_fact("share of candidates that stay covered", "comparable to the optimum", said, near),
    )
    return Report(
        "tracking-bottleneck", tracking_bottleneck.summary,
        frame_table("Worst-covered target as predicted and as it came true, share of candidates covered, targets observed", rows),
        tuple(rows), tuple(done.rows), figures=(bottleneck_figure(rows),), notes=NOTES, findings=findings, **done.progress(),
    )  # fmt: skip


def bottleneck_rows(logs: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Worst-covered target as predicted and as it came true, share of candidates covered, and targets observed."""
    rows = []
    for method, log in by_method(logs):
        row: dict[str, Any] = {"method": method}
        row["observed"], row[f"observed{HALF}"] = mean_interval(log.groupby("seed")["observed"].mean())
        if log["candidates"].notna().any():
            row |= {
                "objective": float(log["objective"].mean()), "estimated_value": float(log["estimated_value"].mean()),
                "actual_value": float(log["actual_value"].mean()), "steps_all_covered": float((log["estimated_value"] > 0).mean()),
                "share_estimated": float(log["estimated_targets"].sum() / log["candidates"].sum()),
                "share_actual": float(log["actual_targets"].sum() / log["candidates"].sum()),
            }  # fmt: skip
        rows.append(row)
    return rows


@figure("tracking-bottleneck", 9.0, 3.6)
def bottleneck_figure(figure: Any, rows: Sequence[dict[str, Any]]) -> None:
    """Share of the candidates that stay covered, and targets observed, by method."""
    axes = figure.subplots(1, 2)
    known = [row for row in rows if "share_actual" in row]
    at, colours = np.arange(len(known)), [COLOURS[row["method"]] for row in known]
    axes[0].bar(at - 0.2, [row["share_estimated"] for row in known], 0.38, color=colours, alpha=0.45)
    axes[0].bar(at + 0.2, [row["share_actual"] for row in known], 0.38, color=colours)
    axes[0].set_xticks(at, [row["method"] for row in known], fontsize=8)
    axes[0].set_ylim(0, 1.05)
    plain(axes[0], "share of candidates covered: estimated (pale), actual")
    halves = [row[f"observed{HALF}"] for row in rows]
    means, colours = [row["observed"] for row in rows], [COLOURS[row["method"]] for row in rows]
    axes[1].bar(range(len(rows)), means, 0.7, yerr=halves, color=colours, **_ERRORS)
    axes[1].set_xticks(range(len(rows)), [row["method"] for row in rows], fontsize=8)
    plain(axes[1], "targets observed: time average")
