"""Faults to inject into what comes after a search, and a small problem whose answers are known."""

import errno
import json
import sys
from collections.abc import Callable
from typing import Any, Self

import pytest

import waybound as wb
from waybound.solvers.backend import BACKENDS, Engine, RawResult

TINY = wb.read("demo-tiny")
BEST, WORSE = wb.Routes.of([[7, 5, 3, 2], [4, 1, 6]]), wb.Routes.of([[7, 5, 3, 2], [1, 4, 6]])
VALUE = TINY.evaluate(BEST).values[0]
FAULTS: tuple[Callable[[], BaseException], ...] = (
    lambda: RuntimeError("made to fail"), MemoryError, lambda: OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt,
)  # fmt: skip
WORDS = ("RuntimeError: made to fail", "out of memory", "No space left on device", "interrupted")
ways = pytest.mark.parametrize(("fault", "words"), list(zip(FAULTS, WORDS, strict=True)), ids=["fault", "memory", "disk", "interrupt"])


def failing(fault: Callable[[], BaseException], times: float = float("inf")) -> Callable[..., Any]:
    """A function that fails ``times`` times, and tells nothing afterwards."""
    left = [times]

    def fail(*_: Any, **__: Any) -> Any:
        left[0] -= 1
        if left[0] >= 0:
            raise fault()

    return fail


def solver_of(registered: Any) -> Callable[..., str]:
    """``make(work)`` registers a solver of routing problems, ``made``, for one test; without ``work`` it finds the best answer."""
    BACKENDS.names()

    def make(work: Callable[..., RawResult] = lambda p, o, c: RawResult("feasible", answer=BEST, objective=VALUE)) -> str:
        body = {
            "name": "made", "family": "routing", "features": frozenset(), "package": "numpy", "modules": ("json",), "summary": "made",
            "missing": lambda self, problem: frozenset(), "run": lambda self, *given: work(*given),
        }  # fmt: skip
        registered(BACKENDS, "made", type("Made", (Engine,), body))
        return "made"

    return make


def answer_in(text: str) -> Any:
    """The answer in a JSON object, read back by the toolkit."""
    return TINY.answer_from_json(json.loads(text)["answer"])


class InterruptAt:
    """Ctrl-C before the ``number``-th line of waybound's functions ``names`` that is run; ``reached`` tells whether there was one."""

    def __init__(self, names: tuple[str, ...], number: int) -> None:
        self.names, self.left, self.reached = names, number, False

    def __enter__(self) -> Self:
        self.before = sys.gettrace()
        sys.settrace(self._trace)
        return self

    def __exit__(self, *_: object) -> None:
        sys.settrace(self.before)

    def _trace(self, frame: Any, event: str, argument: Any) -> Any:
        if frame.f_code.co_name not in self.names or "waybound" not in frame.f_globals["__name__"]:
            return None
        if event == "line" and not self.reached:
            self.left -= 1
            if not self.left:
                self.reached = True
                raise KeyboardInterrupt
        return self._trace
