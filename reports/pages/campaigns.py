"""The page of a campaign: how the methods compare, by how much they differ case by case, and every run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...formulations.rendering import Line
from ..campaigns.frames import FIRST
from ..campaigns.paired_tests import against as tests_against, paired_table
from ..campaigns.profiles import draw_profile, profile
from ..campaigns.summary import Summary, summary_of, summary_table
from ..plots.drawing import COLOURS, INK, axes_without_display, chart_axes, entitle
from .blocks import DataTable, Facts, Figure, Folded, Section, Text
from .page import Page
from .rendering import Block

if TYPE_CHECKING:
    import pandas as pd

GAPS = {
    "gap_to_known": "Gap to the best known value", "gap_to_best": "Gap to the best answer of all",
    "gap_to_bound": "Gap to the verified bound",
}  # fmt: skip
"""Columns of gaps, with titles that name the other side."""


def campaign_page(runs: pd.DataFrame, path: Path, *, name: str, planned: int, against: str | None = None) -> Page:
    """The page of a campaign's results, which are of ``counted`` and not empty.

    ``path`` is the results file, for the courses of the searches, ``planned`` the number of runs that the campaign asks for, and
    ``against`` a method that all others are tested against.
    """
    summary = summary_of(runs, path)
    methods = runs["who"].nunique()
    blocks: list[Block] = [Facts(_overview(runs, summary, planned)), DataTable(summary_table(summary), title="Methods")]
    if summary.notes:
        blocks.append(Text("\n".join(f"- {note}" for note in summary.notes)))
    if against is not None:
        blocks.append(DataTable(paired_table(tests_against(runs, against), against)))
    blocks.append(Section("Performance profiles", _profiles(runs)))
    blocks.append(Section("Gaps", _gaps(runs)))
    columns = [
        column for column in (*FIRST, "reason") if column in runs and not (column in ("levels", "reason") and runs[column].isna().all())
    ]
    shown = runs[columns].assign(gap=runs["gap"].round(9))
    blocks.append(Folded(f"All {len(runs):,} runs", [DataTable(shown.sort_values(["instance", "method", "seed"]))]))
    return Page(name, f"{methods} methods on {runs['case'].nunique()} instances: a campaign of {planned:,} runs", blocks)


def _overview(runs: pd.DataFrame, summary: Summary, planned: int) -> list[Line]:
    answers, errors = int(runs["counts"].sum()), sum(one.errors for one in summary.methods)
    seeds = sorted(runs["seed"].unique())
    lines = [
        Line("runs", f"{len(runs):,} of {planned:,} are done", "plain" if len(runs) == planned else "bad"),
        Line("answers", f"{answers:,}, each checked from the data"),
        Line("optima", f"{sum(m.proved for m in summary.methods):,} verified, {sum(m.claimed for m in summary.methods):,} claimed"),
        Line("errors", f"{errors:,}", "bad" if errors else "quiet"),
        Line("failed checks", f"{summary.failed_checks:,}, which count nowhere", "bad" if summary.failed_checks else "quiet"),
        Line("seeds", ", ".join(map(str, seeds)) if len(seeds) <= 10 else f"{len(seeds)}, from {seeds[0]} to {seeds[-1]}"),
    ]
    for title in ("problem", "convention"):
        if title in runs:
            lines.append(Line(title, ", ".join(map(str, sorted(runs[title].dropna().unique())))))
    return lines


def _profiles(runs: pd.DataFrame) -> list[Block]:
    """Profiles of objectives, and of seconds where some run ended with an optimum."""
    blocks: list[Block] = []
    measures = ["objective", *(["seconds"] if (runs["counts"] & (runs["status"] == "optimal")).any() else [])]
    for measure in measures:
        ax = axes_without_display()
        ax.figure.set_size_inches(8.0, 4.6)
        blocks.append(
            Figure(draw_profile(profile(runs, measure), measure, ax), f"Performance profiles of {runs['who'].nunique()} methods: {measure}")
        )
    return blocks


def _gaps(runs: pd.DataFrame) -> list[Block]:
    """How gaps are spread, and the gap of each method on each instance."""
    known = [name for name in GAPS if runs[name].notna().any()]
    if not known:
        return [Text("No answer counts, so that there are no gaps.")]
    blocks: list[Block] = [Figure(_spread(runs, name), f"{GAPS[name]}, by method") for name in known]
    for name in known:
        table = runs.pivot_table(index=["case", "instance"], columns="who", values=name, aggfunc="mean", sort=True) * 100.0
        table = table.round(4).reset_index().drop(columns="case")
        table.columns.name = None
        blocks.append(Folded(f"{GAPS[name]}, instance by instance", [DataTable(table, note="In percent, mean over seeds.")]))
    return blocks


def _spread(runs: pd.DataFrame, name: str) -> Any:
    """A gap by method: the middle half as a bar with the median, 5 to 95 % as a line, and how many answers there are."""
    gaps = {str(who): own.dropna().to_numpy() * 100.0 for who, own in runs.groupby("who")[name] if own.notna().any()}
    at = np.arange(len(gaps))
    low, first, middle, third, high = np.array([np.quantile(own, (0.05, 0.25, 0.5, 0.75, 0.95)) for own in gaps.values()]).T
    ax = axes_without_display()
    ax.figure.set_size_inches(8.0, 1.4 + 0.34 * len(gaps))
    ax.hlines(at, low, high, color=COLOURS[4], linewidth=1.5)
    ax.barh(at, third - first, left=first, height=0.6, color=COLOURS[4])
    ax.vlines(middle, at - 0.3, at + 0.3, color=INK, linewidth=2.5, zorder=3)
    ax.set_yticks(at, [f"{who} ({len(own)})" for who, own in gaps.items()])
    ax.invert_yaxis()
    ax.set_xlabel("percent", fontsize=9, color="#555555")
    chart_axes(ax)
    entitle(ax, GAPS[name], "median, middle half (bar), 5 to 95 % (line), and the number of answers")
    return ax
