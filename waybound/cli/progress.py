"""Progress in a terminal: a log that stays and can be pasted, above a live line that shows the limit; nothing where nobody looks."""

from __future__ import annotations

import contextlib
import math
import sys
import threading
import time
from pathlib import Path
from types import TracebackType
from typing import IO, TYPE_CHECKING, Any

from ..instances.errors import UsageError, in_words

if TYPE_CHECKING:
    from ..solving.search_log import SearchLog

SPARSE_SECONDS = 5.0
"""Shortest time between two lines of a ``PartsCounter`` where standard error is no terminal."""


class Progress:
    """Receives the events of ``solve``, in whatever thread they come, and shows them on standard error where that is a terminal.

    With ``logged`` there is a log too, the attribute ``log``, for the terminal and for the file ``log`` (``-`` is standard error, terminal
    or not); it is None where nobody reads it.
    """

    def __init__(self, quiet: bool, log: str | None = None, logged: bool = False) -> None:
        self._lock = threading.Lock()
        self._event: dict[str, Any] = {"phase": "preparing", "seconds": 0.0, "objective": None, "bound": None}
        self._began = self._phase_began = time.perf_counter()
        self._limit: float | None = None
        self._live: Any = None
        self._shows = not quiet and sys.stderr.isatty()
        self._path, self._stream = log, None if log in (None, "-") else _opened(str(log))
        self._compiling = ""
        self.log: SearchLog | None = None
        if logged and (self._shows or log is not None):
            from ..solving.search_log import SearchLog

            self.log = SearchLog(self._write)

    def __enter__(self) -> Progress:
        self._began = self._phase_began = time.perf_counter()
        if self._shows:
            from rich.console import Console
            from rich.live import Live

            self._live = Live(
                get_renderable=self._rendered, console=Console(file=sys.stderr), refresh_per_second=4, transient=True,
                redirect_stdout=False, redirect_stderr=False,
            )  # fmt: skip
            self._live.start()
        if self.log is not None:
            self.log.__enter__()
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None) -> None:
        if self.log is not None:
            self.log.__exit__(kind, fault, trace)
        if self._live is not None:
            self._live.stop()
        if self._stream is not None:
            with contextlib.suppress(OSError):
                self._stream.close()

    def __call__(self, event: dict[str, Any]) -> None:
        with self._lock:
            self._event = {**self._event, **{key: value for key, value in event.items() if value is not None}}

    def begin_phase(self, phase: str, limit: float | None) -> None:
        """Begin a phase of ``limit`` seconds at most."""
        with self._lock:
            self._event, self._limit, self._phase_began = {**self._event, "phase": phase}, limit, time.perf_counter()

    def compiling(self, what: str, seconds: float) -> None:
        """A loop is compiled, or (``seconds``) was."""
        with self._lock:
            self._compiling = f"compiling {what.rpartition('.')[2]}, once a machine, in " if math.isnan(seconds) else ""

    def line(self) -> str:
        """The live line: phase, seconds and limit, incumbent, bound, gap."""
        from ..formulations.rendering import number, percent
        from ..solving.search_log import counts_of, open_gap

        with self._lock:
            e, limit, now, compiling = self._event, self._limit, time.perf_counter(), self._compiling
        spent = f"{now - self._began:.1f} s" if limit is None else f"{now - self._phase_began:.1f} of {limit:g} s"
        parts = [f"{compiling}{e['phase']} {spent}"]
        if e["objective"] is not None:
            parts.append(f"objective {number(e['objective'])}")
        if e["bound"] is not None:
            known = math.isfinite(e["bound"]) if isinstance(e["bound"], float) else True
            parts.append(f"bound {number(e['bound'])}" if known else "no answer exists")
        gap = open_gap(e["objective"], e["bound"])
        if gap is not None:
            parts.append(f"gap {percent(gap)}")
        return ", ".join([*parts, *(counts_of(e) if e["phase"] == "solve" else [])])

    def _rendered(self) -> Any:
        from rich.text import Text

        return Text(self.line(), style="dim")

    def _write(self, line: str) -> None:
        """A line of the log, to whoever reads it; one that cannot be written to costs the others nothing."""
        if self._live is not None:
            with contextlib.suppress(OSError):
                self._live.console.print(line, markup=False, highlight=False, soft_wrap=True)
        elif self._path == "-":
            with contextlib.suppress(OSError):
                print(line, file=sys.stderr, flush=True)
        if self._stream is not None:
            with contextlib.suppress(OSError, ValueError):
                print(line, file=self._stream, flush=True)


def _opened(path: str) -> IO[str]:
    try:
        return Path(path).open("w", encoding="utf-8")
    except OSError as fault:
        raise UsageError(f"--log {path}: cannot be written: {in_words(fault)}", "file") from fault


class PartsCounter:
    """Counts parts of the work on standard error: a live line in a terminal, sparse lines elsewhere, nothing when asked to be quiet."""

    def __init__(self, name: str, quiet: bool, unit: str = "parts") -> None:
        self.name, self.quiet, self.unit = name, quiet, unit
        self._began = time.perf_counter()
        self._said = self._began
        self._live = not quiet and sys.stderr.isatty()

    def __enter__(self) -> PartsCounter:
        return self

    def __exit__(self, *fault: Any) -> None:
        if self._live:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def __call__(self, done: int, total: int, what: str = "") -> None:
        now = time.perf_counter()
        if self.quiet or now - self._said < (0.25 if self._live else SPARSE_SECONDS):
            return
        self._said = now
        line = f"{self.name} {now - self._began:.1f} s: {done} of {total} {self.unit}" + (f", {what}" if what else "")
        print(f"\r\033[K{line}" if self._live else line, end="" if self._live else "\n", file=sys.stderr, flush=True)
