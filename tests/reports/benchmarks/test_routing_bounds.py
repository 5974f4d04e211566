"""The table of verified bounds holds its gaps."""

from __future__ import annotations

import pytest

from waybound.reports.benchmarks import routing_bounds
from waybound.reports.benchmarks.routing_bounds import ProcessorTime, Row, best_bound, report, rows


@pytest.mark.long
def test_files_of_each_family_are_bounded_within_their_gaps(benchmarks):
    wanted = {"cvrp/A": ("A-n32-k5", 12.0), "top/set6": ("", 12.0), "minmax-mtsp/mtsplib": ("eil51-m2", 15.0)}
    for family, (name, percent) in wanted.items():
        row = next(row for row in rows(benchmarks, [family], 1) if name in row.problem.name)
        bound, kind, _ = best_bound(row.problem, 1.0)
        sign = 1.0 if row.problem.sense == "min" else -1.0
        assert bound is not None and kind
        assert -1e-9 <= sign * (row.best - bound) / row.best <= percent / 100.0


def test_a_bound_that_excludes_the_best_known_value_is_told(benchmarks, capsys, monkeypatch):
    row = next(rows(benchmarks, ["cvrp/P"], 1))
    monkeypatch.setattr(routing_bounds, "best_bound", lambda problem, seconds: (row.best * 0.9, "made-up", 0.5))
    text, good = report(iter([row]), 1.0)
    assert good and "| cvrp/P | 1 | 10.0 % | 10.0 % | 0.50 | made-up 1 |" in text
    _, good = report(iter([Row(row.family, row.problem, row.best * 0.5)]), 1.0)
    assert not good and "made-up proves" in capsys.readouterr().err


def test_time_of_the_processor_ends():
    stop = ProcessorTime(0.0)
    assert stop.reached() == "time" and not ProcessorTime(9.0).reached()
