"""The process that forks runs: what a run had to load is there for the next one. What becomes of runs is in ``test_run_processes``."""

import math
import statistics
import sys
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

import pytest

from waybound.reports.campaigns import fork_server
from waybound.reports.campaigns.fork_server import STANDS, _learn, _loaded, _ready, _Running
from waybound.reports.campaigns.one_run import Task
from waybound.reports.campaigns.setting import Setting


def running(overtime: float) -> tuple[_Running, Any]:
    task = Task("a", Setting(method="savings", time_limit=1.0, bound_time=1.0), 1, ".", overtime)
    mine, theirs = Pipe(duplex=False)
    return _Running(1, 0, task, mine, Path()), theirs


def test_the_time_left_stands_still_while_anything_is_compiled_and_runs_on_after_all_of_it() -> None:
    one, news = running(5.0)
    assert 6.0 < one.left <= 7.0
    for message in (b"stands", b"stands", b"runs on"):
        news.send_bytes(message)
        assert one.hear()
    assert STANDS - 60.0 < one.left <= STANDS, "of its own time nothing goes by, and none compiles for ever"
    one.since -= 100.0
    news.send_bytes(b"runs on")
    assert one.hear() and one.stood >= 100.0 and one.left > 100.0
    news.close()
    assert not one.hear()


def test_a_late_run_is_not_ended_twice() -> None:
    one, _ = running(0.0)
    one.began -= 10.0
    assert one.left < 0.0
    one.late = True
    assert one.left == math.inf


def test_a_run_tells_what_it_loaded_and_that_is_loaded_for_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    before = set(sys.modules) - {"statistics"}
    assert statistics.__name__ in _loaded(before, set(_ready()))[0]
    monkeypatch.delitem(sys.modules, "statistics")
    _learn(["statistics", "no.such.module"], [("no.such.module", "loop")])
    assert "statistics" in sys.modules


def test_loops_are_loaded_from_the_cache_and_never_compiled_here(monkeypatch: pytest.MonkeyPatch) -> None:
    class Loop:
        def __init__(self, kept: bool) -> None:
            self._kept, self.asked = kept, 0

        def kept(self) -> bool:
            return self._kept

        def make(self) -> None:
            self.asked += 1

    held, missing = Loop(True), Loop(False)
    monkeypatch.setattr(fork_server, "held", held, raising=False)
    monkeypatch.setattr(fork_server, "missing", missing, raising=False)
    _learn([], [(fork_server.__name__, "held"), (fork_server.__name__, "missing")])
    assert (held.asked, missing.asked) == (1, 0)
