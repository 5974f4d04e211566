"""The comparison of first-order methods: all of them come to the optimum, and its projections are projections."""

import sys

import numpy as np
import pytest
from random_sensing import even_graph, optimum, random_graph

from waybound.reports.benchmarks import first_order_steps as benchmark


@pytest.mark.parametrize("name", benchmark.METHODS)
def test_each_method_comes_to_the_optimum(name: str) -> None:
    graph = even_graph(1, 60)
    best, value, bound = optimum(graph), 0.0, np.inf
    for passes, pairs in benchmark.METHODS[name](graph):
        for pair in pairs:
            reached = benchmark.both(graph, pair)
            assert reached[0] <= best * (1 + 1e-9) and reached[1] >= best * (1 - 1e-9)
            value, bound = max(value, reached[0]), min(bound, reached[1])
        if passes >= 1200:
            break
    assert bound - value <= 2e-2 * best


@pytest.mark.parametrize("seed", range(5))
def test_projections_are_feasible_and_no_feasible_point_is_nearer(seed: int) -> None:
    graph, rng = random_graph(seed), np.random.default_rng(seed)
    sides = benchmark.Sides(graph)
    aims, prices = rng.normal(size=graph.num_actions), rng.normal(size=graph.num_targets)
    x, y = sides.shares(aims), sides.prices(prices)
    assert x.min() >= 0.0 and np.bincount(sides.owner, x) == pytest.approx(np.ones(sides.robots))
    assert y.min() >= 0.0 and y.sum() == pytest.approx(graph.num_targets)
    for _ in range(20):
        other = rng.random(len(x))
        other /= np.bincount(sides.owner, other)[sides.owner]
        assert (other - x) @ (aims - x) <= 1e-9  # the angle at a projection is obtuse
        another = rng.random(len(y))
        another *= len(y) / another.sum()
        assert ((another - y) * (prices - y) / sides.sigma).sum() <= 1e-9 * np.abs(prices / sides.sigma).sum()


def test_the_report_has_a_line_for_each_method(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["first_order_steps", "--families", "torus", "--robots", "36", "--most", "80"])
    benchmark.main()
    lines = capsys.readouterr().out.splitlines()
    assert [line[12:36].strip() for line in lines[1:]] == list(benchmark.METHODS)
