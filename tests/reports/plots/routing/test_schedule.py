import numpy as np
import pandas as pd
import pytest

import waybound as wb
from waybound.formulations.routing.judge import schedule
from waybound.reports.plots import save_plot, views
from waybound.reports.plots.routing.schedule import plot_schedule


@pytest.fixture(scope="module")
def solution() -> wb.Solution:
    return wb.solve(wb.read("demo-r25"), heuristic="savings", bound_time=0)


def services(ax):
    return [p for p in ax.patches if p.get_height() == pytest.approx(0.42)]


def test_every_visit_is_a_bar_as_long_as_its_service_where_it_begins(solution: wb.Solution) -> None:
    bars = services(plot_schedule(solution.problem, solution.answer))
    assert len(bars) == sum(map(len, solution.answer))
    first = schedule(solution.problem, solution.answer.routes[0])
    drawn = [bar.get_x() for bar in bars if round(bar.get_y() + 0.21) == 0]
    np.testing.assert_allclose(drawn, first.begin)
    service = solution.problem.sites.service[solution.answer.routes[0].visits[0]]
    assert bars[0].get_width() == pytest.approx(service)


def test_a_route_is_drawn_from_departure_to_return(solution: wb.Solution) -> None:
    ax = plot_schedule(solution.problem, solution.answer)
    drawn = [
        line.get_xdata() for line in ax.lines if line.get_marker() == "|" and len(line.get_xdata()) == 2 and line.get_markersize() == 9
    ]
    plans = [schedule(solution.problem, route) for route in solution.answer]
    np.testing.assert_allclose(drawn, [[plan.departure, plan.finish] for plan in plans])


def test_a_late_visit_is_red() -> None:
    problem = wb.read("demo-r25")
    late = wb.Routes.of([[int(k) for k in problem.customers]])
    colours = {bar.get_facecolor()[:3] for bar in services(plot_schedule(problem, late))}
    assert len(colours) == 2


def test_rows_are_named_and_sites_labelled(solution: wb.Solution) -> None:
    ax = solution.plot(view="schedule")
    assert [text.get_text() for text in ax.get_yticklabels()] == solution.problem.vehicle_names(solution.answer)
    assert "schedule" in views(solution.problem)


def test_problems_without_windows_have_a_schedule_too(tmp_path) -> None:
    made = wb.solve(wb.read("demo-x40"), heuristic="savings", bound_time=0)
    save_plot(made, tmp_path / "a.svg", "schedule")
    assert (tmp_path / "a.svg").stat().st_size > 1000


def test_times_that_were_given_as_moments_are_shown_as_moments() -> None:
    day = pd.Timestamp("2026-05-04")
    due = [day + pd.Timedelta(hours=h) for h in (18, 12, 12)]
    sites = pd.DataFrame({"id": ["d", "a", "b"], "x": [0, 60, 90], "y": [0, 0, 40], "ready": day + pd.Timedelta("8h"), "due": due})
    problem = wb.RoutingProblem.from_frame(sites, vehicles=1, time_unit="min")
    ax = plot_schedule(problem, wb.Routes.of([[1, 2]]))
    ax.figure.canvas.draw()
    shown = [label.get_text() for label in ax.get_xticklabels()]
    assert "09:00" in shown and all(len(text) == 5 for text in shown)
    assert ax.get_xlabel() == "hours of 2026-05-04"
