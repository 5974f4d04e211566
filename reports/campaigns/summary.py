"""A campaign in one table: a row each method, over the cases that all methods answered."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...formulations.rendering import percent
from ..tables.table import Column, Table
from .frames import documents
from .measures import primal_integral, shifted_geometric_mean

if TYPE_CHECKING:
    import pandas as pd

MANY = 20_000
"""Runs beyond which no primal integrals are looked for: each takes reading the course of a search."""


_KEY = ["instance", "file_hash", "setting_hash", "seed"]


def primal_integrals(runs: pd.DataFrame, path: Path) -> pd.Series[float]:
    """The primal integral of each run up to its time limit, in seconds, against the best answer that is known for its case.

    ``runs`` are of ``counted``, with the column ``setting_hash``. A run whose answer does not count has the whole time limit; NaN where no
    answer of the case does.
    """
    import pandas as pd

    histories = runs[_KEY].reset_index().merge(documents(path, "history"), on=_KEY, how="left").set_index("index")["history"]
    integrals = {}
    for at, limits, best, known, sense, counts in runs[["limits", "best", "known", "sense", "counts"]].itertuples(name=None):
        until = float(json.loads(limits)["time_limit"])
        reference = best if math.isnan(known) else (max if sense == "max" else min)(best, known)
        history = histories.get(at)
        if not counts or not isinstance(history, str):
            integrals[at] = until if not math.isnan(reference) else math.nan
            continue
        events = [(seconds, objective[0]) for seconds, _, objective, *_ in json.loads(history) if objective and objective[0] is not None]
        integrals[at] = primal_integral([s for s, _ in events], [v for _, v in events], reference, until)
    return pd.Series(integrals, dtype=float)


@dataclass(frozen=True)
class MethodSummary:
    """One method over a campaign: its runs, the answers that count, optima by a verified bound (``proved``) or by its own word
    (``claimed``), and runs that ended in an error.

    All else is over the common cases: mean gaps to the best answer of all, the best known value and the best verified bound, the shifted
    geometric mean of the search's seconds, and the mean primal integral in seconds.
    """

    method: str
    runs: int
    answers: int
    proved: int
    claimed: int
    errors: int
    gap_to_best: float | None
    gap_to_known: float | None
    gap_to_bound: float | None
    seconds: float | None
    primal_integral: float | None


@dataclass(frozen=True)
class Summary:
    """A campaign, method by method, what a reader must know of the comparison, and how many runs failed a check."""

    methods: tuple[MethodSummary, ...]
    notes: tuple[str, ...]
    failed_checks: int = 0

    def to_json(self) -> list[dict[str, Any]]:
        return [asdict(one) for one in self.methods]


def summary_of(runs: pd.DataFrame, path: Path) -> Summary:
    """The summary of results: ``runs`` are of ``counted``, and the results file has the courses of the searches."""
    import numpy as np

    runs = runs.assign(primal_integral=primal_integrals(runs, path) if len(runs) <= MANY else np.nan)
    methods = int(runs["who"].nunique())
    answered = runs[runs["counts"]].groupby(["case", "seed"])["who"].nunique()
    common = set(answered[answered == methods].index)
    shared = np.array([key in common for key in zip(runs["case"], runs["seed"], strict=True)], dtype=bool)
    notes = _notes(runs, len(common), bool(methods > 1))
    fair = runs[shared] if common else runs[runs["counts"]]
    by_method = dict(iter(fair.groupby("who")))
    rows = [_method(str(who), own, by_method.get(who, fair.iloc[:0])) for who, own in runs.groupby("who")]
    rows.sort(key=lambda one: (one.gap_to_best is None, one.gap_to_best or 0.0, one.method))
    failing = int(((runs["faults"].fillna(0) > 0) | (runs["error_code"] == "check-failed")).sum())
    return Summary(tuple(rows), tuple(notes), failing)


def _method(who: str, own: pd.DataFrame, fair: pd.DataFrame) -> MethodSummary:
    def mean(name: str) -> float | None:
        values = fair[name].dropna()
        return float(values.mean()) if len(values) else None

    optimal = own["counts"] & (own["status"] == "optimal")
    proved = optimal & (own["bound_kind"] == "verified")
    return MethodSummary(
        who, len(own), int(own["counts"].sum()), int(proved.sum()), int((optimal & ~proved).sum()), int((own["status"] == "error").sum()),
        mean("gap_to_best"), mean("gap_to_known"), mean("gap_to_bound"),
        shifted_geometric_mean(fair["seconds"].dropna()) if len(fair) else None, mean("primal_integral"),
    )  # fmt: skip


def _notes(runs: pd.DataFrame, common: int, several: bool) -> list[str]:
    """Remarks that a reader must know before comparing."""
    notes = []
    pairs = len(runs[["case", "seed"]].drop_duplicates())
    if several:
        of = f"{common} of {pairs} cases (instance and seed)"
        notes.append(
            f"means are over {of} that all methods answered" if common else f"no case was answered by all methods (of {pairs}): means are "
            "over those that each answered, and cannot be compared"
        )  # fmt: skip
    if runs.groupby("case")["limits"].nunique().max() > 1:
        notes.append("limits differ between methods")
    if runs["levels"].notna().any():
        notes.append("objectives in order of priority are compared by their first level alone")
    if (contradicted := int((runs["faults"].fillna(0) > 0).sum())) > 0:
        notes.append(f"{contradicted} runs failed a check, and are not counted")
    return notes


def summary_table(summary: Summary) -> Table:
    """The table of a summary; columns of which nothing is known are left out."""

    def signed(value: float | None) -> str:
        return percent(value) if value is None or value >= 0.0 else f"-{percent(-value)}" if percent(-value) != "0 %" else "0 %"

    def seconds(value: float | None) -> str:
        return "-" if value is None else f"{value:.3g}"

    rows = [
        (
            m.method, str(m.runs), str(m.answers), str(m.proved), str(m.claimed), str(m.errors), percent(m.gap_to_best),
            signed(m.gap_to_known), percent(m.gap_to_bound), seconds(m.seconds), seconds(m.primal_integral),
        )
        for m in summary.methods
    ]  # fmt: skip
    names = (
        "method", "runs", "answers", "proved", "claimed", "errors", "to best", "to best known", "to bound", "seconds", "primal integral",
    )  # fmt: skip
    kept = [k for k in range(len(names)) if k < 6 or any(row[k] != "-" for row in rows)]
    columns = tuple(Column(names[k], right=k > 0) for k in kept)
    return Table("Campaign", columns, tuple(tuple(row[k] for k in kept) for row in rows))
