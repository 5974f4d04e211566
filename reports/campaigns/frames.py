"""Results as pandas frames and as files, one row a run."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from importlib.util import find_spec
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...instances.errors import MissingPackageError, UsageError
from ...instances.suggestions import did_you_mean
from .campaign import Key
from .one_run import COLUMNS
from .results_file import opened, readable

if TYPE_CHECKING:
    import pandas as pd

_SOURCES = {
    "instance": "i.name", "solver": "s.solver", "method": "s.method", "options": "s.options", "seed": "r.seed",
    **{name: f'r."{name}"' for name in COLUMNS},
    "limits": "s.limits", "reading": "s.reading", "file": "i.file", "file_hash": "i.hash", "setting": "s.setting",
    "setting_hash": "s.hash", "versions": "e.versions", "machine": "e.machine",
}  # fmt: skip

FIRST = (
    "instance", "solver", "seed", "objective", "bound", "bound_kind", "status", "seconds", "gap", "verified_bound", "checked", "limit",
    "method",
)  # fmt: skip

NAMES = (*FIRST, *(name for name in _SOURCES if name not in FIRST))
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
        ``compile_seconds, bound_seconds, check_seconds, run_seconds``, ``began``, ``limits`` and ``reading`` (how the instance
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
        if name not in _SOURCES:
            raise UsageError(f"there is no column {name!r}; there are {', '.join(NAMES)}{did_you_mean(name, NAMES)}", "unknown-name")
    if not names:
        raise UsageError("no column is asked for", "missing")
    chosen = ", ".join(f'{_SOURCES[name]} AS "{name}"' for name in names)
    file = Path(path)
    with opened(file) as connection, readable(file):
        rows = connection.execute(f"SELECT {chosen} {_FROM} ORDER BY i.name, i.hash, s.method, s.hash, r.seed").fetchall()
    frame = pd.DataFrame(rows, columns=list(names))
    numbers = [name for name in names if COLUMNS.get(name) == "REAL"]
    frame = frame.astype(dict.fromkeys(numbers, float))
    if "checked" in names:
        frame["checked"] = frame["checked"].fillna(0).astype(bool)
    return frame


_FROM = "FROM runs r JOIN instances i ON i.id = r.instance JOIN settings s ON s.id = r.setting JOIN environments e ON e.id = r.environment"


def documents(path: str | PathLike[str], name: str) -> pd.DataFrame:
    """Documents of all runs, one row each: ``instance, method, seed, file_hash, setting_hash`` and the JSON text under ``name``.

    Parameters
    ----------
    path : path-like
    name : str
        ``solution`` (with the answer), ``certificate`` (with its evidence) or ``history``.
    """
    import pandas as pd

    file, names = Path(path), ["instance", "method", "seed", "file_hash", "setting_hash"]
    chosen = ", ".join(_SOURCES[one] for one in names)
    with opened(file) as connection, readable(file):
        rows = connection.execute(
            f"SELECT {chosen}, d.{name} {_FROM} JOIN documents d ON d.run = r.id ORDER BY i.name, i.hash, s.method, s.hash, r.seed"
        ).fetchall()
    return pd.DataFrame(rows, columns=[*names, name])


def of_runs(frame: pd.DataFrame, keys: Collection[Key]) -> pd.DataFrame:
    """The rows of these runs alone."""
    own = zip(frame["instance"], frame["file_hash"], frame["setting_hash"], frame["seed"], strict=True)
    return frame[[key in keys for key in own]].reset_index(drop=True)


def _write_csv(frame: pd.DataFrame, path: Path) -> None:
    from ...instances.atomic import atomic_write

    atomic_write(path, frame.to_csv(index=False))


def _write_parquet(frame: pd.DataFrame, path: Path) -> None:
    import io

    from ...instances.atomic import atomic_write

    held = io.BytesIO()
    frame.to_parquet(held, index=False)
    atomic_write(path, held.getvalue())


EXPORTS: dict[str, Callable[[Any, Path], None]] = {".csv": _write_csv, ".parquet": _write_parquet}
"""Who writes a frame, by the suffix of the file."""


def check_export(path: Path) -> None:
    """Raise MissingPackageError where a file of this kind cannot be written, before anything is run."""
    if path.suffix.lower() == ".parquet" and not any(find_spec(name) for name in ("pyarrow", "fastparquet")):
        raise MissingPackageError("--export of .parquet needs the package pyarrow: pip install 'waybound[parquet]'")


def export(frame: pd.DataFrame, path: Path) -> None:
    """Write a frame, whole or not at all, in the form that the suffix stands for."""
    check_export(path)
    EXPORTS[path.suffix.lower()](frame, path)
