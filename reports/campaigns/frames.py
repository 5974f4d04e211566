"""Results as pandas frames and as files, one row per run."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...instances.atomic import atomic_write
from ...instances.errors import MissingPackageError, UsageError
from ...instances.registry import Registry
from ...instances.suggestions import did_you_mean
from .campaign import Key
from .one_run import COLUMNS, DOCUMENTS
from .results_file import columns_of, opened, readable

if TYPE_CHECKING:
    import pandas as pd

_OF_INSTANCE = {"instance": "name", "file": "file", "file_hash": "hash"}
_OF_SETTING = {
    "solver": "solver", "method": "method", "options": "options", "limits": "limits", "reading": "reading", "setting": "setting",
    "setting_hash": "hash",
}  # fmt: skip
_OF_ENVIRONMENT = {"versions": "versions", "machine": "machine"}
_TABLES = {"instance": ("instances", _OF_INSTANCE), "setting": ("settings", _OF_SETTING), "environment": ("environments", _OF_ENVIRONMENT)}
"""Tables whose rows stand for many runs: the column of ``runs`` that refers to it, its table, and the columns that come from there."""

FIRST = (
    "instance", "solver", "seed", "objective", "bound", "bound_kind", "status", "seconds", "gap", "verified_bound", "checked", "limit",
    "method",
)  # fmt: skip

NAMES = (
    *FIRST,
    *(
        name
        for name in ("options", *COLUMNS, "limits", "reading", "file", "file_hash", "setting", "setting_hash", "versions", "machine")
        if name not in FIRST
    ),
)
"""Columns of a row, in their order."""


def results(path: str | PathLike[str], columns: Sequence[str] | None = None) -> pd.DataFrame:
    """The runs in a results file, one row each.

    Parameters
    ----------
    path : path-like
        A results file, be it that a campaign still writes to it.
    columns : sequence of str, optional
        Those that are needed: of a million runs, all take a while.

    Returns
    -------
    pandas.DataFrame
        Sorted by instance, method and seed. ``instance, solver, seed, objective, bound, bound_kind, status, seconds`` (of the search
        alone), ``gap``, ``verified_bound``, ``checked`` (whether an answer passed every check), ``limit``, ``method`` (the solver and its
        own options), ``options``, ``problem``, ``sense``, ``convention``, ``form``, ``instance_hash``, ``bound_source``, ``levels`` (all
        levels of an objective in order of priority, as JSON), ``faults``, ``reason`` and ``error_code`` of a run that failed,
        ``compile_seconds, bound_seconds, check_seconds, cpu_seconds, run_seconds``, ``began``, ``limits`` and ``reading`` (how the instance
        was read), ``setting``, ``versions`` and ``machine`` (as JSON), ``setting_hash``, ``file``, ``file_hash``.

    Raises
    ------
    InputError
        For a file that is not there, damaged, or of a newer schema.
    UsageError
        For a column that does not exist.
    """
    import pandas as pd

    names = NAMES if columns is None else tuple(columns)
    for name in names:
        if name not in NAMES:
            raise UsageError(f"there is no column {name!r}; there are {', '.join(NAMES)}{did_you_mean(name, NAMES)}", "unknown-name")
    if not names:
        raise UsageError("no column is asked for", "missing")
    file, own = Path(path), [name for name in names if name in COLUMNS]
    with opened(file) as connection, readable(file):
        connection.execute("BEGIN")  # one state of the file for all that follows
        there = columns_of(connection)
        chosen = ", ".join(f'"{name}"' if name in there else "NULL" for name in (*_TABLES, "seed", *own))
        runs = pd.DataFrame(connection.execute(f"SELECT {chosen} FROM runs").fetchall(), columns=[*_TABLES, "the seed", *own])
        shared = {refers: _looked_up(connection, table, known, names) for refers, (table, known) in _TABLES.items()}
    places = {refers: np.searchsorted(numbers, runs[refers].to_numpy(dtype=np.int64)) for refers, (numbers, _, _) in shared.items()}
    order = np.lexsort((runs["the seed"], shared["setting"][1][places["setting"]], shared["instance"][1][places["instance"]]))
    data: dict[str, Any] = {"seed": runs["the seed"].to_numpy(dtype=np.int64)[order]}
    for refers, (_, _, texts) in shared.items():
        data.update({name: values[places[refers][order]] for name, values in texts.items()})
    for name in own:
        data[name] = runs[name].to_numpy()[order].astype(float) if COLUMNS[name] == "REAL" else runs[name].to_numpy()[order]
    frame = pd.DataFrame({name: data[name] for name in names})
    if "checked" in names:
        frame["checked"] = frame["checked"].fillna(0).astype(bool)
    return frame


def _looked_up(
    connection: sqlite3.Connection, table: str, known: dict[str, str], names: Collection[str]
) -> tuple[NDArray[np.int64], NDArray[np.int64], dict[str, NDArray[Any]]]:
    """The rows of a small table by their numbers, the place of each in the order of names, and the columns that are asked for."""
    first = {"instances": "name, hash", "settings": "method, hash", "environments": "id"}[table]
    rows = connection.execute(f"SELECT id, {', '.join(known.values())} FROM {table} ORDER BY {first}").fetchall()
    numbers = np.array([row[0] for row in rows], dtype=np.int64)
    by_number = np.argsort(numbers)
    texts = {}
    for k, name in enumerate(known, start=1):
        if name in names:
            texts[name] = np.array([row[k] for row in rows], dtype=object)[by_number]
    return numbers[by_number], by_number, texts


def documents(path: str | PathLike[str], name: str) -> pd.DataFrame:
    """Documents of all runs, one row each: ``instance, method, seed, file_hash, setting_hash`` and the JSON text under ``name``.

    ``name`` is ``solution`` (with the answer), ``certificate`` (with its evidence) or ``history``. Raises UsageError for another one.
    """
    import pandas as pd

    if name not in DOCUMENTS:
        raise UsageError(
            f"there are no documents {name!r}; there are {', '.join(DOCUMENTS)}{did_you_mean(name, DOCUMENTS)}", "unknown-name"
        )
    file, names = Path(path), ["instance", "method", "seed", "file_hash", "setting_hash"]
    with opened(file) as connection, readable(file):
        rows = connection.execute(
            f"SELECT i.name, s.method, r.seed, i.hash, s.hash, d.{name} FROM documents d JOIN runs r ON r.id = d.run "
            "JOIN instances i ON i.id = r.instance JOIN settings s ON s.id = r.setting ORDER BY i.name, i.hash, s.method, s.hash, r.seed"
        ).fetchall()
    return pd.DataFrame(rows, columns=[*names, name])


def of_runs(frame: pd.DataFrame, keys: Collection[Key]) -> pd.DataFrame:
    """The rows of these runs alone."""
    own = zip(frame["instance"], frame["file_hash"], frame["setting_hash"], frame["seed"], strict=True)
    return frame[[key in keys for key in own]].reset_index(drop=True)


@dataclass(frozen=True)
class Exporter:
    """A form in which frames of runs are written.

    Parameters
    ----------
    content : callable
        Text or bytes of a frame.
    packages : tuple of str
        Of which one must be installed; none by default.
    requirement : str
        What ``pip install`` is to be told where none is.
    """

    content: Callable[[pd.DataFrame], str | bytes]
    packages: tuple[str, ...] = ()
    requirement: str = ""


EXPORTERS: Registry[Exporter] = Registry("suffix of exports", __package__, group="waybound.exporters")
"""Writers of tables of runs, by the suffix of the file."""

EXPORTERS.add(".csv", Exporter(lambda frame: frame.to_csv(index=False)))
EXPORTERS.add(".parquet", Exporter(lambda frame: frame.to_parquet(index=False), ("pyarrow", "fastparquet"), "waybound[parquet]"))


def check_export(path: Path) -> None:
    """Raise MissingPackageError where a file of this kind cannot be written, before anything is run."""
    form = EXPORTERS[path.suffix.lower()]
    if form.packages and not any(find_spec(name) for name in form.packages):
        raise MissingPackageError(f"--export of {path.suffix} needs the package {form.packages[0]}: pip install '{form.requirement}'")


def export(frame: pd.DataFrame, path: Path) -> None:
    """Write a frame, whole or not at all, in the form that the suffix stands for."""
    check_export(path)
    atomic_write(path, EXPORTERS[path.suffix.lower()].content(frame))
