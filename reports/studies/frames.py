"""Data frames of studies: what missions logged, means with intervals, and tables of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..missions.animation import Film
from ..missions.mission import Mission
from ..tables.table import Column, Table
from .findings import lead_text

if TYPE_CHECKING:
    import pandas as pd


LEVEL = 0.95

HALF = "_half"
"""Ending of the column that holds half the width of the interval of another."""


def completed(mission: str | Mission, **how: Any) -> pd.DataFrame:
    """The log of a run; raises KeyboardInterrupt where it was interrupted, so that methods are compared in whole worlds."""
    from ..missions.running import run

    log = run(mission, **how)
    if log.attrs["limit"] == "interrupt":
        raise KeyboardInterrupt
    return log


def play(
    mission: str, methods: Mapping[str, Mapping[str, Any]], steps: int, seed: int, settings: Mapping[str, Any],
    columns: Mapping[str, Any], keep: Sequence[str], last: bool = False,
) -> list[dict[str, Any]]:  # fmt: skip
    """Rows of the logs of all methods in one world: ``columns``, ``seed``, ``method`` and what to ``keep``, of the ``last`` step or of all.

    A task for ``processes.spread``.
    """
    rows = []
    for name, how in methods.items():
        log = completed(mission, steps=steps, seed=seed, **settings, **how)
        shown = log.iloc[-1:] if last else log
        rows += [{**columns, "seed": seed, "method": name, **{key: row.get(key, math.nan) for key in keep}} for row in records(shown)]
    return rows


def film_of(mission: Mission, seed: int, **how: Any) -> Film:
    """The film of a run: ``how`` it is decided, and settings of the mission."""
    from ..missions.animation import Film
    from ..missions.running import run

    film = Film(mission)
    run(mission, seed=seed, watch=film, **how)
    return film


def records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """The rows of a table by the names of its columns."""
    return [{str(key): value for key, value in row.items()} for row in table.to_dict("records")]


def decision_times(log: pd.DataFrame, of: pd.Series | None = None) -> dict[str, float]:
    """Mean and largest wall time of a decision, in ms: ``of`` these steps, or of all that took time; ``times_apart`` takes them out."""
    seconds = log["seconds"][log["seconds"] > 0 if of is None else of]
    return {"milliseconds": 1e3 * float(seconds.mean()), "slowest": 1e3 * float(seconds.max())}


def times_apart(rows: Sequence[Mapping[str, Any]], key: str = "method") -> tuple[list[dict[str, Any]], Table]:
    """Rows without ``milliseconds`` and ``slowest``, wall times of a decision that no seed reproduces, and a table of these by ``key``."""
    kept = [{name: value for name, value in row.items() if name not in ("milliseconds", "slowest")} for row in rows]
    timed: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        if "milliseconds" in row and key in row:
            timed.setdefault(str(row[key]), []).append((row["milliseconds"], row["slowest"]))
    told = [
        {key: name, "mean_ms": float(np.mean([mean for mean, _ in own])), "slowest_ms": max(slowest for _, slowest in own)}
        for name, own in timed.items()
    ]
    return kept, frame_table("Wall time of a decision", told)


def framed(rows: Iterable[Mapping[str, Any]], key: str = "") -> pd.DataFrame:
    """Rows as a data frame: all, or those that have a ``key``."""
    import pandas as pd

    return pd.DataFrame([row for row in rows if not key or key in row])


def by_method(logs: Sequence[Mapping[str, Any]]) -> list[tuple[str, pd.DataFrame]]:
    """Rows with a column ``method`` as one table per method, in the order in which these come."""
    return [(str(method), log) for method, log in framed(logs).groupby("method", sort=False)]


def mean_interval(values: ArrayLike) -> tuple[float, float]:
    """Mean, and half the width of its interval of confidence ``LEVEL`` by Student's t; NaN for fewer than two values."""
    from scipy import stats

    own = np.asarray(values, dtype=np.float64)
    mean = float(own.mean()) if len(own) else math.nan
    if len(own) < 2:
        return mean, math.nan
    return mean, float(stats.t.ppf((1.0 + LEVEL) / 2.0, len(own) - 1) * own.std(ddof=1) / math.sqrt(len(own)))


def intervals(own: pd.DataFrame, keys: Iterable[str]) -> dict[str, float]:
    """``mean_interval`` of each of these columns without NaN, ``key`` and ``key_half``; nothing of a column without numbers."""
    pairs = {key: mean_interval(own[key].dropna()) for key in keys if not own[key].isna().all()}
    return {name: value for key, pair in pairs.items() for name, value in zip((key, f"{key}{HALF}"), pair, strict=True)}


def apart(alike: pd.DataFrame, key: str, method: str, other: str, worlds: str | list[str] = "seed") -> tuple[float, float]:
    """How far a method lies above another in the mean over the same worlds, and half the width of its interval."""
    pairs = alike.pivot_table(index=worlds, columns="method", values=key)
    return mean_interval((pairs[method] - pairs[other]).dropna())


def method_means(table: pd.DataFrame, methods: Iterable[str], keys: Sequence[str], name: str = "method") -> list[dict[str, Any]]:
    """A row per method, which is told in the column ``name``: mean and interval of each measure."""
    return [{name: method, **intervals(table[table["method"] == method], keys)} for method in methods]


def loop_means(loops: pd.DataFrame, keys: Sequence[str], key: str, most: bool) -> list[dict[str, Any]]:
    """Each way to decide: means, and ``lost``, how far it is behind ``exact`` by ``key``, of which ``most`` or least is best."""
    rows = []
    for method, own in loops.groupby("method", sort=False) if len(loops) else ():
        lost, half = apart(loops, key, *(("exact", str(method)) if most else (str(method), "exact")))
        rows.append({"decided by": method, "runs": len(own), **intervals(own, keys), "lost": lost, f"lost{HALF}": half})
    return rows


def frame_table(title: str, rows: Sequence[Mapping[str, Any]]) -> Table:
    """Rows for people: numbers with four digits, and those with an interval as ``mean ± half``."""
    names = [key for key in dict.fromkeys(key for row in rows for key in row) if not key.endswith(HALF)]
    right = [all(isinstance(row.get(key, 0), int | float | np.number) for row in rows) for key in names]
    columns = tuple(Column(key.replace("_", " "), right=side) for key, side in zip(names, right, strict=True))
    return Table(title, columns, tuple(tuple(_cell(row.get(key), row.get(f"{key}{HALF}")) for key in names) for row in rows))


def _cell(value: Any, half: Any = None) -> str:
    if not isinstance(value, float):
        return "-" if value is None else str(value)
    if math.isnan(value):
        return "-"
    return f"{value:.4g}" if half is None else lead_text(value, half)
