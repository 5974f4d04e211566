"""The results file: one SQLite database, to which each run is added whole or not at all."""

import contextlib
import fcntl
import os
import sqlite3
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO, Any

from ...instances.errors import InputError, UsageError
from .campaign import Key, Planned
from .one_run import COLUMNS, DOCUMENTS, Outcome
from .setting import canonical

SCHEMA = 1
"""Version of the tables; a file of a later one is refused."""

APPLICATION = 0x77617962
"""SQLite's ``application_id`` in our files."""

_TABLES = f"""
CREATE TABLE instances (
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, hash TEXT NOT NULL, file TEXT NOT NULL, UNIQUE (name, hash));
CREATE TABLE settings (
    id INTEGER PRIMARY KEY, hash TEXT NOT NULL UNIQUE, solver TEXT NOT NULL, heuristic INTEGER NOT NULL, method TEXT NOT NULL,
    options TEXT NOT NULL, reading TEXT NOT NULL, limits TEXT NOT NULL, setting TEXT NOT NULL);
CREATE TABLE environments (
    id INTEGER PRIMARY KEY, machine TEXT NOT NULL, versions TEXT NOT NULL, UNIQUE (machine, versions));
CREATE TABLE runs (
    id INTEGER PRIMARY KEY, instance INTEGER NOT NULL REFERENCES instances, setting INTEGER NOT NULL REFERENCES settings,
    seed INTEGER NOT NULL, environment INTEGER NOT NULL REFERENCES environments,
    {", ".join(f'"{name}" {kind}' for name, kind in COLUMNS.items())}, UNIQUE (instance, setting, seed));
CREATE TABLE documents (
    run INTEGER PRIMARY KEY REFERENCES runs ON DELETE CASCADE, {", ".join(f"{name} TEXT" for name in DOCUMENTS)});
"""

_ADDED = (*COLUMNS, "instance", "setting", "seed", "environment")


class ResultsFile:
    """A results file, open for one campaign, and made where it is not there; a context manager.

    Raises InputError for a file that is damaged, none of ours, of a newer schema, or cannot be written; UsageError while another campaign
    writes to it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._stack = contextlib.ExitStack()
        if not path.parent.is_dir():
            raise InputError(f"cannot be written: there is no folder {path.parent}", "file", file=path)
        with contextlib.ExitStack() as opening:
            opening.enter_context(_alone(path))
            with readable(path):
                self._connection = sqlite3.connect(path, isolation_level=None)
                opening.callback(self._connection.close)
                self._prepare()
            self._stack = opening.pop_all()

    def __enter__(self) -> "ResultsFile":
        return self

    def __exit__(self, *fault: object) -> None:
        with contextlib.suppress(sqlite3.Error):
            self._stack.close()

    def _prepare(self) -> None:
        c = self._connection
        check_schema(c, self.path)
        if c.execute("PRAGMA user_version").fetchone()[0]:
            (verdict,) = c.execute("PRAGMA quick_check(runs)").fetchone()
            if verdict != "ok":
                raise sqlite3.DatabaseError(str(verdict).splitlines()[0])
        c.execute("PRAGMA journal_mode = WAL")
        c.execute("PRAGMA synchronous = NORMAL")  # what is committed outlives the process in any case
        c.execute("PRAGMA foreign_keys = ON")
        c.execute("BEGIN IMMEDIATE")
        if not c.execute("PRAGMA user_version").fetchone()[0]:
            for statement in _TABLES.split(";")[:-1]:
                c.execute(statement)
            c.execute(f"PRAGMA application_id = {APPLICATION}")
            c.execute(f"PRAGMA user_version = {SCHEMA}")
        for name in COLUMNS.keys() - columns_of(c):  # of a file that was made before there were these
            c.execute(f'ALTER TABLE runs ADD COLUMN "{name}" {COLUMNS[name]}')
        c.execute("COMMIT")

    def keys(self) -> set[Key]:
        """The runs that are there."""
        with readable(self.path):
            return set(self._connection.execute(_KEYS))

    def add(self, run: Planned, outcome: Outcome) -> None:
        """Add a run in one transaction; one that is there already stays.

        Raises InputError where the file cannot be written, be it that the disk is full; nothing of the run is in it then.
        """
        self.add_all([(run, outcome)])

    def add_all(self, runs: Iterable[tuple[Planned, Outcome]]) -> None:
        """Add runs in one transaction; see ``add``."""
        c = self._connection
        with readable(self.path):
            try:
                c.execute("BEGIN IMMEDIATE")
                for run, outcome in runs:
                    added = self._insert("runs", {**outcome.row, **self._references(run, outcome), "seed": run.seed}, _ADDED)
                    if added is not None and outcome.documents:
                        self._insert("documents", {**outcome.documents, "run": added}, ("run", *DOCUMENTS))
                c.execute("COMMIT")
            except BaseException:
                if c.in_transaction:
                    with contextlib.suppress(sqlite3.Error):
                        c.execute("ROLLBACK")
                raise

    def forget(self, keys: set[Key]) -> int:
        """Remove those of these runs that ended in an error, for them to be run again; returns how many."""
        with readable(self.path):
            failed = [
                (number,)
                for number, *key in self._connection.execute(_KEYS.replace("SELECT", "SELECT r.id,", 1) + " WHERE r.status = 'error'")
                if tuple(key) in keys
            ]
            self._connection.execute("BEGIN IMMEDIATE")
            self._connection.executemany("DELETE FROM runs WHERE id = ?", failed)
            self._connection.execute("COMMIT")
        return len(failed)

    def _references(self, run: Planned, outcome: Outcome) -> dict[str, int]:
        s, where = run.setting, run.instance
        setting = {
            "hash": s.hash, "solver": s.method, "heuristic": int(s.heuristic), "method": s.label, "options": canonical(s.options),
            "reading": s.reading, "limits": s.limits, "setting": s.text,
        }  # fmt: skip
        environment = {"machine": canonical(outcome.machine), "versions": canonical(outcome.versions)}
        return {
            "instance": self._known("instances", {"name": where.name, "hash": where.hash}, {"file": where.file}),
            "setting": self._known("settings", {"hash": s.hash}, setting),
            "environment": self._known("environments", environment, {}),
        }

    def _known(self, table: str, unique: dict[str, Any], rest: dict[str, Any]) -> int:
        """The number of a row of a table, which is added where it is not there."""
        where = " AND ".join(f"{name} = ?" for name in unique)
        row = self._connection.execute(f"SELECT id FROM {table} WHERE {where}", tuple(unique.values())).fetchone()
        if row is not None:
            return int(row[0])
        values = {**rest, **unique}
        added = self._insert(table, values, tuple(values))
        assert added is not None
        return added

    def _insert(self, table: str, values: dict[str, Any], names: tuple[str, ...]) -> int | None:
        columns, marks = ", ".join(f'"{name}"' for name in names), ", ".join("?" * len(names))
        cursor = self._connection.execute(
            f"INSERT OR IGNORE INTO {table} ({columns}) VALUES ({marks})", tuple(values.get(name) for name in names)
        )
        return cursor.lastrowid if cursor.rowcount else None


_KEYS = "SELECT i.name, i.hash, s.hash, r.seed FROM runs r JOIN instances i ON i.id = r.instance JOIN settings s ON s.id = r.setting"


def columns_of(connection: sqlite3.Connection) -> set[str]:
    """Columns of the table of runs; those that came later are none of a file that nothing was added to since."""
    return {name for _, name, *_ in connection.execute("PRAGMA table_info(runs)")}


def check_schema(connection: sqlite3.Connection, path: Path) -> None:
    """Raise InputError for a database that is none of ours, or of a newer schema; an empty one passes."""
    (version,), (application,) = (connection.execute(f"PRAGMA {name}").fetchone() for name in ("user_version", "application_id"))
    empty = not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
    if not empty and application != APPLICATION:
        raise InputError("is a database, but holds no results of a campaign", "foreign", file=path)
    if version > SCHEMA:
        raise InputError(
            f"was written by a newer waybound: its schema is {version}, this one reads {SCHEMA}; update waybound", "unsupported", file=path
        )


@contextlib.contextmanager
def readable(path: Path) -> Iterator[None]:
    """Errors of SQLite within the block as one line of ours."""
    try:
        yield
    except sqlite3.Error as fault:
        words, name = str(fault), getattr(fault, "sqlite_errorname", "")
        if "FULL" in name or "full" in words:
            raise InputError(
                "cannot be written: the disk is full; what was there is kept, and is not run again", "file", file=path
            ) from None
        if name.startswith("SQLITE_IOERR") or isinstance(fault, sqlite3.OperationalError):
            raise InputError(f"cannot be read or written: {words}; what was there is kept", "file", file=path) from None
        hint = "; move it away, or name another results file"
        raise InputError(f"is damaged, or no results file of a campaign: {words}{hint}", "malformed", file=path) from None


@contextlib.contextmanager
def opened(path: Path) -> Iterator[sqlite3.Connection]:
    """A results file to read from, which may be written to meanwhile.

    Raises InputError for one that is not there, damaged, or of a newer schema.
    """
    if not path.is_file():
        raise InputError("no such results file", "file", file=path)
    with readable(path), contextlib.closing(sqlite3.connect(path.resolve().as_uri() + "?mode=rw", uri=True)) as connection:
        connection.execute("PRAGMA query_only = ON")
        check_schema(connection, path)
        if not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
            raise InputError("holds no results", "missing", file=path)
        yield connection


@contextlib.contextmanager
def _alone(path: Path) -> Iterator[None]:
    """Keep other campaigns away from a results file; the system forgets of the lock when this process ends, however."""
    lock, held = path.with_name(f"{path.name}.lock"), None
    try:
        while held is None or not _is(held, lock):  # its last owner may have removed it between our two steps
            if held is not None:
                held.close()
            held = lock.open("wb")
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        if held is not None:
            held.close()
        raise UsageError(f"{path}: another campaign is writing to it; wait for its end, or name another results file", "file") from None
    except OSError as fault:
        raise InputError(f"cannot be written: {fault.strerror}", "file", file=path) from fault
    try:
        yield
    finally:
        lock.unlink(missing_ok=True)
        held.close()


def _is(held: IO[bytes], path: Path) -> bool:
    """Whether an open file is still the one of that name."""
    return path.exists() and os.path.samestat(os.fstat(held.fileno()), path.stat())
