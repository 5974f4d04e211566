"""Records a search as it goes: every better answer and bound, the time since ``solve`` was called, and the method that found it."""

import math
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

from ..formulations.search_history import Event
from ..formulations.solution import Value
from ..formulations.verified_bounds import better_bound

Progress = Callable[[dict[str, Any]], None]

SLOW_SET_UP = 1.0
"""Seconds of an engine's own set-up that are worth a word."""


BOUNDING = "bounding"
"""``found_by`` of answers that bounding came across."""


class Recorder:
    """Turns reports of the search and of bounding into events, and passes these on. Thread-safe.

    ``senses`` are those of the levels of the objective. Listeners receive ``{"phase", "seconds", "objective", "bound", "bound_kind",
    "found_by"}``, the best known of each at every event. One that has a method ``begin_phase(phase, limit)`` hears of phases too, one
    ``compiling(what, seconds)`` of loops that are compiled, and one ``engine_set_up(who, seconds)`` of an engine that took long before its
    search began.
    """

    def __init__(self, senses: Sequence[str], listeners: Sequence[Progress] = ()) -> None:
        self.senses, self._listeners = senses, tuple(listeners)
        self._lock = threading.Lock()
        self._began = time.perf_counter()
        self._value: tuple[float, ...] | None = None
        self._bound: tuple[float, str] | None = None
        self.events: list[Event] = []

    def begin_phase(self, phase: str, limit: float | None = None) -> None:
        """Tell those who want to know that a phase begins which may take ``limit`` seconds."""
        self._tell("begin_phase", phase, limit)

    def engine_set_up(self, who: str, seconds: float) -> None:
        """Tell them how long an engine took to make its own model, where that took a while."""
        if seconds >= SLOW_SET_UP:
            self._tell("engine_set_up", who, seconds)

    def _tell(self, what: str, *words: Any) -> None:
        for listener in self._listeners:
            hear = getattr(listener, what, None)
            if hear is not None:
                hear(*words)

    def of_search(self, who: str, answers: bool = True, bounds: bool = True) -> Progress:
        """A listener to the search by ``who``; objectives and bounds count only where they hold for the problem."""

        def hear(event: dict[str, Any]) -> None:
            value, bound = (event.get("objective") if answers else None), (event.get("bound") if bounds else None)
            self._take("solve", value, bound, "claimed", who, {"nodes": event.get("nodes"), "counts": event.get("counts", {})})

        return hear

    def of_bounds(self, event: dict[str, Any]) -> None:
        """Hears bounding; ``source`` names what the bound rests on."""
        self._take("bound", None, event.get("bound"), event.get("kind") or "evidence", str(event.get("source", "bounding")))

    def of_loops(self, what: str, seconds: float) -> None:
        """Hears which loop is compiled, with NaN seconds, and when that is done."""
        if what:
            self._tell("compiling", what, seconds)

    def judged(self, who: str, values: Sequence[float]) -> None:
        """The values of the answer that is handed over, recomputed from the data."""
        self._take("check", values, None, "verified", who)

    def end(self, values: tuple[float, ...] | None, bound: Value | None, kind: str | None, who: str) -> tuple[Event, ...]:
        """All events, with the values and the bound that are handed over as the last one."""
        with self._lock:
            bounds = None if bound is None else tuple(bound) if isinstance(bound, list) else (bound,)
            self.events.append(Event(self._seconds(), "check", values, bounds, kind, who))
            return tuple(self.events)

    def _take(self, phase: str, value: Any, bound: Any, kind: str, who: str, counted: dict[str, Any] | None = None) -> None:
        news = False
        with self._lock:
            values = _levels(value)
            if values is not None and (self._value is None or self._better(values, self._value)):
                self._value, news = values, True
            if isinstance(bound, int | float):
                bound = float(bound)
                if self._bound is None or better_bound(self.senses[0], bound, self._bound[0]):
                    self._bound, news = (bound, kind), True
            seconds = self._seconds()
            known, known_kind = self._bound or (None, None)
            if news:
                self.events.append(Event(seconds, phase, self._value, None if known is None else (known,), known_kind, who))
            best = self._value if self._value is None or len(self._value) > 1 else self._value[0]
            shown = list(best) if isinstance(best, tuple) else best
            event = {
                "phase": phase, "seconds": seconds, "objective": shown, "bound": known, "bound_kind": known_kind, "found_by": who,
                **(counted or {"nodes": None, "counts": {}}),
            }  # fmt: skip
        if news or phase == "solve":
            for listener in self._listeners:
                listener(event)

    def _better(self, values: tuple[float, ...], than: tuple[float, ...]) -> bool:
        """Whether ``values`` are better, compared level by level; of equal ones the longer is better."""
        for sense, value, other in zip(self.senses, values, than, strict=False):
            if value != other:
                return value < other if sense == "min" else value > other
        return len(values) > len(than)

    def _seconds(self) -> float:
        return time.perf_counter() - self._began


def _levels(value: Any) -> tuple[float, ...] | None:
    """The value of each level of the objective; None if one of them is unknown or is no finite number."""
    values = value if isinstance(value, list | tuple) else [value]
    known = [float(v) for v in values if isinstance(v, int | float) and math.isfinite(v)]
    return tuple(known) if known and len(known) == len(values) else None
