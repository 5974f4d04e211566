"""The end of a search: at its deadline, or when it is asked to, compiled loops included."""

import heapq
import itertools
import math
import os
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
from numpy.typing import NDArray

Flag = NDArray[np.int64]

_STANDING = threading.Lock()
_stood: tuple[float, float, int] = (0.0, 0.0, 0)
"""Seconds that the clock of all deadlines stood still, the moment since which it does now, and for how many who asked."""

_LISTENERS: list[Callable[[str, float], None]] = []


def now() -> float:
    """Seconds on the clock that all deadlines keep, which stands still within ``off_the_clock``."""
    lost, since, askers = _stood
    return (since if askers else time.perf_counter()) - lost


@contextmanager
def off_the_clock(what: str = "") -> Iterator[None]:
    """Stop the clock of all deadlines of this process within the block: for work that is done once per machine or process.

    ``what``: the compiled loop that is made, told to all who listen; "" for what is done each time a process starts.
    """
    global _stood
    with _STANDING:
        lost, since, askers = _stood
        _stood = (lost, since if askers else time.perf_counter(), askers + 1)
    began = time.perf_counter()
    tell(what, math.nan)
    try:
        yield
    finally:
        with _STANDING:
            lost, since, askers = _stood
            _stood = (lost if askers > 1 else lost + time.perf_counter() - since, since, askers - 1)
        tell(what, time.perf_counter() - began)


@contextmanager
def hearing(listener: Callable[[str, float], None]) -> Iterator[None]:
    """Call ``listener(what, seconds)`` when work off the clock begins (NaN seconds) and when it ends, within the block."""
    _LISTENERS.append(listener)
    try:
        yield
    finally:
        _LISTENERS.remove(listener)


def tell(what: str, seconds: float) -> None:
    """Call all listeners, also for work that another process does."""
    for listener in tuple(_LISTENERS):
        listener(what, seconds)


class Stopped(Exception):
    """Raised by ``Stop.check`` to abandon a computation that is of no use unless it is finished."""


class Stop:
    """A deadline, and a wish to end that may come from any thread.

    Its clock stands still while a loop is compiled or loaded (``off_the_clock``). Python looks at ``reached()`` between pieces of work of
    at most some 50 ms. Compiled loops are given ``flag`` and look at it through ``stop_kernel.asked`` as often; they release Python's
    lock, so that the clock and whoever asks can set it.

    Parameters
    ----------
    seconds : float
        From now on.
    """

    def __init__(self, seconds: float = math.inf) -> None:
        self._end = now() + seconds
        self._wish = _Wish()
        self._flag: Flag | None = None

    def ask(self) -> None:
        """Ask for the end, of this stop and of all that were derived from it or that it was derived from."""
        self._wish.ask()

    def within(self, seconds: float) -> "Stop":
        """A stop that ends when this one does, after ``seconds`` at the latest."""
        return self.after(min(seconds, self.seconds_left))

    def after(self, seconds: float) -> "Stop":
        """A stop that ends after ``seconds``, whatever the deadline of this one, or on request: for work when the time is up."""
        stop = Stop(seconds)
        stop._wish = self._wish
        return stop

    @contextmanager
    def telling(self, end: Callable[[], None]) -> Iterator[None]:
        """Call ``end`` when the end is asked for within the block, in the thread that asks; at once if it was asked for before."""
        self._wish.add(end)
        try:
            yield
        finally:
            self._wish.remove(end)

    @property
    def seconds_left(self) -> float:
        return max(0.0, self._end - now())

    def reached(self) -> str:
        """Why it has to end: ``interrupt``, ``time``, or not at all (empty)."""
        return "interrupt" if self._wish.asked else "time" if now() >= self._end else ""

    def check(self) -> None:
        """Raise Stopped if it has to end."""
        if self.reached():
            raise Stopped

    @property
    def flag(self) -> Flag:
        """Shape (1,): not 0 once it has to end. A clock runs from the first use on, as long as somebody holds the flag."""
        if self._flag is None:
            self._flag = np.zeros(1, np.int64)
            self._wish.tell(self._flag)
            seconds_left = self.seconds_left
            if seconds_left <= 0.0:
                self._flag[0] = 1
            elif seconds_left < threading.TIMEOUT_MAX:
                _CLOCK.set_at(self._end, self._flag)
        return self._flag


_LOOK = 0.02
"""Seconds between two looks at a clock that stands still."""


class _Clock:
    """Sets flags at their deadlines, in one thread for all: starting a thread for each would take longer than many a kernel."""

    def __init__(self) -> None:
        self._earlier = threading.Condition()
        self._due: list[tuple[float, int, weakref.ref[Flag]]] = []
        self._numbers = itertools.count()
        self._thread: threading.Thread | None = None
        self._room = 1000

    def set_at(self, end: float, flag: Flag) -> None:
        """Set the flag at ``end``, on the clock of ``now``, if somebody holds it then."""
        with self._earlier:
            if len(self._due) >= self._room:
                self._due = [entry for entry in self._due if entry[2]() is not None]
                heapq.heapify(self._due)
                self._room = max(1000, 2 * len(self._due))
            entry = (end, next(self._numbers), weakref.ref(flag))
            heapq.heappush(self._due, entry)
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="deadlines", daemon=True)
                self._thread.start()
            elif self._due[0] is entry:
                self._earlier.notify()

    def _run(self) -> None:
        with self._earlier:
            while True:
                seconds_left = self._due[0][0] - now() if self._due else threading.TIMEOUT_MAX
                if seconds_left > 0.0:
                    self._earlier.wait(seconds_left + _LOOK if _stood[2] else seconds_left)
                else:
                    _set(heapq.heappop(self._due)[2])


class _Wish:
    """Whether the end was asked for, and the flags to set then."""

    def __init__(self) -> None:
        self.asked = False
        self._lock = threading.Lock()
        self._flags: list[weakref.ref[Flag]] = []
        self._listeners: list[Callable[[], None]] = []

    def ask(self) -> None:
        with self._lock:
            self.asked = True
            for flag in self._flags:
                _set(flag)
            listeners = list(self._listeners)
        for end in listeners:
            end()

    def add(self, end: Callable[[], None]) -> None:
        with self._lock:
            self._listeners.append(end)
            late = self.asked
        if late:
            end()

    def remove(self, end: Callable[[], None]) -> None:
        with self._lock:
            self._listeners.remove(end)

    def tell(self, flag: Flag) -> None:
        with self._lock:
            self._flags = [known for known in self._flags if known() is not None]
            self._flags.append(weakref.ref(flag))
            if self.asked:
                flag[0] = 1


def _set(flag: weakref.ref[Flag]) -> None:
    held = flag()
    if held is not None:
        held[0] = 1


_CLOCK = _Clock()


def _wind_up() -> None:
    global _CLOCK, _STANDING, _stood
    lost, since, askers = _stood
    _CLOCK, _STANDING = _Clock(), threading.Lock()
    _stood = (lost + (time.perf_counter() - since if askers else 0.0), since, 0)


if hasattr(os, "register_at_fork"):  # a forked process has no thread but the one that forked
    os.register_at_fork(after_in_child=_wind_up)

NEVER = Stop()
"""The default: a stop that is never reached."""

_CURRENT: ContextVar[Stop] = ContextVar("stop", default=NEVER)


def current_stop() -> Stop:
    """The stop of the innermost ``until`` block; ``NEVER`` outside any."""
    return _CURRENT.get()


@contextmanager
def until(stop: Stop) -> Iterator[None]:
    """Let slow checkers within the block give up when ``stop`` is reached; they then prove nothing."""
    token = _CURRENT.set(stop)
    try:
        yield
    finally:
        _CURRENT.reset(token)
