import json
import platform
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import planned

from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.bundled import bundled_path
from waybound.instances.errors import CheckFailedError, NoAnswerError
from waybound.reports.campaigns.one_run import COLUMNS, DOCUMENTS, Outcome, Task, lost, machine, run_task
from waybound.reports.campaigns.setting import Setting
from waybound.solving import solve


@pytest.fixture(autouse=True)
def _in_a_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)


def task(folder: Path, **setting: Any) -> Task:
    given = {"method": "savings", "heuristic": True, "time_limit": 60.0, "bound_time": 0.0, **setting}
    return Task(str(bundled_path("demo-tiny")), Setting(**given), 1, str(folder), 5.0)


def test_a_run_is_told_with_all_its_documents(tmp_path: Path) -> None:
    made = run_task(task(tmp_path, changes={"objective": "vehicles then total-cost"}))
    assert made.row.keys() <= COLUMNS.keys() and made.documents.keys() == set(DOCUMENTS)
    assert made.row["status"] == "feasible" and made.row["checked"] == 1 and made.row["objective"] == 3.0
    assert json.loads(made.row["levels"])["objective"][0] == 3.0 and made.row["reason"] is None


def test_an_instance_that_is_gone_and_one_that_a_method_cannot_take_are_errors_with_a_code(tmp_path: Path) -> None:
    gone = run_task(replace(task(tmp_path), path=str(tmp_path / "gone.txt"))).row
    assert (gone["status"], gone["error_code"]) == ("error", "file") and "no such file" in gone["reason"]
    assert run_task(task(tmp_path, method="local")).row["error_code"] == "unsupported"
    other = run_task(replace(task(tmp_path), hash="of another file")).row
    assert other["error_code"] == "foreign" and "is not the file that the campaign began with" in other["reason"]


@pytest.mark.parametrize(
    ("fault", "status", "code", "limit"),
    [
        (MemoryError(), "error", "too-large", "memory"),
        (NoAnswerError("no time"), "unknown", "no-answer", "none"),
        (CheckFailedError("a lie"), "error", "check-failed", "none"),
        (ZeroDivisionError("x"), "error", "search-failed", "none"),
    ],
)
def test_whatever_is_raised_is_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: Exception, status: str, code: str, limit: str
) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise fault

    monkeypatch.setattr("waybound.solving.solve.solve", fail)
    row = run_task(task(tmp_path)).row
    assert (row["status"], row["error_code"], row["limit"], row["checked"]) == (status, code, limit, 0)


def test_an_answer_of_a_run_with_faults_is_not_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import waybound as wb

    solution = replace(wb.solve(wb.read("demo-tiny"), heuristic="savings", bound_time=0.0), faults=("it lied",))
    monkeypatch.setattr(solve, "solve", lambda *_: solution)
    row = run_task(task(tmp_path)).row
    assert (row["checked"], row["faults"], row["error_code"], row["reason"]) == (0, 1, "check-failed", "it lied")


def test_memory_is_limited_once_libraries_are_loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []
    monkeypatch.setattr("waybound.solvers.isolation.limit_memory", lambda megabytes: asked.append(megabytes) or True)
    assert run_task(task(tmp_path, memory_limit=500.0)).row["status"] == "feasible" and asked == [500.0]


def test_a_run_tells_that_its_memory_was_not_limited_where_the_system_does_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("waybound.solvers.isolation.limit_memory", lambda megabytes: False)
    row = run_task(task(tmp_path, memory_limit=500.0)).row
    assert row["status"] == "feasible" and row["reason"] == "the memory limit was not kept: this system has none"
    assert run_task(task(tmp_path)).row["reason"] is None


def test_a_machine_without_proc_is_told_by_what_python_knows(monkeypatch: pytest.MonkeyPatch) -> None:
    machine.cache_clear()
    monkeypatch.setattr(Path, "read_text", lambda *_: (_ for _ in ()).throw(FileNotFoundError("/proc/cpuinfo")))
    try:
        assert machine()["processor"] in (platform.processor(), platform.machine()) and machine()["cores"]
    finally:
        machine.cache_clear()


def test_what_fails_for_want_of_a_stack_is_a_lack_of_memory_where_that_is_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("waybound.solving.solve.solve", fail)
    monkeypatch.setattr("waybound.solvers.isolation.limit_memory", lambda megabytes: True)
    assert run_task(task(tmp_path)).row["error_code"] == "search-failed"
    limited = run_task(task(tmp_path, memory_limit=7.0)).row
    assert (limited["limit"], limited["reason"]) == ("memory", "the memory limit of 7 MB was reached")


def test_a_lost_run_and_its_deadline(tmp_path: Path) -> None:
    made: Outcome = lost(task(tmp_path), "it died", seconds=2.0)
    assert made.row["status"] == "error" and made.row["reason"] == "it died" and made.machine == machine()
    assert task(tmp_path, bound_time=None).deadline == 60.0 + 6.0 + 5.0
    assert "savings" in HEURISTICS and planned().seed == 1
