"""Sensing graphs as maps and in two columns."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.collections import LineCollection

import waybound as wb
from waybound.formulations.sata.selections import Selection
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.plots import PLOTS
from waybound.reports.plots.sata import sensing as sensing_plots
from waybound.reports.plots.sata.max_min import plot_max_min
from waybound.reports.plots.sata.selection import plot_selection


@pytest.fixture(scope="module")
def placed():
    return wb.generate("sensing-geometric", robots=30, seed=2).graph


def texts(ax):
    return [t.get_text() for t in ax.texts]


def marks(ax):
    return sum(len(c.get_offsets()) for c in ax.collections if not isinstance(c, LineCollection))


def lines(ax):
    return [len(c.get_segments()) for c in ax.collections if isinstance(c, LineCollection)]


def test_a_small_graph_is_drawn_in_two_columns_with_all_names():
    problem = wb.read("figure-3-3")
    ax = plot_max_min(problem, Selection.of([0, 2, 5]))
    named = texts(ax)
    assert all(name in named for name in ("r1", "r2", "r3", "p1", "p6"))
    assert [t for t in named if t.startswith("t")] == ["t1  2", "t2  1", "t3  1"]
    assert marks(ax) == 6 + 3
    assert lines(ax) == [3, 4]  # edges of actions that were not chosen, and of those that were
    assert ax.get_title(loc="left").startswith("figure-3-3: bottleneck")
    assert named[-1].startswith("max 1\n")


@pytest.mark.parametrize("kind", [wb.BottleneckSATA, wb.WinnerTakesAllSATA])
def test_positions_make_a_map(placed, kind):
    problem = kind(placed)
    ax = PLOTS[problem.family](problem, Selection.of([0, 5, 9]))
    assert ax.get_aspect() == 1.0
    assert marks(ax) == placed.num_actions + placed.num_targets
    assert sum(lines(ax)) == placed.num_edges
    drawn = np.vstack([np.asarray(c.get_offsets()) for c in ax.collections if not isinstance(c, LineCollection)])
    expected = np.vstack([placed.action_positions, placed.target_positions])
    assert sorted(map(tuple, drawn)) == sorted(map(tuple, expected))


def test_a_crowded_map_leaves_out_edges_that_nobody_uses(placed, monkeypatch):
    monkeypatch.setattr(sensing_plots, "MAP_EDGES", 1)
    ax = plot_max_min(wb.BottleneckSATA(placed), Selection.of([0]))
    assert lines(ax) == [placed.indptr[1]]


def test_a_graph_without_edges_can_be_drawn():
    graph = graph_of_edges([0], [], [], robots=1, targets=2)
    plot_max_min(wb.BottleneckSATA(graph), Selection.of([0])).figure.canvas.draw()
    plot_selection(wb.WinnerTakesAllSATA(graph_of_edges([], [], [], robots=1)), Selection()).figure.canvas.draw()
