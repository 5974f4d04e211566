"""Tracking: what greedy expects of binary and of inverse-distance weights, after Sung (2019), section 3.5.3."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...plots.drawing import plain
from ..findings import LOST, Finding
from ..frames import HALF, by_method, frame_table, mean_interval, play
from ..processes import spread
from ..study import Report, StudySetting, figure, study

if TYPE_CHECKING:
    import pandas as pd

WEIGHTS: dict[str, dict[str, Any]] = {
    "binary": {"heuristic": "sequential-greedy", "weights": "binary"},
    "inverse-distance": {"heuristic": "sequential-greedy", "weights": "inverse-distance"},
    "binary, noisy": {"heuristic": "sequential-greedy", "weights": "binary", "noise": 0.25},
    "inverse-distance, noisy": {"heuristic": "sequential-greedy", "weights": "inverse-distance", "noise": 0.25},
}
COLOURS = dict(zip(WEIGHTS, ("#332288", "#CC3377", "#33AADD", "#DDAA33"), strict=True))

NOTES = (
    "all methods meet the same targets; intervals are of confidence 95 % over runs, leads are taken run by run",
    "noisy: coordinates are measured with a standard deviation of a twentieth of the sensing range",
)

MEASURES = ("estimated_targets", "actual_targets", "estimated_value", "actual_value")


@study(
    "tracking-weights",
    "binary and inverse-distance weights: what greedy expects, and what comes true",
    10,
    short=2,
    source="Sung (2019), section 3.5.3, Figs. 3.9 to 3.13",
    claim="estimates of visibility agree well with the actual ones, those of inverse distances differ much more",
)
def tracking_weights(setting: StudySetting) -> Report:
    """See ``Study.run``; 22 cycles of planning, 8 s each, are the source's three minutes."""
    steps, keep = 22 if setting.full else 4, ("step", "observed", *MEASURES)
    tasks: list[Any] = [("tracking", WEIGHTS, steps, seed, {"scenario": "gazebo-greedy"}, {}, keep) for seed in setting.seeds]
    done = spread(play, tasks, setting.jobs, setting.told, lambda task: f"run {task[3]}")
    rows = weight_rows(done.rows)
    return Report(
        "tracking-weights", tracking_weights.summary,
        frame_table("Estimated and actual, means of steps; errors are |estimated - actual| / actual, means of runs", rows), tuple(rows),
        tuple(done.rows), figures=(weights_figure(done.rows),),
        notes=NOTES,
        findings=tuple(weight_findings(rows, done.rows)), **done.progress(),
    )  # fmt: skip


def weight_rows(logs: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Mean estimated and actual figures, and the mean of each step's relative error, for numbers and values."""
    rows = []
    for method, log in by_method(logs):
        row: dict[str, Any] = {"weights": method}
        for what in ("targets", "value"):
            row |= {f"{kind}_{what}": float(log[f"{kind}_{what}"].mean()) for kind in ("estimated", "actual")}
            row[f"{what}_error"], row[f"{what}_error{HALF}"] = mean_interval(_errors(log, what))
        row["observed"], row[f"observed{HALF}"] = mean_interval(log.groupby("seed")["observed"].mean())
        rows.append(row)
    return rows


def _errors(log: "pd.DataFrame", what: str) -> "pd.Series[float]":
    """Mean relative error of each run, over steps with an actual value."""
    actual = log[f"actual_{what}"]
    return ((log[f"estimated_{what}"] - actual).abs() / actual.where(actual > 0)).groupby(log["seed"]).mean()


def weight_findings(rows: Sequence[dict[str, Any]], logs: Sequence[dict[str, Any]]) -> list[Finding]:
    """The source's claims, with exact and with noisy measurements."""
    errors = {method: _errors(log, "value") for method, log in by_method(logs)}
    findings = [Finding("Figs. 3.10 to 3.13: estimated against actual", "plotted", "see the table", LOST, "the plots' numbers are lost")]
    for row in rows:
        if row["weights"].startswith("binary"):
            said, good = f"{row['targets_error']:.1%} apart in the mean", row["targets_error"] < 0.1
            findings.append(Finding.of_fact(f"numbers of targets, {row['weights']}", "agree well", said, good))
    for kind in ("", ", noisy"):
        lead, half = mean_interval(100.0 * (errors[f"inverse-distance{kind}"] - errors[f"binary{kind}"]))
        why = "positions are measured without noise, and targets predicted on straight lines"
        findings.append(Finding.of_lead(f"error of inverse distances above binary{kind}", "much larger", lead, half, "points", why))
    return findings


@figure("tracking-weights", 9.0, 4.4)
def weights_figure(figure: Any, logs: Sequence[dict[str, Any]]) -> None:
    """Estimated against actual, all steps: number of targets, and value of the objective; a step on the diagonal came true."""
    axes = figure.subplots(1, 2)
    for ax, what, title in zip(axes, ("targets", "value"), ("number of targets", "value, relative to the largest"), strict=True):
        for k, (method, log) in enumerate(by_method(logs)):
            estimated, actual = log[f"estimated_{what}"].to_numpy(), log[f"actual_{what}"].to_numpy()
            scale = 1.0 if what == "targets" else max(np.nanmax(estimated), np.nanmax(actual), 1e-9)
            ax.plot(actual / scale, estimated / scale, "ox"[k % 2], color=COLOURS[method], markersize=4, alpha=0.6, label=method)
        low, high = min(ax.get_xlim()[0], ax.get_ylim()[0]), max(ax.get_xlim()[1], ax.get_ylim()[1])
        ax.plot([low, high], [low, high], color="#999999", linewidth=0.8, linestyle=(0, (5, 3)))
        ax.set_xlabel("actual", fontsize=9)
        ax.set_ylabel("estimated", fontsize=9)
        plain(ax, title)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=9)
