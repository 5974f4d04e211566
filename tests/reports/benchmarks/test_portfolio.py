"""The table of gaps to the best values known, within equal time."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import waybound as wb
from waybound.instances.writing import write_instance
from waybound.reports.benchmarks import portfolio as benchmark
from waybound.reports.benchmarks.portfolio import BARE, SETS, Kept, Task, gap, interval, known_of, run, table, tasks
from waybound.reports.benchmarks.routing_families import Known


def test_a_gap_is_per_cent_of_the_best_values_known_and_never_below_0() -> None:
    assert gap((210.0,), False, Known((200.0,), "")) == pytest.approx(5.0)
    assert gap((199.0,), False, Known((200.0,), "")) == 0.0
    assert gap((45.0,), True, Known((50.0,), "")) == pytest.approx(10.0)
    assert gap((55.0,), True, Known((50.0,), "")) == 0.0
    assert gap((10.0, 808.0), False, Known((10.0, 800.0), "")) == pytest.approx(1.0)
    assert gap((11.0, 700.0), False, Known((10.0, 800.0), "")) == pytest.approx(10.0)  # the vehicles come first
    assert math.isnan(gap((), False, Known((200.0,), "")))


def test_intervals_are_those_of_students_distribution() -> None:
    assert interval([1.0]) == "1.000"
    assert interval([1.0, 2.0, 3.0]) == "2.000 ± 2.484"  # 4.303 standard errors


def test_solvers_are_compared_file_by_file_and_seed_by_seed() -> None:
    gaps = {("f", "one", 1): 1.0, ("f", "one", 2): 3.0, ("f", "two", 1): 2.0, ("f", "two", 2): 4.0}
    lines = table("set", ("one", "two"), gaps, {"one": [1.0, 2.0], "two": [3.0, 3.0]})
    assert lines[3:] == [
        "| f | 2.000 | 3.000 |", "| **mean** | **2.000 ± 12.706** | **3.000 ± 12.706** |", "| minus one |  | 1.000 ± 0.000 |",
        "| CPU s | 1.5 | 3.0 |",
    ]  # fmt: skip


def test_files_are_looked_for_before_anything_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(benchmark.SETS, "few", Kept(("here",), ("a",)))
    with pytest.raises(SystemExit, match="no file a in here"):
        tasks(tmp_path, ["few"], ["pyvrp"], [1], 1.0)
    (tmp_path / "here").mkdir()
    for name in ("a.sol", "a.vrp"):
        (tmp_path / "here" / name).touch()
    assert [t.seed for t in tasks(tmp_path, ["few"], ["pyvrp"], [1, 2], 1.0)["few"]] == [1, 2]


def test_every_file_has_a_value_to_compare_with(benchmarks: Path) -> None:
    for many in tasks(benchmarks, SETS, ["pyvrp"], [1], 1.0).values():
        assert all(known_of(task).values for task in many)


@pytest.mark.parametrize("solver", ["savings-or-so", "portfolio", BARE])
def test_a_run_is_judged_whoever_made_it(solver: str, tmp_path: Path) -> None:
    write_instance(wb.generate("random", customers=8, capacity=40).to_instance(), tmp_path / "a.json")
    task = Task("cvrp", tmp_path, Path("a.json"), solver, 1, 0.3)
    if solver == "savings-or-so":
        with pytest.raises(wb.UsageError):
            run(task)
    else:
        values, most, spent = run(task)
        assert len(values) == 1 and not most and spent > 0.0
