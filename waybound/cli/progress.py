"""Progress on standard error: a live line in a terminal, sparse lines elsewhere, nothing when asked to be quiet."""

from __future__ import annotations

import contextlib
import math
import sys
import threading
import time
from types import TracebackType
from typing import Any

SPARSE_SECONDS = 5.0
"""Shortest time between two lines where standard error is no terminal."""


class Progress:
    """Receives the events of ``solve``, in whatever thread they come."""

    def __init__(self, quiet: bool) -> None:
        self.quiet = quiet
        self._lock = threading.Lock()
        self._event: dict[str, Any] = {"phase": "start", "seconds": 0.0, "objective": None, "bound": None}
        self._began = time.perf_counter()
        self._said = -SPARSE_SECONDS
        self._live: Any = None

    def __enter__(self) -> Progress:
        self._began = time.perf_counter()
        if not self.quiet and sys.stderr.isatty():
            from rich.console import Console
            from rich.live import Live

            self._live = Live(
                get_renderable=self._rendered, console=Console(file=sys.stderr), refresh_per_second=4, transient=True,
                redirect_stdout=False, redirect_stderr=False,
            )  # fmt: skip
            self._live.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None) -> None:
        if self._live is not None:
            self._live.stop()

    def __call__(self, event: dict[str, Any]) -> None:
        with self._lock:
            news = {key: value for key, value in event.items() if value is not None}
            self._event = {**self._event, **news}
            now = time.perf_counter() - self._began
            if self.quiet or self._live is not None or now - self._said < SPARSE_SECONDS:
                return
            self._said = now
            text = self.line()
        with contextlib.suppress(OSError):  # nobody can read it, which must not end a search
            print(text, file=sys.stderr, flush=True)

    def line(self) -> str:
        """What is known now: phase, seconds, incumbent, bound, gap."""
        from ..formulations.rendering import number, percent
        from ..formulations.solution import relative_gap

        e = self._event
        parts = [f"{e['phase']} {time.perf_counter() - self._began:.1f} s"]
        if e["objective"] is not None:
            parts.append(f"objective {number(e['objective'])}")
        if e["bound"] is not None:
            known = math.isfinite(e["bound"]) if isinstance(e["bound"], float) else True
            parts.append(f"bound {number(e['bound'])}" if known else "no answer exists")
        gap = None
        if isinstance(e["objective"], int | float) and isinstance(e["bound"], int | float):
            gap = relative_gap(float(e["objective"]), float(e["bound"]))
        if gap is not None:
            parts.append(f"gap {percent(gap)}")
        return ", ".join(parts)

    def _rendered(self) -> Any:
        from rich.text import Text

        return Text(self.line(), style="dim")


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
