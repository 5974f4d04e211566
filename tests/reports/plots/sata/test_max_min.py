"""Pictures of max-min answers."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.collections import LineCollection

import waybound as wb
from waybound.formulations.sata.selections import Selection
from waybound.reports.plots.sata.max_min import plot_max_min


def texts(ax):
    return [t.get_text() for t in ax.texts]


def bars(ax):
    return [patch.get_height() for patch in ax.patches]


def lines(ax):
    return [len(c.get_segments()) for c in ax.collections if isinstance(c, LineCollection)]


def test_shares_are_drawn_as_well():
    problem = wb.read("figure-3-3", problem="bottleneck-lp")
    ax = plot_max_min(problem, np.array([2 / 3, 1 / 3, 1, 0, 1 / 3, 2 / 3]))
    assert [t for t in texts(ax) if t.startswith("t")] == ["t1  1.333", "t2  1.333", "t3  1.333"]
    assert lines(ax) == [1, 6]


def test_a_large_graph_becomes_a_chart_of_its_targets():
    graph = wb.generate("sata", robots=30, targets=70, phi=10, seed=2).graph
    chosen = Selection.of(range(0, 60, 2))
    covered = np.bincount(graph.indices, np.isin(graph.action_of_edge, list(chosen)).astype(float), minlength=70)
    ax = plot_max_min(wb.BottleneckSATA(graph), chosen)
    assert bars(ax) == sorted(covered.tolist())
    assert "70 of them in ascending order" in ax.get_xlabel()
    assert ax.lines[0].get_ydata()[0] == covered.min()


def test_the_chart_draws_the_bound_beside_the_worst():
    problem = wb.generate("sata", robots=30, targets=70, phi=10, seed=2, problem="bottleneck")
    solution = wb.solve(problem, heuristic="greedy")
    ax = solution.plot()
    assert ax.lines[1].get_ydata()[0] == solution.bound
    assert any(text.startswith("bound ") and solution.bound_kind in text for text in texts(ax))


@pytest.mark.parametrize(("sense", "rows", "level"), [("max", [0.5, 0.75], 0.5), ("min", [0.75, 0.5], 0.75)])
def test_a_max_min_program_becomes_a_chart_of_its_rows(sense, rows, level):
    problem = wb.MaxMinLP([[1, 1], [0, 2]], [[1, 0], [0, 3]], sense=sense)
    ax = plot_max_min(problem, [0.5, 0.25])
    assert bars(ax) == pytest.approx(sorted(rows))
    assert ax.lines[0].get_ydata()[0] == pytest.approx(level)
