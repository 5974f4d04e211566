"""Runs in processes of their own: what happens to one costs no other."""

import os
import pickle
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import psutil
import pytest
from campaign_cases import planned
from made_up_runs import COMPILE, CRASH, ENDED, FATAL, GOOD, HANG, NO_MEMORY

from waybound.reports.campaigns import run_processes
from waybound.reports.campaigns.one_run import Outcome, Task
from waybound.reports.campaigns.run_processes import RunProcesses
from waybound.reports.campaigns.setting import Setting

OVERTIME = {HANG: 0.2, COMPILE: 0.9}


def task(seed: int, folder: Path, **setting: Any) -> Task:
    overtime = OVERTIME.get(seed, 60.0)
    return Task("a.txt", Setting(method="savings", time_limit=0.1, bound_time=0.0, **setting), seed, str(folder), overtime)


@pytest.fixture(scope="module")
def processes() -> Iterator[RunProcesses]:
    with RunProcesses(3, program="made_up_runs") as made:
        yield made


def test_a_crash_a_hang_and_an_end_cost_their_runs_alone(processes: RunProcesses, tmp_path: Path) -> None:
    seeds = [GOOD, CRASH, HANG, ENDED, GOOD]
    rows = [future.result(60).row for future in [processes.submit(task(seed, tmp_path)) for seed in seeds]]
    assert [row["status"] for row in rows] == ["feasible", "error", "error", "error", "feasible"]
    assert rows[1]["reason"] == "the process of the run was ended by SIGSEGV: a library that talks"
    assert rows[2]["reason"] == "had not ended 0.2 s after all its limits, and was killed" and rows[2]["limit"] == "time"
    assert rows[3]["reason"] == "the process of the run ended with code 7: last words"
    assert all(row["error_code"] == "search-failed" for row in rows[1:4])


def test_time_stands_still_while_something_is_compiled(processes: RunProcesses, tmp_path: Path) -> None:
    assert processes.submit(task(COMPILE, tmp_path)).result(60).row["status"] == "feasible"


def test_a_lack_of_memory_is_told_as_one_where_memory_is_limited(processes: RunProcesses, tmp_path: Path) -> None:
    limited, free = (processes.submit(task(NO_MEMORY, tmp_path, **more)).result(60).row for more in ({"memory_limit": 50}, {}))
    assert limited["limit"] == "memory" and limited["reason"] == "the memory limit of 50 MB was reached"
    assert "SIGABRT" in free["reason"]


def test_as_many_are_under_way_as_there_are_jobs_and_each_has_a_process(processes: RunProcesses, tmp_path: Path) -> None:
    taken = 0

    def tasks() -> Iterator[tuple[Any, Task]]:
        nonlocal taken
        for k in range(7):
            taken += 1
            yield planned(seed=k), task(GOOD, tmp_path)

    outcomes: list[Outcome] = []
    for _, outcome in processes.outcomes(tasks()):
        outcomes.append(outcome)
        assert taken <= len(outcomes) + 3
    assert len({outcome.machine["pid"] for outcome in outcomes}) == 7


def test_a_lost_starter_of_runs_is_replaced_and_what_kills_it_twice_is_an_error(processes: RunProcesses, tmp_path: Path) -> None:
    row = processes.submit(task(FATAL, tmp_path)).result(60).row
    assert row["status"] == "error" and row["reason"] == "the process that starts runs ended with code -9, 2 times"
    assert processes.submit(task(GOOD, tmp_path)).result(60).row["status"] == "feasible"


def test_an_outcome_that_cannot_be_read_is_an_error_of_its_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def unreadable(data: bytes) -> Any:
        raise AttributeError("no such class")

    monkeypatch.setattr(run_processes, "pickle", SimpleNamespace(dumps=pickle.dumps, loads=unreadable))
    with RunProcesses(program="made_up_runs") as own:
        row = own.submit(task(GOOD, tmp_path)).result(60).row
    assert row["status"] == "error" and "2 times" in row["reason"]


def test_closing_ends_every_process_and_cancels_what_is_under_way(tmp_path: Path) -> None:
    before = {child.pid for child in psutil.Process().children(recursive=True)}
    with RunProcesses(program="made_up_runs") as own:
        assert own.submit(task(GOOD, tmp_path)).result(60).row["status"] == "feasible"
        future = own.submit(replace(task(HANG, tmp_path), overtime=60.0))
        started = [child for child in psutil.Process().children(recursive=True) if child.pid not in before]
        assert len(started) >= 2
    assert future.cancelled()
    _, left = psutil.wait_procs(started, timeout=30)  # killed ones need a moment to be gone
    assert not [child for child in left if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]
    assert own.submit(task(GOOD, tmp_path)).cancelled()


def test_signals_of_the_terminal_do_not_reach_runs(processes: RunProcesses, tmp_path: Path) -> None:
    outcome = processes.submit(task(GOOD, tmp_path)).result(60)
    parent = next(child for child in psutil.Process().children(recursive=True) if "made_up_runs" in " ".join(child.cmdline()))
    assert os.getpgid(parent.pid) != os.getpgid(0)
    parent.send_signal(signal.SIGINT)
    assert processes.submit(task(GOOD, tmp_path)).result(60).row == outcome.row


MISBEHAVING = """
import ctypes
from waybound.extending import BACKENDS, Engine

@BACKENDS.register("misbehaving")
class Misbehaving(Engine):
    name, package, summary, modules, family, features = "misbehaving", "waybound", "It crashes, or hangs.", (), "routing", frozenset()

    def missing(self, problem):
        return frozenset()

    def run(self, problem, options, control):
        print("a library that talks", flush=True)
        ctypes.PyDLL(None).pause() if options.seed else ctypes.string_at(0)  # the first keeps all threads from going on
"""


@pytest.mark.slow
def test_where_forking_is_unsafe_runs_are_fresh_interpreters_that_crash_hang_and_answer_apart(tmp_path: Path) -> None:
    (tmp_path / "misbehaving_of_a_test.py").write_text(MISBEHAVING)
    good = Task("demo-tiny", Setting(method="savings", time_limit=5.0, bound_time=0.0), 1, str(tmp_path), 60.0)
    bad = replace(good, setting=replace(good.setting, method="misbehaving", heuristic=False), modules=("misbehaving_of_a_test",))
    good = replace(good, setting=replace(good.setting, heuristic=True))
    hanging = replace(bad, setting=replace(bad.setting, time_limit=0.1), overtime=3.0)
    with RunProcesses(2, program="spawned_runs") as own, RunProcesses(1) as forked:
        tasks = [good, replace(bad, seed=0), hanging, good]
        first, crash, hang, last = (future.result(300).row for future in [own.submit(task) for task in tasks])
        usual = forked.submit(good).result(300).row
    assert crash["status"] == hang["status"] == "error"
    assert "was ended by SIGSEGV: a library that talks" in crash["reason"] and "3 s after all its limits" in hang["reason"]
    for name in ("status", "objective", "checked", "instance_hash"):
        assert first[name] == last[name] == usual[name]
    assert first["status"] == "feasible"
