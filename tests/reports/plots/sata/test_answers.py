"""Pictures of selections, max-min answers and sensing graphs."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection

import waybound as wb
from waybound.formulations.sata.selections import Selection
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.plots import PLOTS
from waybound.reports.plots.sata import answers
from waybound.reports.plots.sata.answers import plot_max_min, plot_selection


def bars(ax):
    return [patch.get_height() for patch in ax.patches]


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
    ax = plot_max_min(wb.read("figure-3-3"), Selection.of([0, 2, 5]))
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
    monkeypatch.setattr(answers, "MAP_EDGES", 1)
    ax = plot_max_min(wb.BottleneckSATA(placed), Selection.of([0]))
    assert lines(ax) == [placed.indptr[1]]


def test_a_graph_without_edges_can_be_drawn():
    graph = graph_of_edges([0], [], [], robots=1, targets=2)
    plot_max_min(wb.BottleneckSATA(graph), Selection.of([0])).figure.canvas.draw()
    plot_selection(wb.WinnerTakesAllSATA(graph_of_edges([], [], [], robots=1)), Selection()).figure.canvas.draw()


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
    ax = plot_max_min(wb.MaxMinLP([[1, 1], [0, 2]], [[1, 0], [0, 3]], sense=sense), [0.5, 0.25])
    assert bars(ax) == pytest.approx(sorted(rows))
    assert ax.lines[0].get_ydata()[0] == pytest.approx(level)


def test_a_large_graph_becomes_a_chart_of_what_robots_are_credited_with():
    graph = wb.generate("sata", robots=30, targets=70, phi=10, seed=2).graph
    chosen = Selection.of(range(0, 60, 2))
    seen = np.bincount(graph.indices, np.isin(graph.action_of_edge, list(chosen)).astype(float), minlength=70) > 0
    ax = plot_selection(wb.WinnerTakesAllSATA(graph), chosen)
    heights = bars(ax)
    assert sum(heights) == seen.sum() and heights == sorted(heights, reverse=True) and len(heights) == 30
    assert ax.lines[0].get_ydata()[-1] == seen.sum()
    assert any(f"{70 - seen.sum()} of 70 targets bring nothing" in text for text in texts(ax))


def test_the_credits_add_up_towards_the_bound():
    problem = wb.generate("sata", robots=20, targets=70, phi=10, seed=2, problem="winner-takes-all")
    solution = wb.solve(problem, heuristic="greedy")
    ax = solution.plot()
    climb, bound = ax.lines[:2]
    assert climb.get_ydata()[-1] == pytest.approx(solution.objective) and bound.get_ydata()[0] == solution.bound


def test_a_selection_climbs_to_its_bound():
    problem = wb.read("cover-30")
    solution = wb.solve(problem, "highs")
    ax = solution.plot()
    values = ax.lines[0].get_ydata()
    assert values[0] == 0 and values[-1] == solution.objective
    assert bars(ax) == np.diff(values).tolist()
    assert ax.lines[1].get_ydata()[0] == solution.bound
    assert "by highs" in ax.get_title(loc="left")
    assert [t.get_text() for t in ax.get_xticklabels()] == [problem.element_name(e) for e in solution.answer]


@pytest.mark.parametrize("method", ["greedy", "lazy-greedy", "stochastic-greedy"])
def test_the_order_of_choice_is_shown_where_one_is_known(method):
    solution = wb.solve(wb.read("cover-30"), heuristic=method, bound_time=0)
    ax = solution.plot()
    assert ax.get_xlabel() == "elements in the order of choice"
    assert "value after each choice, in their order" in texts(ax)[-1]
    assert [t.get_text() for t in ax.get_xticklabels()] == [solution.problem.element_name(e) for e in solution.answer]


@pytest.mark.parametrize("method", ["brute-force", "continuous-greedy", None])
def test_no_order_of_choice_is_claimed_where_none_is_known(method):
    problem = wb.generate("coverage", seed=3, elements=9, items=20, k=4)
    solution = wb.solve(problem, None if method else "highs", heuristic=method, bound_time=0)
    read_back = problem.answer_from_json(problem.answer_to_json(solution.answer))
    for ax in (solution.plot(), plot_selection(problem, read_back)):
        assert ax.get_xlabel() == "elements as the answer lists them"
        assert not any("choice" in text for text in texts(ax))


def test_many_elements_are_counted_and_not_named():
    problem = wb.generate("coverage", seed=3, elements=80, items=300, k=40)
    ax = wb.solve(problem, heuristic="greedy", bound_time=0).plot()
    assert ax.get_xlabel() == "number of elements"


def test_given_axes_and_titles_are_used():
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    assert plot_selection(wb.read("cover-30"), Selection.of([9]), ax=ax, title="mine") is ax
    assert ax.get_title(loc="left").strip() == "mine"
