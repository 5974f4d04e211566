"""Two results files, before and after: is any method worse, beyond noise?"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...instances.errors import UsageError
from ..tables.table import Column, Table
from .counting import CASE, counted
from .measures import SHIFT
from .paired_tests import CONFIDENCE, Paired, interval, paired, relative, units

if TYPE_CHECKING:
    import pandas as pd

PAIR = [*CASE, "method", "seed"]
"""Columns that are the same in both files where two runs are a pair."""

TOLERANCE = 1e-3
"""Relative change of answers and bounds that is none."""

SLOWER = 0.1
"""Relative change of times that is none."""


@dataclass(frozen=True)
class Change:
    """One measure of one method, before and after.

    ``answers`` and ``optima`` are shares of runs, ``objective``, ``bound`` and ``seconds`` relative differences; pairs are instances, or
    runs where there is one instance. ``change`` is the mean, positive where it is worse, between ``low`` and ``high``, its confidence
    interval; ``worse`` says that it is so beyond noise, ``where`` which instances show it by themselves.
    """

    method: str
    measure: str
    pairs: int
    change: float
    low: float
    high: float
    p_value: float
    worse: bool
    where: str = ""


@dataclass(frozen=True)
class Regression:
    """All changes, and what a reader must know of them."""

    changes: tuple[Change, ...]
    notes: tuple[str, ...]

    @property
    def worse(self) -> bool:
        return any(change.worse for change in self.changes)

    def to_json(self) -> dict[str, Any]:
        return {"schema": 1, "worse": self.worse, "changes": [asdict(one) for one in self.changes], "notes": list(self.notes)}


def regression(before: pd.DataFrame, after: pd.DataFrame) -> Regression:
    """Compare the runs that two frames of ``results`` have in common.

    A method is worse where the confidence interval of the mean change lies beyond what is tolerated, over all instances or, corrected for
    their number (Bonferroni), over the seeds of one; or where it lost all answers or all proofs of an instance. Of a single pair nobody
    knows the noise: what is beyond the tolerance counts. Raises UsageError if they have no run in common, or not the same limits.
    """
    a, b = counted(before), counted(after)
    alike = a.merge(b, on=PAIR, suffixes=("_a", "_b"), how="inner")
    if alike.empty:
        raise UsageError("the two files have no run in common: no instance, as it is read, with the same method, options and seed")
    pairs = alike[alike["limits_a"] == alike["limits_b"]].copy()
    differ = alike[~alike["method"].isin(pairs["method"])]
    if len(differ):
        one = differ.iloc[0]
        raise UsageError(f"limits differ, so that nothing can be said of {one['method']}: {one['limits_a']} and {one['limits_b']}")
    notes = [
        f"{missing} runs are in the {name} file alone, and are not compared"
        for name, missing in (("first", len(a) - len(pairs)), ("second", len(b) - len(pairs)))
        if missing > 0
    ]
    same_machine = (pairs["machine_a"].map(_name) == pairs["machine_b"].map(_name)).all()
    if not same_machine:
        notes.append("the runs are from different machines: times are not judged")
    if pairs["levels_a"].notna().any():
        notes.append("objectives in order of priority are compared by their first level alone")
    pairs["case"] = pairs.groupby(CASE, dropna=False).ngroup()
    pairs = pairs.set_index(["case", "seed"])
    changes = [change for method, own in pairs.groupby("method") for change in _changes(str(method), own, bool(same_machine))]
    return Regression(tuple(changes), tuple(notes))


def _name(machine: str) -> Any:
    return json.loads(machine).get("name")


def _changes(method: str, runs: pd.DataFrame, timed: bool) -> list[Change]:
    sign = np.where(runs["sense_a"].fillna(runs["sense_b"]) == "max", -1.0, 1.0)
    proved = [runs[f"counts_{side}"] & (runs[f"status_{side}"] == "optimal") & (runs[f"bound_kind_{side}"] == "verified") for side in "ab"]
    changes = [_lost(method, "answers", runs, runs["counts_a"], runs["counts_b"]), _lost(method, "optima", runs, *proved)]
    both = runs["counts_a"] & runs["counts_b"]
    for measure, name, direction in (("objective", "objective", sign), ("bound", "verified_bound", -sign)):
        valid = both if measure == "objective" else runs["verified_bound_a"].notna() & runs["verified_bound_b"].notna()
        differences = direction * relative(runs[f"{name}_b"], runs[f"{name}_a"])
        changes.append(_judged(method, measure, runs, differences, valid, TOLERANCE))
    if timed:
        ended = both & (runs["limit_a"] != "time") & (runs["limit_b"] != "time")
        longer = np.log((runs["seconds_b"].to_numpy() + SHIFT) / (runs["seconds_a"].to_numpy() + SHIFT))
        changes.append(_judged(method, "seconds", runs, longer, ended, float(np.log1p(SLOWER))))
    return [one for one in changes if one is not None]


def _judged(method: str, measure: str, runs: pd.DataFrame, differences: Any, valid: pd.Series[bool], tolerance: float) -> Change | None:
    """The change of a measure by its mean over the instances, and by each instance with several seeds."""
    import pandas as pd

    d = pd.Series(differences, index=runs.index)[valid.to_numpy()]
    if d.empty:
        return None
    test, own = paired(units(d)), _names(runs)
    cases = {case: values for case, values in d.groupby(level="case") if len(values) > 1}
    each = {case: paired(values, 1.0 - (1.0 - CONFIDENCE) / len(cases)) for case, values in cases.items()}
    guilty = [case for case, one in each.items() if _beyond(one, tolerance)]
    where = ", ".join(own[case] for case in guilty)
    return Change(
        method, measure, test.pairs, test.mean, test.low, test.high, test.p_value, _beyond(test, tolerance) or bool(guilty), where
    )


def _beyond(one: Paired, tolerance: float) -> bool:
    return one.mean > tolerance if one.pairs == 1 else one.low > tolerance


def _lost(method: str, measure: str, runs: pd.DataFrame, before: pd.Series[bool], after: pd.Series[bool]) -> Change | None:
    """The change of the share of runs with an answer, or a proof; one instance that lost all that it had is a change by itself."""
    if not before.any() and not after.any():
        return None
    own = _names(runs)
    difference = before.astype(float) - after.astype(float)
    test = paired(units(difference))
    gone = [case for case in own if before.loc[[case]].all() and not after.loc[[case]].any()]
    worse = bool(gone) or (test.mean > 0.0 and test.low > 0.0)
    return Change(method, measure, test.pairs, test.mean, test.low, test.high, test.p_value, worse, ", ".join(own[case] for case in gone))


def _names(runs: pd.DataFrame) -> dict[Any, str]:
    return {case: str(name) for case, name in runs["instance"].groupby(level="case").first().items()}


def regression_table(made: Regression) -> Table:
    """The table of a regression check: shares in points, relative differences in percent, + where it is worse."""
    rows = []
    for c in made.changes:
        rows.append((c.method, c.measure, str(c.pairs), f"{100 * c.change:+.3g} %", interval(c.low, c.high), f"{c.p_value:.2g}",
                     "worse" if c.worse else "-", c.where))  # fmt: skip
    columns = (
        Column("method"), Column("measure"), Column("pairs", right=True), Column("worse by", right=True),
        Column(f"{100 * CONFIDENCE:g} % interval", right=True), Column("p", right=True), Column("verdict"), Column("where", wide=True),
    )  # fmt: skip
    return Table("Before and after", columns, tuple(rows))
