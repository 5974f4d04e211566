"""The log of a search: a line per improvement and per few seconds, and at the end what was proved, by what, and what was not.

It goes to a file, to standard error, or into the cell of a notebook.
"""

import contextlib
import html
import math
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from types import TracebackType
from typing import Any

from ..formulations.rendering import number, percent
from ..formulations.solution import relative_gap
from ..formulations.tolerance import same
from ..instances.errors import InputError, UsageError, in_words
from ..instances.printable import one_line

EVERY = 5.0
"""Seconds between two lines where no better answer is found, be it that one source raises its bound all the time."""

APART = 0.25
"""Least seconds between two lines of better answers: of a flood of them the last counts."""

REFRESH = 0.25
"""Least seconds between two pictures of a log in a notebook."""

_PHASES = {"solve": "searching", "bound": "bounding", "check": "checking"}
_KINDS = {
    "claimed": "its own figure", "evidence": "its evidence is checked at the end", "verified": "checked",
}  # fmt: skip


def counts_of(event: Mapping[str, Any]) -> list[str]:
    """Nodes of branch and bound, once there are any, and what else the engine counts, in words."""
    nodes = event.get("nodes")
    if nodes is None:
        return []
    further = [f"{count:,} {name}" for name, count in (event.get("counts") or {}).items()]
    return [*([f"{nodes} node{'s' if nodes != 1 else ''}"] if nodes else []), *further]


class SearchLog:
    """Writes lines while ``solve`` runs, by ``wb.solve(problem, log=SearchLog(print))``.

    Parameters
    ----------
    write : callable
        Receives one line at a time, from whatever thread; what it raises as OSError ends nothing.
    """

    def __init__(self, write: Callable[[str], None]) -> None:
        self._write = write
        self._lock = threading.RLock()
        self._done = threading.Event()
        self._began = self._said = time.perf_counter()
        self._phase, self._event = "solve", dict[str, Any]()
        self._pending, self._due, self._answered = "", math.inf, -math.inf
        self._bounder: tuple[str, str] | None = None

    def __enter__(self) -> "SearchLog":
        threading.Thread(target=self._run, name="waybound-log", daemon=True).start()
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None) -> None:
        self._done.set()
        self._flush()
        if fault is not None:
            self._line(f"ended by an error: {one_line(fault)}")

    def begin(self, problem: str, remarks: Sequence[str], method: str, settings: str) -> None:
        """Write the heading: the problem, remarks on it, the method, and its limits and seed (``settings``)."""
        from .._version import __version__

        self._began = self._said = time.perf_counter()
        self._line(f"waybound {__version__}, {one_line(problem)}")
        for remark in remarks:
            self._line(f"note: {one_line(remark)}")
        self._line(f"search by {method}; {settings}")
        self._line("")
        self._line(f"{'seconds':>9}  {'objective':>14}  {'bound':>14}  {'gap':>8}")

    def begin_phase(self, phase: str, limit: float | None) -> None:
        """A phase begins, which may take ``limit`` seconds."""
        with self._lock:
            self._flush()
            self._phase = phase
            if phase == "check":  # takes no time to speak of, and is told at its end
                return
            self._say(f"{_PHASES.get(phase, phase)} begins" + (f", for up to {limit:g} s" if limit is not None else ""))

    def engine_set_up(self, who: str, seconds: float) -> None:
        """An engine has made its own model of the problem, which took a while."""
        with self._lock:
            self._flush()
            self._say(f"{who} is set up, which took {seconds:.1f} s")

    def compiling(self, what: str, seconds: float) -> None:
        """A loop is compiled, or (``seconds``) was."""
        if math.isnan(seconds):
            with self._lock:
                self._flush()
                self._say(f"compiling {what.rpartition('.')[2]}, once a machine")

    def __call__(self, event: dict[str, Any]) -> None:
        with self._lock:
            before, self._event = self._event, event
            better = event["objective"] is not None and event["objective"] != before.get("objective")
            raised = event["bound"] is not None and event["bound"] != before.get("bound")
            if not better and not raised:
                return
            who = event["found_by"]
            if raised and not math.isfinite(event["bound"]):
                news = f"no answer exists: {who}; {_KINDS[event['bound_kind']]}"
            else:
                answer = f"answer by {who}, {'checked' if event['phase'] == 'check' else 'not checked yet'}" if better else ""
                news = ", and ".join(part for part in (answer, f"bound by {who}, {_KINDS[event['bound_kind']]}" if raised else "") if part)
            news += self._nodes("; ")
            now, due, source = time.perf_counter(), -math.inf, (who, event["bound_kind"])
            if better:
                due = self._answered + APART
            elif source == self._bounder and math.isfinite(event["bound"]):
                due = self._said + EVERY
            if now >= due:
                self._answered = now if better else self._answered
                self._say(news)
            elif better or not self._pending or self._due > now + APART:  # an answer that is held back stays
                self._pending, self._due = news, due
            self._bounder = source if raised else self._bounder

    def end(self, result: dict[str, Any], verdict: Sequence[str]) -> None:
        """The last line, ``result`` being objective, bound and gap, and the lines of the verdict."""
        self._done.set()
        with self._lock:
            self._flush()
            self._event = result
            self._say("all checks done")
            for line in ("", *verdict):
                self._line(line)

    def tick(self) -> None:
        """Write the line that is due: one that was held back, or a sign of life."""
        with self._lock:
            now = time.perf_counter()
            if self._pending and now >= self._due:
                self._flush()
            elif now - self._said >= EVERY:
                self._say(_PHASES.get(self._phase, self._phase) + self._nodes(", "))

    def _nodes(self, between: str) -> str:
        """The nodes of branch and bound, once there are any and as long as they are searched."""
        counted = counts_of(self._event) if self._phase == "solve" else []
        return between + ", ".join(counted) if counted else ""

    def _run(self) -> None:
        while not self._done.wait(APART):
            self.tick()

    def _flush(self) -> None:
        if self._pending:
            self._answered = time.perf_counter()
            self._say(self._pending)

    def _say(self, news: str) -> None:
        self._said, self._pending = time.perf_counter(), ""
        value, bound = self._event.get("objective"), self._event.get("bound")
        gap = self._event["gap"] if "gap" in self._event else open_gap(value, bound)
        known = bound is None or not isinstance(bound, float) or math.isfinite(bound)
        self._line(
            f"{self._said - self._began:>9.2f}  {_short(value):>14}  {_short(bound) if known else 'no answer':>14}  "
            f"{percent(gap) if known else '-':>8}  {one_line(news)}"
        )

    def _line(self, text: str) -> None:
        with self._lock, contextlib.suppress(OSError, ValueError):  # nobody can read it, which must not end a search
            self._write(text.rstrip())


def open_gap(value: Any, bound: Any) -> float | None:
    """The gap while a search runs: of the first level, where that one is still open."""
    first = value[0] if isinstance(value, list) else value
    if not isinstance(first, float | int) or not isinstance(bound, float | int) or (isinstance(value, list) and same(first, bound)):
        return None
    return relative_gap(float(first), float(bound))


def _short(value: Any) -> str:
    """Ten significant digits; nothing where nothing is known."""
    if isinstance(value, list | tuple):
        return " then ".join(_short(v) for v in value)
    return number(value)


Log = bool | str | PathLike[str] | SearchLog | None


@contextlib.contextmanager
def shown(log: Log) -> Iterator[SearchLog | None]:
    """The log that ``log`` asks for, open while a search runs.

    True shows it: in the cell of a notebook, else on standard error. A path is a file, ``-`` standard error; a ``SearchLog`` is used as it
    is. Raises InputError if the file cannot be written; UsageError for anything else.
    """
    if log is None or log is False:
        yield None
    elif isinstance(log, SearchLog):
        yield log
    elif log is True and in_notebook():
        cell = _Cell()
        with SearchLog(cell.write) as writer:
            try:
                yield writer
            finally:
                cell.show()
    elif log is True or log == "-":
        with SearchLog(lambda line: print(line, file=sys.stderr, flush=True)) as writer:
            yield writer
    elif isinstance(log, str | PathLike):
        try:
            stream = Path(log).open("w", encoding="utf-8", buffering=1)  # noqa: SIM115 - closed below
        except OSError as fault:
            raise InputError(f"the log cannot be written: {in_words(fault)}", "file").at(file=fspath(log)) from fault
        with stream, SearchLog(lambda line: print(line, file=stream)) as writer:
            yield writer
    else:
        raise UsageError(f"log is True, the name of a file, or a SearchLog, not {type(log).__name__}", "malformed")


def in_notebook() -> bool:
    """Whether this runs in the kernel of a notebook; imports nothing."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and "ipykernel" in sys.modules


class _Cell:
    """The output of a cell: the lines so far, shown anew now and then, so that what stays is the log as a whole."""

    def __init__(self) -> None:
        from importlib import import_module

        display: Any = import_module("IPython.display").display  # there is none without a notebook
        self._lines: list[str] = []
        self._drawn = 0.0
        self._handle: Any = display(self._page(), raw=True, display_id=True)

    def write(self, line: str) -> None:
        self._lines.append(line)
        if time.perf_counter() - self._drawn >= REFRESH:
            self.show()

    def show(self) -> None:
        self._drawn = time.perf_counter()
        self._handle.update(self._page(), raw=True)

    def _page(self) -> dict[str, str]:
        text = "\n".join(self._lines)
        return {
            "text/plain": text,
            "text/html": f'<pre style="font-family:monospace;font-size:85%;line-height:1.3">{html.escape(text)}</pre>',
        }
