"""A process that starts runs, as ``waybound.reports.campaigns.fork_server``, with runs that do what their seed says."""

import ctypes
import os
import signal
import sys
import time

from waybound.formulations.stop import off_the_clock
from waybound.reports.campaigns import fork_server
from waybound.reports.campaigns.one_run import Outcome, Task

GOOD, CRASH, HANG, ENDED, COMPILE, NO_MEMORY, ORPHAN, FATAL = range(8)


def _run(task: Task) -> Outcome:
    print("a library that talks", flush=True)
    if task.seed == CRASH:
        ctypes.string_at(0)
    if task.seed == HANG:
        signal.pause()
    if task.seed == ENDED:
        print("last words", file=sys.stderr, flush=True)
        os._exit(7)
    if task.seed == COMPILE:
        with off_the_clock("a loop"):
            time.sleep(task.deadline + 0.1)
    if task.seed == NO_MEMORY:
        print("terminate called after throwing an instance of 'std::bad_alloc'", file=sys.stderr, flush=True)
        os.abort()
    if task.seed == FATAL:
        os.kill(os.getppid(), signal.SIGKILL)
        signal.pause()
    return Outcome({"status": "feasible", "objective": float(task.seed), "run_seconds": 0.0}, {}, {}, {"pid": os.getpid()})


def main(descriptor: int, folder: str) -> None:
    """Do such runs; nothing is loaded for them."""
    fork_server._preload, fork_server.run_task = lambda: None, _run  # type: ignore[assignment]
    fork_server.main(descriptor, folder)
