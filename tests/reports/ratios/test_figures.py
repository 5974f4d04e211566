import math

import numpy as np
import pytest
from matplotlib.figure import Figure as Canvas

from waybound.reports.ratios.figures import SHOWN_POINTS, ratio_figure, sweep_figure
from waybound.reports.studies.study import STUDIES, StudySetting


def row(heuristic: str, family: str, low: float | None, high: float | None, repeats: int = 1) -> dict[str, object]:
    return {"heuristic": heuristic, "family": family, "stated_min": low, "stated_max": high, "repeats": repeats}


def seen(heuristic: str, family: str, ratio: float, stated: float | None) -> dict[str, object]:
    return {"heuristic": heuristic, "family": family, "ratio": ratio, "stated": stated}


def drawn(figure) -> Canvas:  # type: ignore[no-untyped-def]
    canvas = Canvas(figsize=figure.size, layout="constrained")
    figure.draw(canvas)
    return canvas


def points(panel) -> np.ndarray:  # type: ignore[no-untyped-def]
    return np.concatenate([np.asarray(c.get_offsets()) for c in panel.collections])


def test_figures_hold_every_configuration_and_family():
    report = STUDIES["sequential-greedy"](StudySetting(24))
    canvas = drawn(report.figures[0])
    assert [panel.get_title() for panel in canvas.axes] == ["in order", "reversed", "random order"]
    assert [label.get_text() for label in canvas.axes[0].get_yticklabels()] == list(dict.fromkeys(r["family"] for r in report.rows))


def test_every_ratio_its_mean_and_the_stated_ratio_stand_on_the_line_of_their_family():
    rows = [row("g", "covers", 2.0, 2.0), row("g", "halves", 2.0, 2.0)]
    (panel,) = drawn(ratio_figure("n", "s", rows, [seen("g", "covers", r, 2.0) for r in (1.0, 1.5)] + [seen("g", "halves", 2.0, 2.0)])).axes
    at = points(panel)
    assert sorted(at[:, 0]) == [1.0, 1.5, 2.0] and (np.abs(at[:, 1] - np.round(at[:, 1])) <= 0.25).all()
    means = [(line.get_xdata()[0], line.get_ydata()[0]) for line in panel.lines if line.get_label() == "mean"]
    assert means == [(1.25, 0), (2.0, 1)]
    assert [line.get_xdata()[0] for line in panel.lines if line.get_label() == "stated"] == [2.0, 2.0]
    assert "ratio OPT/ALG" in panel.get_xlabel()


def test_stated_ratios_that_differ_are_shown_as_shares_of_the_stated_loss():
    observed = [seen("g", "f", 1.5, 2.0), seen("g", "f", 1.5, 3.0), seen("g", "f", 1.0, 1.0), seen("g", "f", 1.2, None)]
    (panel,) = drawn(ratio_figure("n", "s", [row("g", "f", 1.0, 3.0)], observed)).axes
    assert sorted(points(panel)[:, 0]) == [0.25, 0.5]
    assert "share of the stated loss" in panel.get_xlabel()


def test_infinite_ratios_are_left_out_and_thousands_are_thinned_but_for_the_worst():
    observed = [seen("g", "f", r, 2.0) for r in (*(1.0 + k / 1e5 for k in range(4 * SHOWN_POINTS)), math.inf, 1.9)]
    (panel,) = drawn(ratio_figure("n", "s", [row("g", "f", 2.0, 2.0)], observed)).axes
    at = points(panel)
    assert len(at) <= SHOWN_POINTS + 1 and at[:, 0].max() == 1.9 and np.isfinite(at).all()


def test_means_over_runs_are_told():
    (panel,) = drawn(ratio_figure("n", "s", [row("g", "f", 2.0, 2.0, repeats=60)], [seen("g", "f", 1.1, 2.0)])).axes
    assert "ALG a mean of 60 runs" in panel.get_xlabel()


def test_a_sweep_shows_the_mean_of_each_method_with_its_range():
    rows = [{"x": x, "method": m, "min": 1.0, "mean": mean, "max": 4.0} for m, mean in (("a", 2.0), ("b", 3.0)) for x in (10, 20)]
    panels = [(axis, head, ["a", "b", "none"], rows) for axis, head in (("robots", "left"), ("targets", "right"))]
    left, right = drawn(sweep_figure("n", "title", panels, "q")).axes
    assert (left.get_ylabel(), left.get_xlabel(), right.get_xlabel(), right.get_title()) == ("q", "robots", "targets", "right")
    assert [c.lines[0].get_ydata().tolist() for c in left.containers] == [[2.0, 2.0], [3.0, 3.0]]
    assert [c.lines[0].get_xdata().mean() for c in left.containers] == pytest.approx([15.0, 15.0], abs=3.0)
    (bars,) = left.containers[0].lines[2]
    assert [segment[:, 1].tolist() for segment in bars.get_segments()] == [[1.0, 4.0], [1.0, 4.0]]
