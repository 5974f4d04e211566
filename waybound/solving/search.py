"""Running an engine so that it can be stopped: in a worker thread, or in a process of its own."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from ..formulations.stop import Stop
from ..instances.errors import in_words
from ..solvers import interrupts
from ..solvers.backend import Control, RawResult
from ..solvers.interrupts import GRACE

T = TypeVar("T")

OVERTIME = 0.3
"""Seconds past its time limit after which an engine is asked to stop from outside: with its ``GRACE``, less than two seconds."""

BOUND_OVERTIME = OVERTIME
"""The same for bounding."""

ENGINE_THREAD = "waybound-engine"
"""Name of the thread that runs an engine."""

_TICK = 0.1


@dataclass(frozen=True)
class Searched:
    """The outcome of a run.

    ``result`` is the engine's own account, or one made from its incumbents if it never came back;
    ``interrupted`` tells whether the user ended it.
    """

    result: RawResult
    interrupted: bool
    seconds: float


def search(run: Callable[[Control], RawResult], control: Control, time_limit: float, overtime: float = OVERTIME) -> Searched:
    """Run ``run(control)`` in a worker thread and wait for it.

    The first Ctrl-C (of the command line also SIGTERM or SIGHUP) asks the engine to stop and waits up to ``GRACE`` seconds for its last
    word, a later one takes the incumbents at once. An engine that overstays its time limit, on the clock of ``stop.now``, is treated alike.
    Raises whatever the engine raised, unless it had published an answer before: an answer outlives a crash.
    """
    outcome: dict[str, Any] = {}
    # Not Thread.join and is_alive: an interrupt within join makes Python 3.11 take a running thread for a finished one.
    done = threading.Event()

    def work() -> None:
        try:
            outcome["result"] = run(control)
        except BaseException as fault:
            outcome["fault"] = fault
        finally:
            done.set()

    began, limit = time.perf_counter(), Stop(time_limit + overtime)
    asked_at: float | None = None
    with interrupts.waiting():
        interrupted = give_up = bool(interrupts.received)  # then nothing is begun any more
        if not interrupted:
            threading.Thread(target=work, name=ENGINE_THREAD, daemon=True).start()
        while not done.is_set() and not give_up:
            try:
                done.wait(_TICK)
                now = time.perf_counter()
                if interrupts.received and not interrupted:
                    interrupted, asked_at = True, now
                    control.stop()
                if asked_at is None and limit.reached():
                    asked_at = now
                    control.stop()
                give_up = interrupts.insisted or (asked_at is not None and now - asked_at > GRACE)
            except KeyboardInterrupt:  # from a handler that is not ours
                give_up = interrupted
                interrupted, asked_at = True, time.perf_counter()
                control.stop()
    if not done.is_set():
        control.close()
    seconds = time.perf_counter() - began
    if "fault" in outcome and control.answer is None:
        raise outcome["fault"]
    result: RawResult = outcome.get("result") or _from_incumbents(control, interrupted, outcome.get("fault"))
    if interrupted and result.limit != "interrupt" and result.status not in ("optimal", "infeasible", "unbounded"):
        result = replace(result, limit="interrupt")
    elif asked_at is not None and not interrupted and result.limit == "interrupt":  # what asked was the clock
        result = replace(result, limit="time")
    return Searched(result, interrupted, seconds)


def in_time(work: Callable[[], T], otherwise: Callable[[], T]) -> T:
    """Return ``work()``, or ``otherwise()``, which must be quick, once a signal has come and its time is out.

    Raises whatever either raises.
    """
    outcome: list[T] = []
    faults: list[BaseException] = []
    done = threading.Event()

    def attempt() -> None:
        try:
            outcome.append(work())
        except BaseException as fault:
            faults.append(fault)
        finally:
            done.set()

    with interrupts.waiting():
        threading.Thread(target=attempt, name=ENGINE_THREAD, daemon=True).start()
        try:
            while not done.wait(_TICK) and not interrupts.out_of_time():
                pass
        except KeyboardInterrupt:  # from a handler that is not ours
            return otherwise()
        if faults:
            raise faults[0]
        return outcome[0] if outcome else otherwise()


def _from_incumbents(control: Control, interrupted: bool, fault: BaseException | None) -> RawResult:
    if fault is not None:
        message = f"the engine failed: {in_words(fault)}"
    elif not control.stopped:
        message = "interrupted before the search began"
    else:
        message = f"the engine did not stop when asked{control.left}"
    return RawResult(
        status="unknown" if control.answer is None else "feasible",
        limit="interrupt" if interrupted else "time" if fault is None else "none",
        answer=control.answer,
        objective=control.objective,
        bound=control.bound,
        message=message,
        evidence=control.evidence,
    )
