"""The benchmark of the local algorithm measures what it says; its times are not tested."""

import math
import sys

import pytest

from waybound.reports.benchmarks import local_algorithm as benchmark


def test_both_sides_are_given_the_same_program() -> None:
    graph = benchmark.instance("regular", 60)
    seconds, value = benchmark.local_seconds(graph, 3, 1)
    optima = [benchmark.highs_seconds(graph, advised)[1] for advised in (False, True)]
    assert seconds > 0
    assert optima[0] is not None
    assert optima[0] == pytest.approx(optima[1], rel=1e-6)
    assert 0 < value <= optima[0] + 1e-9


def test_memory_grows_no_faster_than_edges() -> None:
    small, large = (benchmark.instance("regular", robots) for robots in (500, 5000))
    benchmark.local_memory(large, 10)  # compiles what was not compiled before
    assert benchmark.local_memory(large, 10) / large.num_edges < 1.2 * benchmark.local_memory(small, 10) / small.num_edges


def test_a_slope_is_that_of_logarithms() -> None:
    assert benchmark.slope([10, 100, 1000], [1.0, 20.0, 400.0]) == pytest.approx(math.log10(20))


def test_a_table_is_printed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["local_algorithm", "--robots", "40", "80", "--heights", "1", "2", "--repeats", "1", "--highs", "40"])
    assert benchmark.main() == 0
    printed = capsys.readouterr().out
    assert "HiGHS, its own choice" in printed
    assert "slope" in printed


def test_heights_are_compared_with_the_optimum() -> None:
    means = benchmark.quality_of([1, 2], {"ring": [{"kind": "sensing-ring", "seed": 1, "robots": 30}]})
    assert means["mean"] == means["ring"]
    assert all(0 < mean <= 1 + 1e-9 for mean in means["ring"])
