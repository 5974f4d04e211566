"""Problems that break the process that solves them; sent to children by the tests of isolation."""

import os
import signal
import time
from dataclasses import dataclass
from typing import Any, ClassVar

from waybound.formulations.routing.problem import RoutingProblem
from waybound.solvers.backend import Control, RawResult


@dataclass(frozen=True, eq=False)
class Misbehaving(RoutingProblem):
    """Does ``deed`` when a solver looks at it in another process than ``home``."""

    deed: str = ""
    home: int = 0

    def features(self) -> frozenset[str]:
        if os.getpid() != self.home:
            DEEDS[self.deed]()
        return super().features()


@dataclass
class SlowToBegin:
    """Work that takes ``seconds`` of preparing."""

    seconds: float
    ready: bool = False
    modules: ClassVar[tuple[str, ...]] = ()

    def prepare(self) -> None:
        time.sleep(self.seconds)
        self.ready = True

    def __call__(self, control: Control) -> RawResult:
        return RawResult("unknown", answer=self.ready and not control.stopped)


@dataclass
class SetsUp:
    """Work that tells how long it set up."""

    modules: ClassVar[tuple[str, ...]] = ()

    def __call__(self, control: Control) -> RawResult:
        control.begin_set_up()
        control.end_set_up(2.5)
        control.end_set_up(9.0)
        return RawResult("unknown")


@dataclass
class Chatters:
    """Work that tells its parent something all the time, and hears nothing."""

    modules: ClassVar[tuple[str, ...]] = ()

    def __call__(self, control: Control) -> RawResult:
        while True:
            control.publish("word")


def _crash() -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def _hang() -> None:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    while True:
        time.sleep(1)


def _exhaust() -> None:
    hoard: list[Any] = []
    while True:
        hoard.append(bytearray(16 * 2**20))


def _raise() -> None:
    raise ZeroDivisionError("a fault in the engine")


DEEDS = {"crash": _crash, "hang": _hang, "exhaust": _exhaust, "raise": _raise, "exit": lambda: os._exit(3)}
