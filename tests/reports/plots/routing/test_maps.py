"""What maps share: positions, scale bars, arrows, legends."""

from __future__ import annotations

import math

import numpy as np
import pytest

import waybound as wb
from waybound.reports.plots import positions
from waybound.reports.plots.drawing import axes_without_display
from waybound.reports.plots.positions import scaled_positions
from waybound.reports.plots.routing import maps
from waybound.reports.plots.routing.maps import arrows, geographic, legend_of_routes, map_axes, scale_bar, site_positions


def problem_of(metric: str, travel, sites=None) -> wb.RoutingProblem:
    return wb.RoutingProblem(wb.Sites.of(range(len(travel)), coordinates=sites), wb.Travel(metric, np.array(travel)), (wb.VehicleType(),))


def test_latitudes_point_up_in_decimal_degrees_wherever_they_stand() -> None:
    told = [[10.30, 1.0], [50.0, -2.15]]  # latitude, longitude in degrees and minutes, as distances are computed from
    for problem in (problem_of("GEO", told), problem_of("GEO", told, [[1.0, 10.30], [-2.15, 50.0]])):
        assert geographic(problem)
        np.testing.assert_allclose(site_positions(problem)[0], [[1.0, 10.5], [-2.25, 50.0]])


def test_positions_in_the_plane_are_those_of_the_file() -> None:
    problem = problem_of("euclidean", [[3.0, 4.0], [5.0, 6.0]])
    assert not geographic(problem)
    assert site_positions(problem)[0].tolist() == [[3.0, 4.0], [5.0, 6.0]]


def test_too_many_sites_without_coordinates_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(positions, "SCALED_SITES", 3)
    with pytest.raises(wb.UsageError, match="too many"):
        scaled_positions(np.zeros((4, 4)))


def test_on_the_globe_a_degree_of_longitude_shrinks_with_the_latitude() -> None:
    ax = axes_without_display()
    map_axes(ax, np.array([[0.0, 50.0], [1.0, 70.0]]), True)
    assert ax.get_aspect() == pytest.approx(1.0 / math.cos(math.radians(60.0)))
    map_axes(ax, np.array([[0.0, 50.0], [1.0, 70.0]]), False)
    assert ax.get_aspect() == 1.0


@pytest.mark.parametrize(
    ("width", "globe", "told"),
    [(100.0, False, "20 units"), (7.0, False, "1 unit"), (0.4, False, "0.05 units"), (1.0, True, "20 km"), (0.001, True, "20 m")],
)
def test_a_scale_bar_has_a_round_length_and_is_as_long_as_it_says(width: float, globe: bool, told: str) -> None:
    ax, where = axes_without_display(), np.array([[0.0, 0.0], [width, 0.0]])
    scale_bar(ax, where, globe)
    (bar,), (text,) = [line for line in ax.lines if line.get_gid() == "scale"], ax.texts
    assert text.get_text() == told
    length = float(np.ptp(bar.get_xdata())) * (maps.KM_A_DEGREE if globe else 1.0)
    value, unit = told.split()
    assert length == pytest.approx(float(value) / (1000.0 if unit == "m" else 1.0))
    assert 0.05 * width <= float(np.ptp(bar.get_xdata())) <= 0.25 * width


def test_sites_in_one_place_have_no_scale() -> None:
    ax = axes_without_display()
    scale_bar(ax, np.zeros((3, 2)), False)
    assert not ax.lines and not ax.texts


def test_arrows_point_along_the_way() -> None:
    ax = axes_without_display()
    way = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    arrows(ax, way, "#000000", 2, 8.0)
    for text, (a, b) in zip(ax.texts, [(way[0], way[1]), (way[1], way[2])], strict=True):
        onward = np.array(text.xy) - np.array(text.xyann)
        assert onward @ (b - a) > 0.0 and abs(onward[0] * (b - a)[1] - onward[1] * (b - a)[0]) < 1e-9
    arrows(ax, np.zeros((3, 2)), "#000000", 2, 8.0)
    arrows(ax, np.zeros((1, 2)), "#000000", 2, 8.0)
    assert len(ax.texts) == 2


@pytest.mark.parametrize(("count", "columns", "entries"), [(2, 1, 2), (26, 1, 26), (27, 1, 27), (60, 2, 60), (156, 4, 156), (500, 4, 156)])
def test_a_legend_fits_any_number_of_routes(count: int, columns: int, entries: int) -> None:
    ax = axes_without_display()
    handles = [ax.plot([], [])[0] for _ in range(count)]
    legend_of_routes(ax, handles, [f"vehicle {k}" for k in range(count)])
    legend = ax.get_legend()
    assert legend._ncols == columns and len(legend.get_texts()) == entries
    if count > entries:
        assert legend.get_texts()[-1].get_text() == f"and {count - entries + 1} more"
