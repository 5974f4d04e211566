"""Tasks spread over processes; results so far survive a Ctrl-C."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ...instances.errors import WayboundError
from .study import Told


@dataclass(frozen=True)
class Done:
    """Results in the order of the tasks, None for those that were not done."""

    results: list[Any]
    interrupted: bool

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Rows of tasks that each bring a list of them; raises KeyboardInterrupt where an interrupt left none."""
        if self.interrupted and all(part is None for part in self.results):
            raise KeyboardInterrupt
        return [row for part in self.results if part is not None for row in part]

    def progress(self) -> dict[str, Any]:
        """The fields of a report on how many runs are done."""
        finished = sum(part is not None for part in self.results)
        return {"done": finished, "asked": len(self.results), "interrupted": self.interrupted}


def called(function: Callable[..., Any], *arguments: Any) -> Any:
    """``function`` of its arguments: a function for ``spread`` where tasks begin with one of their own."""
    return function(*arguments)


def spread(function: Callable[..., Any], tasks: Sequence[tuple[Any, ...]], jobs: int, progress: Told, what: Callable[[Any], str]) -> Done:
    """``function(*task)`` for every task, in ``jobs`` processes (1: this one); after Ctrl-C the results so far.

    ``function`` is one of a module, so that other processes find it; ``progress`` receives how far it is, and ``what`` names a task. Raises
    WayboundError if a process ended abruptly.
    """
    results: list[Any] = [None] * len(tasks)
    jobs = min(jobs, len(tasks))
    try:
        if jobs <= 1:
            for k, task in enumerate(tasks):
                progress(k, len(tasks), what(task))
                results[k] = function(*task)
            progress(len(tasks), len(tasks), "")
        else:
            _in_processes(function, tasks, jobs, results, progress, what)
    except KeyboardInterrupt:
        return Done(results, True)
    return Done(results, False)


def _in_processes(
    function: Callable[..., Any],
    tasks: Sequence[tuple[Any, ...]],
    jobs: int,
    results: list[Any],
    progress: Told,
    what: Callable[[Any], str],
) -> None:
    from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
    from concurrent.futures.process import BrokenProcessPool

    # Not fork: solver libraries and numba keep threads that a forked process would lack.
    pool = ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn"), initializer=_prepare)
    finished, done = False, 0
    waiting: dict[Future[Any], int] = {}
    try:
        waiting.update((pool.submit(function, *task), k) for k, task in enumerate(tasks))
        while waiting:
            ready, _ = wait(waiting, return_when=FIRST_COMPLETED)
            for future in ready:
                k = waiting.pop(future)
                results[k] = future.result()
                done += 1
                progress(done, len(tasks), what(tasks[k]))
        finished = True
    except KeyboardInterrupt:
        for future, k in waiting.items():
            if future.done() and not future.cancelled() and future.exception() is None:
                results[k] = future.result()
        raise
    except BrokenProcessPool:
        raise WayboundError("a process of the study ended abruptly, perhaps for want of memory; run it with --jobs 1") from None
    finally:
        if not finished:
            for process in list((pool._processes or {}).values()):  # a task of minutes must not hold up a Ctrl-C
                process.terminate()
        pool.shutdown(wait=True, cancel_futures=True)


def _prepare() -> None:
    """Ignore Ctrl-C, which reaches every process of the terminal's group: the parent decides what it means. End with the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
