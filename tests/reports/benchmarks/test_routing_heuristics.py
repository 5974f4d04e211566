"""Gaps of routing heuristics to the best answers known."""

from __future__ import annotations

from pathlib import Path

import pytest

import waybound as wb
from waybound.reports.benchmarks import routing_heuristics as benchmark


def test_the_table_has_a_line_for_each_heuristic_and_fails_where_a_best_value_is_beaten(capsys: pytest.CaptureFixture[str]) -> None:
    problem = wb.read("demo-tiny")
    plain = benchmark.Row("vrptw-solomon", problem, 1.0)
    text, good = benchmark.report([plain], 5.0)
    assert good and [line.split()[2] for line in text.splitlines()[1:]] == ["savings", "split", "insertion"]
    assert not benchmark.report([benchmark.Row("vrptw-solomon", problem, 1e9)], 5.0)[1]
    assert "best known 1000000000.0" in capsys.readouterr().out


def test_files_are_run_under_the_convention_of_their_row(benchmarks: Path) -> None:
    (row,) = [row for row in benchmark.rows(benchmarks, ["cvrp/E"]) if row.problem.name.startswith("E-n51")]
    assert row.best == 521 and row.problem.convention == "round" and row.problem.vehicle_limit is None
    shared = list(benchmark.rows(benchmarks, ["minmax-mtsp"]))
    assert len({row.problem.vehicle_limit for row in shared}) > 1 and {str(row.problem.objective) for row in shared} == {"longest-route"}


def test_split_is_within_a_fifth_of_the_best_known_on_small_files(benchmarks: Path) -> None:
    found = [row for row in benchmark.rows(benchmarks, ["cvrp/P"]) if len(row.problem.sites) < 60]
    text, good = benchmark.report(found, 30.0)
    assert good
    assert float(next(line for line in text.splitlines() if " split " in line).split()[3].rstrip("%")) < 15
