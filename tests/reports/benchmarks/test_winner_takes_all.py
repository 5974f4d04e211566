"""The benchmark of forms compares equal optima, and notices when they are not."""

from __future__ import annotations

import pytest

from waybound.reports.benchmarks import winner_takes_all as benchmark


@pytest.mark.parametrize("weights", ["binary", "uniform"])
def test_all_forms_and_solvers_reach_the_same_optima(weights: str) -> None:
    text = benchmark.report(2, weights, 30.0, robots=4, targets=12, phi=30)
    installed = [solver for _, solver in benchmark.RUNS if benchmark.BACKENDS[solver.partition(":")[0]].installed()]
    assert text.count("2/2") == len(installed) >= 5
    assert "target" in text


def test_the_instance_has_the_size_of_the_largest_experiments() -> None:
    graph = benchmark.instance(0, "binary").graph
    assert (graph.num_robots, graph.num_actions, graph.num_targets, graph.num_edges) == (20, 40, 150, 900)


def test_a_wrong_value_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = benchmark.run

    def lying(problem, form, solver, limit):
        seconds, result, value = honest(problem, form, solver, limit)
        return seconds, result, value - (1.0 if form == "weak-linearisation" else 0.0)

    monkeypatch.setattr(benchmark, "run", lying)
    with pytest.raises(AssertionError, match="weak-linearisation"):
        benchmark.report(1, "binary", 30.0, robots=4, targets=12, phi=30)
