"""The table of one file a family."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from waybound import read
from waybound.reports.benchmarks import routing_families as benchmark
from waybound.reports.benchmarks.routing_families import Known, Ran, row


def said(objective: Any, bound: Any, sense: str = "min", feasible: bool = True) -> dict[str, Any]:
    return {"objective": objective, "sense": sense, "seconds": {"solve": 1.0}, "certificate": {"bound": bound, "feasible": feasible}}


def test_a_row_tells_gaps_to_the_best_known_and_to_the_verified_bound() -> None:
    cells, good = row("CVRP", "pyvrp", Ran(0, said(110.0, 99.0), "", 2.0), Known((100.0,), "100"))
    assert good and cells[2:6] == ["110", "100", "10.0 %", "99 (10.0 %)"]
    cells, good = row("TOP", "pyvrp", Ran(0, said(90.0, None, "max"), "", 2.0), Known((80.0,), "80"))
    assert good and cells[2:6] == ["90", "80", "better by 12.5 %", "none"]


def test_with_priorities_the_first_level_that_differs_counts() -> None:
    cells, good = row("PDPTW", "pyvrp", Ran(0, said([10.0, 900.0], [9.0, None]), "", 2.0), Known((10.0, 800.0), "10, 800"))
    assert good and cells[2:6] == ["10, 900", "10, 800", "12.5 %", "9 (10.0 %)"]


def test_a_cost_behind_what_is_done_is_compared_as_a_cost() -> None:
    cells, good = row("VROOM JSON", "pyvrp", Ran(0, said([50.0, 550.0], [50.0, None], "max"), "", 2.0), Known((500.0,), "500"))
    assert good and cells[4] == "10.0 %"
    cells, good = row("VROOM JSON", "highs", Ran(0, said([5.0, 200.0], [50.0, None], "max"), "", 2.0), Known((500.0,), "500"))
    assert good and cells[4] == ""  # what little costs says nothing of what all does


def test_a_refusal_shows_what_is_lacking_and_everything_else_is_a_fault() -> None:
    cells, good = row(
        "OP", "vroom", Ran(2, {}, "vroom cannot take this problem: it does not handle objective:reward; can take it: pyvrp", 1.0), None
    )
    assert good and cells[2] == "lacks objective:reward"
    assert not row("OP", "vroom", Ran(2, {}, "the content allows more than one format", 1.0), None)[1]
    assert not row("OP", "vroom", Ran(1, {}, "Traceback", 1.0), None)[1]


@pytest.mark.parametrize(("objective", "bound", "sense"), [(90.0, 99.0, "min"), (90.0, 80.0, "max")])
def test_an_answer_beyond_a_verified_bound_is_a_fault(objective: float, bound: float, sense: str) -> None:
    assert not row("CVRP", "pyvrp", Ran(0, said(objective, bound, sense), "", 2.0), None)[1]


def test_no_answer_within_the_limit_is_none() -> None:
    cells, good = row("MDVRP", "highs", Ran(4, said(None, 550.0), "", 6.0), Known((576.87,), "576.87"))
    assert good and cells[2:6] == ["no answer", "576.87", "", "550"]
    assert math.isnan(benchmark.distance((), (1.0,)))


@pytest.mark.long
def test_a_run_is_the_command() -> None:
    ran = benchmark.solve(Path("demo-tiny"), "savings", 5.0, ())
    assert ran.code == 0 and row("VRPTW", "savings", ran, None)[1]


def test_every_sample_is_a_file_that_is_read_and_most_have_a_value(benchmarks: Path) -> None:
    known = [benchmark.best_known(benchmarks, sample) for sample in benchmark.FAMILIES.values()]
    assert sum(found is not None for found in known) == len(known) - 1
    for sample in benchmark.FAMILIES.values():
        assert read(benchmarks / sample.path, **sample.settings()).family == "routing"
