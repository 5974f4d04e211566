import dataclasses
import math

import numpy as np
import pandas as pd
import pytest
from coded import coded
from draws import draws
from hypothesis import given, settings, strategies as st

import waybound as wb
from waybound import UsageError
from waybound.reports.plots import positions, save_plot
from waybound.reports.plots.drawing import axes_without_display
from waybound.reports.plots.positions import scaled_positions
from waybound.reports.plots.routing import routes as plots
from waybound.reports.plots.routing.routes import arrows, geographic, legend_of_routes, map_axes, plot_routes, scale_bar, site_positions


@pytest.fixture(scope="module")
def solution():
    return wb.solve(wb.read("demo-c25"), heuristic="savings", bound_time=0.5)


def route_lines(ax):
    return [line for line in ax.lines if line.get_gid() not in (None, "scale")]


def caption(ax):
    return next(text.get_text() for text in ax.texts if "distances" in text.get_text())


def test_every_route_is_drawn_through_its_sites_in_order(solution):
    ax = plot_routes(solution.problem, solution.answer)
    xy = solution.problem.sites.coordinates
    drawn = {int(line.get_gid()): line.get_xydata() for line in route_lines(ax)}
    assert sorted(drawn) == list(range(len(solution.answer)))
    for k, route in enumerate(solution.answer):
        np.testing.assert_allclose(drawn[k], xy[list(route.visits)])


def test_routes_differ_in_colour_and_beyond_the_colours_in_style():
    n = 2 * len(plots.COLOURS)
    angles = np.linspace(0, 2 * np.pi, n, endpoint=False)
    xy = np.vstack([[0, 0], np.column_stack([np.cos(angles), np.sin(angles)])])
    problem = wb.RoutingProblem(wb.Sites.of(range(n + 1), coordinates=xy), wb.Travel("euclidean", xy), (wb.VehicleType(),))
    lines = route_lines(plot_routes(problem, wb.Routes.of([[k] for k in range(1, n + 1)])))
    assert len({(line.get_color(), str(line._dash_pattern)) for line in lines}) == n


def test_the_title_tells_objective_bound_and_gap(solution):
    ax = solution.plot()
    told = ax.get_title(loc="left") + caption(ax)
    for words in (solution.problem.name, "savings", f"{round(solution.objective, 3):.10g}", "verified", "gap", "not rounded"):
        assert words in told


def test_a_legend_names_any_number_of_routes(solution, monkeypatch):
    assert len(solution.plot().get_legend().get_texts()) == len(solution.answer)
    monkeypatch.setattr(plots, "FEW_ROUTES", len(solution.answer) - 1)
    short = [text.get_text() for text in solution.plot().get_legend().get_texts()]
    assert short == [
        f"{name} ({len(route)})" for name, route in zip(solution.problem.vehicle_names(solution.answer), solution.answer, strict=True)
    ]


def test_both_axes_have_one_scale(solution):
    assert solution.plot().get_aspect() == 1.0


def test_given_axes_are_used(solution):
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    assert solution.plot(ax=ax) is ax


def test_sites_left_out_are_drawn_hollow(solution):
    ax = plot_routes(solution.problem, wb.Routes.of([solution.answer.routes[0].visits]))
    hollow = [c for c in ax.collections if c.get_facecolor()[0].tolist() == [1.0, 1.0, 1.0, 1.0]]
    assert sum(len(c.get_offsets()) for c in hollow) == len(solution.problem.customers) - len(solution.answer.routes[0])


@settings(max_examples=draws(25), deadline=None)
@given(st.integers(2, 12), st.integers(0, 2**32 - 1))
def test_scaling_recovers_distances_of_points_in_the_plane(n, seed):
    xy = np.random.default_rng(seed).normal(size=(n, 2))
    lengths = np.linalg.norm(xy[:, None] - xy[None, :], axis=2)
    placed = scaled_positions(lengths)
    np.testing.assert_allclose(np.linalg.norm(placed[:, None] - placed[None, :], axis=2), lengths, atol=1e-7)


def test_one_site_can_be_placed():
    assert scaled_positions(np.zeros((1, 1))).tolist() == [[0.0, 0.0]]


def test_a_problem_without_coordinates_is_placed_and_says_so():
    matrix = np.abs(np.arange(5)[:, None] - np.arange(5)[None, :]).astype(float)
    problem = wb.RoutingProblem(wb.Sites.of(range(5)), wb.Travel("EXPLICIT", matrix=matrix), (wb.VehicleType(),), name="line")
    assert "no coordinates" in caption(plot_routes(problem, wb.Routes.of([[1, 2, 3, 4]])))


def test_names_out_of_files_are_no_formulas(tmp_path):
    ids = ["$\\frac$", "$a$ & <b>", "c" * 10_000]
    problem = wb.RoutingProblem(
        wb.Sites.of(ids, coordinates=[[0, 0], [1, 0], [0, 2]]), wb.Travel("euclidean", [[0, 0], [1, 0], [0, 2]]),
        (wb.VehicleType(name="$\\sqrt$"),), name="$x^$ $\\undefined$",
    )  # fmt: skip
    solution = wb.solve(problem, heuristic="savings", bound_time=0)
    ax = solution.plot()
    assert not any(text.get_parse_math() or len(text.get_text()) > 250 for text in ax.texts)
    save_plot(solution, tmp_path / "a.svg")
    one = wb.solve(
        wb.RoutingProblem(problem.sites, problem.travel, (wb.VehicleType(max_distance=4.0, name="$\\sqrt$"),)), "highs", bound_time=0
    )
    assert len(one.answer) > 1 and not any(text.get_parse_math() for text in one.plot().get_legend().get_texts())
    save_plot(one, tmp_path / "b.png")


def test_vehicles_are_numbered_within_their_type_as_everywhere(solution):
    fleet = (wb.VehicleType(3, 200, name="old"), wb.VehicleType(1, 200, name="new"))
    mixed = dataclasses.replace(solution.problem, fleet=fleet)
    answer = wb.Routes((wb.Route((1, 2)), wb.Route((3,), vehicle=1), wb.Route((4, 5))))
    legend = plot_routes(mixed, answer).get_legend()
    assert [text.get_text() for text in legend.get_texts()] == ["old 1: 2 visits", "new 1: 1 visits", "old 2: 2 visits"]
    assert list(dict.fromkeys(mixed.answer_to_frame(answer)["vehicle"])) == mixed.vehicle_names(answer)


def test_what_is_kept_of_sites_is_written_below_their_ids_where_it_is_asked_for():
    frame = pd.DataFrame({"id": ["yard", "a", "b"], "x": [0, 3, 9], "y": [0, 4, 0], "price": ["$1", None, "2$"], "note": "-"})
    problem = wb.RoutingProblem.from_frame(frame, vehicles=1)
    texts = plot_routes(problem, problem.answer_of([["a", "b"]]), labels="price").texts
    assert {"yard\n$1", "a", "b\n2$"} <= {text.get_text() for text in texts} and not any(text.get_parse_math() for text in texts)
    with pytest.raises(UsageError, match="labels name the column 'prise', which is not kept; choose from price, note; did you"):
        plot_routes(problem, problem.answer_of([["a", "b"]]), labels="prise")
    with pytest.raises(UsageError, check=coded("unknown-name")):
        plot_routes(wb.read("demo-tiny"), wb.Routes.of([[1]]), labels="price")


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
    length = float(np.ptp(bar.get_xdata())) * (plots.KM_A_DEGREE if globe else 1.0)
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
