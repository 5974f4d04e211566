import math
import sys

import numpy as np
import pytest

from waybound.reports.benchmarks import saddle as benchmark


def test_the_graphs_of_its_own_are_as_they_say() -> None:
    expander = benchmark.expander(50)
    assert (expander.num_robots, expander.num_actions) == (50, 100)
    assert (np.diff(expander.indptr) <= 2).all() and np.bincount(expander.indices).max() <= 4
    torus = benchmark.torus(49)
    assert (torus.num_robots, torus.num_actions, torus.num_targets) == (49, 196, 49)
    assert (np.diff(torus.indptr) == 1).all() and (np.bincount(torus.indices) == 4).all()
    assert torus.weights.min() >= 0.7 and torus.weights.max() <= 1.3
    joined = benchmark.joined(400)
    for matrix in (joined.packing, joined.covering):
        assert matrix.rows == 200 and (np.diff(matrix.indptr) <= 4).all() and np.bincount(matrix.indices).max() == 2
    assert "several-packing-rows" in joined.features()


@pytest.mark.parametrize("family", benchmark.PROGRAMS)
def test_what_is_measured_is_proved_and_highs_agrees(family: str) -> None:
    graph = benchmark.PROGRAMS[family](36)
    found = benchmark.measure(graph, 1e-3, 30.0)
    assert found.value <= found.bound * (1 + 1e-9) and found.bound - found.value <= 1e-3 * found.value * 1.01
    told = [seconds for seconds in found.until if not math.isnan(seconds)]
    assert told == sorted(told) and len(told) >= 3 and told[-1] <= found.seconds
    words = benchmark.by_highs(graph, "simplex", 30.0)
    assert float(words.rsplit(" ", 1)[1]) == pytest.approx(found.value, rel=2e-3)


def test_highs_that_is_given_up_is_told() -> None:
    assert "simplex given up after" in benchmark.by_highs(benchmark.expander(400), "simplex", 0.0)


def test_the_report_has_a_line_for_each_size(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["saddle", "--families", "torus", "--robots", "16", "25", "--gap", "1e-2", "--repeats", "1"])
    benchmark.main()
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in lines if line.startswith("torus")] == [["torus", "16", "64"], ["torus", "25", "100"]]
    assert sum("HiGHS" in line for line in lines) == 4
