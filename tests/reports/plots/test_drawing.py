import numpy as np
import pytest

import waybound as wb
from waybound.reports.plots import drawing
from waybound.reports.plots.drawing import axes_without_display, bars, entitle, figures_of, rounded


def test_captions_have_three_decimals_and_a_dash_for_what_is_not_known():
    assert rounded(1.23456) == "1.235"
    assert rounded([2.0, None, 1 / 3]) == "2 then - then 0.333"


def test_figures_tell_objective_bound_and_gap_or_the_value_alone():
    problem = wb.read("figure-3-3")
    solution = wb.solve(problem, "highs")
    assert figures_of(problem, solution.answer, solution) == "1, bound 1 (verified), gap 0 %"
    assert figures_of(problem, solution.answer, None) == "1"


@pytest.mark.parametrize(("most", "heights", "names"), [(3, [5.0, 1.0, 3.0], ["a", "b", "c"]), (2, [1.0, 3.0, 5.0], [])])
def test_bars_are_named_in_their_order_or_else_ascend_in_their_own_colours(monkeypatch, most, heights, names):
    monkeypatch.setattr(drawing, "LABELLED_BARS", most)
    ax = axes_without_display()
    bars(ax, np.array([5.0, 1.0, 3.0]), ["a", "b", "c"], "target", colours=["red", "green", "blue"])
    assert [patch.get_height() for patch in ax.patches] == heights
    assert [text.get_text() for text in ax.get_xticklabels()] == names
    assert {patch.get_height(): patch.get_facecolor()[:3] for patch in ax.patches}[5.0] == (1.0, 0.0, 0.0)


def test_titles_are_cut_and_shown_as_they_are():
    ax = axes_without_display()
    entitle(ax, "$x$" * 100, "a\x1b[2J")
    assert len(ax.get_title(loc="left").strip()) <= 120
    assert all(not text.get_parse_math() and text.get_text().isprintable() for text in ax.texts)
