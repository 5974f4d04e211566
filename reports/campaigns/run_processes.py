"""Processes for runs: a fork server started, fed and watched from here, and everything ended with this process, however that ends."""

import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import ExitStack, suppress
from itertools import islice
from multiprocessing.connection import Connection, Pipe
from types import TracebackType

from ...solvers.children import child, scratch
from .campaign import Planned
from .one_run import Outcome, Task, lost
from .running import WORKERS

TRIES = 2
"""How often a run is begun whose fork server dies: which of several runs is to blame, nobody knows."""


class RunProcesses:
    """Does runs, ``jobs`` at a time, each in a process of its own. A context manager; thread-safe.

    The process that starts runs is to call ``main`` of the module ``program``.
    """

    def __init__(self, jobs: int = 1, program: str = f"{__package__}.fork_server") -> None:
        self.jobs, self.program = jobs, program
        self._lock = threading.Lock()
        self._stack = ExitStack()
        self._connection: Connection | None = None
        self._waiting: dict[int, tuple[Task, Future[Outcome], int]] = {}
        self._last = 0
        self._closed = False

    def __enter__(self) -> "RunProcesses":
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def submit(self, task: Task) -> Future[Outcome]:
        """Begin a run; its future has an outcome, whatever becomes of it."""
        future: Future[Outcome] = Future()
        self._begin(task, future, TRIES)
        return future

    def outcomes(self, tasks: Iterator[tuple[Planned, Task]]) -> Iterator[tuple[Planned, Outcome]]:
        """Each run with its outcome, in the order in which they end."""
        running: dict[Future[Outcome], Planned] = {}
        while True:
            for run, task in islice(tasks, self.jobs - len(running)):
                running[self.submit(task)] = run
            if not running:
                return
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                yield running.pop(future), future.result()

    def close(self) -> None:
        """End all runs under way; their futures are cancelled."""
        with self._lock:
            self._closed = True
            waiting, self._waiting = list(self._waiting.values()), {}
            connection, self._connection = self._connection, None
        self._stack.close()
        if connection is not None:
            connection.close()
        for _, future, _ in waiting:
            future.cancel()

    def _begin(self, task: Task, future: Future[Outcome], tries: int) -> None:
        with self._lock:
            if self._closed:
                future.cancel()
                return
            self._last += 1
            number = self._last
            self._waiting[number] = task, future, tries
            connection = self._connection or self._start()
            with suppress(OSError):  # it died, and the reader hears of it
                connection.send_bytes(pickle.dumps((number, task)))

    def _start(self) -> Connection:
        """Start a fork server."""
        mine, theirs = Pipe()
        folder = self._stack.enter_context(scratch())
        code = f"import sys; sys.path[:] = {sys.path!r}; from {self.program} import main; main({theirs.fileno()}, {str(folder)!r})"
        started = child(
            [sys.executable, "-c", code], folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            pass_fds=[theirs.fileno()], env={**os.environ, "TMPDIR": str(folder)},
        )  # fmt: skip
        process = self._stack.enter_context(started)
        theirs.close()
        self._connection = mine
        threading.Thread(target=self._listen, args=(mine, process), name="waybound-runs", daemon=True).start()
        return mine

    def _listen(self, connection: Connection, process: subprocess.Popen[bytes]) -> None:
        """Take outcomes until the fork server ends."""
        while True:
            try:
                number, outcome = pickle.loads(connection.recv_bytes())
            except Exception:  # at its end, where it was closed under our hands, or where nothing can be read of it
                break
            with self._lock:
                held = self._waiting.pop(number, None)
            if held is not None:
                held[1].set_result(outcome)
        with self._lock:
            if self._closed or self._connection is not connection:
                return
            self._connection = None
            orphans, self._waiting = list(self._waiting.values()), {}
        connection.close()  # one that says what cannot be read ends now, too
        process.wait()
        for task, future, tries in orphans:
            if tries > 1:
                self._begin(task, future, tries - 1)
            else:
                future.set_result(lost(task, f"the process that starts runs ended with code {process.returncode}, {TRIES} times"))


WORKERS.add("processes", lambda _, jobs: RunProcesses(jobs))
