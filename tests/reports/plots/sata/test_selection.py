"""Pictures of selections."""

from __future__ import annotations

import numpy as np
import pytest

import waybound as wb
from waybound.formulations.sata.selections import Selection
from waybound.reports.plots.sata.selection import plot_selection


def texts(ax):
    return [t.get_text() for t in ax.texts]


def bars(ax):
    return [patch.get_height() for patch in ax.patches]


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
