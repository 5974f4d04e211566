"""Runs on a Dask cluster: workers on this machine, or those of a scheduler anywhere. Results come back to this process, which alone writes.

A worker does each run in a process of its own, as this machine would. A run whose worker is lost is done by another one.
"""

import atexit
import logging
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from itertools import islice
from types import TracebackType
from typing import Any

from ...instances.errors import MissingPackageError, SearchFailedError, UsageError, in_words
from .campaign import Planned
from .one_run import Outcome, Task, lost
from .run_processes import RunProcesses
from .running import WORKERS

LOCAL = "local"
AHEAD = 2
"""Runs that a worker is given for each that it can do at a time, so that it never waits for the next."""

PATIENCE = "30s"


class DaskWorkers:
    """The workers of a Dask cluster. A context manager.

    ``address`` is ``local``, with ``jobs`` workers, or that of a scheduler: ``tcp://host:8786``. Raises MissingPackageError if Dask
    distributed is not installed, UsageError if no scheduler answers at the address.
    """

    def __init__(self, address: str, jobs: int = 1) -> None:
        if find_spec("distributed") is None:
            raise MissingPackageError("--cluster needs the package distributed: pip install 'waybound[cluster]'")
        self.address, self.jobs = address, jobs
        self._stack = ExitStack()
        self._client: Any = None

    def __enter__(self) -> "DaskWorkers":
        from distributed import Client, LocalCluster

        self._stack.enter_context(_quiet())
        try:
            where: Any = self.address
            if where == LOCAL:
                where = self._stack.enter_context(
                    LocalCluster(n_workers=self.jobs, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50)
                )
            self._client = self._stack.enter_context(Client(where, timeout=PATIENCE, set_as_default=False))
        except (OSError, TimeoutError, ValueError) as fault:
            self._stack.close()
            raise UsageError(f"--cluster {self.address}: no scheduler can be reached there: {in_words(fault)}", "file") from fault
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None) -> None:
        self._stack.close()

    def outcomes(self, tasks: Iterator[tuple[Planned, Task]]) -> Iterator[tuple[Planned, Outcome]]:
        """Each run with its outcome, in the order in which they end; new workers are made use of as they come.

        Raises SearchFailedError if the scheduler is lost, or the workers cannot do runs at all.
        """
        from distributed import as_completed

        running: dict[Any, tuple[Planned, Task]] = {}
        ended = as_completed(loop=self._client.loop)
        while True:
            try:
                for run, task in islice(tasks, max(0, AHEAD * self._places() - len(running))):
                    future = self._client.submit(run_here, task, pure=False)
                    running[future] = run, task
                    ended.add(future)
            except OSError:
                raise self._lost() from None
            if not running:
                return
            future = next(ended)
            run, task = running.pop(future)
            yield run, self._outcome(future, task)
            future.release()

    def _places(self) -> int:
        """Runs that the cluster can do at a time; at least one, which waits for a worker to come."""
        return max(1, int(sum(self._client.nthreads().values())))

    def _outcome(self, future: Any, task: Task) -> Outcome:
        from distributed import KilledWorker

        if future.status == "finished":
            outcome = future.result()
            assert isinstance(outcome, Outcome)
            return outcome
        if future.status == "error":
            fault = future.exception()
            if isinstance(fault, KilledWorker):
                return lost(task, f"{fault.allowed_failures + 1} workers were lost while they did this run")
            raise SearchFailedError(f"the workers of {self.address} cannot do runs: {in_words(fault)}; is waybound installed there?")
        raise self._lost()

    def _lost(self) -> SearchFailedError:
        return SearchFailedError(
            f"the scheduler of {self.address} was lost; what was done is kept, and the same command goes on from there"
        )


for _scheme in (LOCAL, "tcp", "tls", "ucx", "ws", "wss"):
    WORKERS.add(_scheme, DaskWorkers)

_TALKERS = ("distributed", "asyncio", "tornado")


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence Dask's log on standard error while connections are lost: what matters is raised as an error of our own."""
    known = [*_TALKERS, *(name for name in logging.root.manager.loggerDict if name.partition(".")[0] in _TALKERS)]
    loggers = [logging.getLogger(name) for name in known]  # some have levels of their own
    before = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before, strict=True):
            logger.setLevel(level)


_lock = threading.Lock()
_processes: RunProcesses | None = None


def run_here(task: Task) -> Outcome:
    """Do a run in a process of this worker's own."""
    global _processes
    with _lock:
        if _processes is None:
            _processes = RunProcesses()
            atexit.register(_processes.close)
    return _processes.submit(task).result()
