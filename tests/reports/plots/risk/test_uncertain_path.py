import numpy as np
import pytest
from matplotlib.collections import LineCollection
from uncertain_graphs import WORKED, graph_of

import waybound as wb
from waybound.instances.generating import generate
from waybound.reports.plots import save_plot
from waybound.reports.plots.risk import uncertain_path as plots


def segments(ax):
    return sum(len(c.get_segments()) for c in ax.collections if isinstance(c, LineCollection))


def test_the_path_stands_out_from_the_other_non_dominated_ones():
    ax = wb.solve(wb.UncertainPath(graph_of(WORKED))).plot()
    widths = [line.get_linewidth() for line in ax.lines]
    assert (len(widths), widths.index(max(widths))) == (6, 5)
    assert segments(ax) == 10
    names = {t.get_text() for t in ax.texts}
    assert set("SABCDEG") <= names
    assert any("5 non-dominated ones" in text for text in names)


def test_places_are_positions_or_columns_from_the_start():
    g = generate("prm-graph", 1, vertices=12)
    assert plots.places(g) is g.positions
    g = graph_of([*WORKED, ("X", "S", 1, 1)])
    at = {g.vertex_name(v): tuple(place) for v, place in enumerate(plots.places(g).tolist())}
    assert len(set(at.values())) == g.num_vertices
    assert at["S"][0] < at["A"][0] == at["B"][0] < at["C"][0]
    assert at["G"][0] == max(x for x, _ in at.values())


def test_many_edges_are_left_out(monkeypatch):
    monkeypatch.setattr(plots, "MAP_EDGES", 5)
    assert segments(wb.solve(wb.UncertainPath(graph_of(WORKED))).plot()) == 0


@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_it_is_written(tmp_path, suffix):
    save_plot(wb.solve(wb.generate("prm-graph", vertices=30)), tmp_path / f"map{suffix}")
    assert (tmp_path / f"map{suffix}").stat().st_size > 5000


def test_dark_edges_are_uncertain_ones():
    ax = wb.solve(wb.UncertainPath(graph_of(WORKED))).plot()
    shades = next(c for c in ax.collections if isinstance(c, LineCollection)).get_colors()[:, 3]
    assert (np.argsort(shades)[-1], shades.max()) == (int(np.argmax(graph_of(WORKED).variance)), pytest.approx(0.46))
