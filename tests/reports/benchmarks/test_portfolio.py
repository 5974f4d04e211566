"""The table of gaps to the best values known, within equal time."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import waybound as wb
from waybound.instances.writing import write_instance
from waybound.reports.benchmarks import portfolio as benchmark
from waybound.reports.benchmarks.portfolio import BARE, SETS, Kept, Task, gap, interval, run, table, tasks

KNOWN = [
    {"family": "cvrp/X", "instance": "a", "convention": "tsplib-nint", "objective": "distance", "vehicles": "5", "value": "200"},
    {"family": "top/set4", "instance": "b", "convention": "", "objective": "score(max)", "vehicles": "2", "value": "50"},
    {
        "family": "pdptw-lilim/100",
        "instance": "c",
        "convention": "",
        "objective": "vehicles-then-distance",
        "vehicles": "10",
        "value": "800",
    },
]


def test_a_gap_is_per_cent_of_the_best_value_known_and_never_below_0() -> None:
    assert gap((210.0,), "x/cvrp/X/a.vrp", KNOWN, {}) == pytest.approx(5.0)
    assert gap((199.0,), "x/cvrp/X/a.vrp", KNOWN, {"convention": "tsplib-nint"}) == 0.0
    assert gap((45.0,), "x/top/set4/b.txt", KNOWN, {}) == pytest.approx(10.0)
    assert gap((10.0, 808.0), "x/pdptw-lilim/100/c.txt", KNOWN, {}) == pytest.approx(1.0)
    assert gap((11.0, 700.0), "x/pdptw-lilim/100/c.txt", KNOWN, {}) == pytest.approx(10.0)  # the vehicles come first
    assert gap((910.0,), "x/op/chao66/set_66_1_060.txt", KNOWN, {}) == pytest.approx(100 * 5 / 915)
    assert gap((920.0,), "x/op/chao66/set_66_1_060.txt", KNOWN, {}) == 0.0
    assert math.isnan(gap((), "x/cvrp/X/a.vrp", KNOWN, {}))


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
    known = list(benchmark.known_values(benchmarks))
    for name, many in tasks(benchmarks, SETS, ["pyvrp"], [1], 1.0).items():
        for task in many:
            assert math.isfinite(gap((1.0, 1.0), task.path, known, SETS[name].row))


@pytest.mark.parametrize("solver", ["savings-or-so", "portfolio", BARE])
def test_a_run_is_judged_whoever_made_it(solver: str, tmp_path: Path) -> None:
    write_instance(wb.generate("random", customers=8, capacity=40).to_instance(), tmp_path / "a.json")
    task = Task(str(tmp_path / "a.json"), {}, solver, 1, 0.3)
    if solver == "savings-or-so":
        with pytest.raises(wb.UsageError):
            run(task)
    else:
        values, spent = run(task)
        assert len(values) == 1 and spent > 0.0
