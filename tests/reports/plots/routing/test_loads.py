from dataclasses import replace

import numpy as np
import pytest
from coded import coded

import waybound as wb
from waybound.reports.plots import views
from waybound.reports.plots.routing.loads import plot_loads


@pytest.fixture(scope="module")
def solution() -> wb.Solution:
    return wb.solve(wb.read("demo-c25"), heuristic="savings", bound_time=0)


def stairs(ax):
    from matplotlib.patches import StepPatch

    return [patch for patch in ax.patches if isinstance(patch, StepPatch)]


def test_a_bar_a_route_that_falls_with_each_delivery(solution: wb.Solution) -> None:
    drawn = stairs(solution.plot(view="loads"))
    assert len(drawn) == len(solution.answer)
    for patch, route in zip(drawn, solution.answer, strict=True):
        demand = solution.problem.sites.demand[list(route.visits)]
        np.testing.assert_allclose(patch.get_data().values, demand.sum() - np.append(0.0, np.cumsum(demand)))
    assert "loads" in views(solution.problem)


def test_how_full_a_vehicle_is_stands_above_its_capacity(solution: wb.Solution) -> None:
    texts = [text.get_text() for text in solution.plot(view="loads").texts]
    load = solution.problem.sites.demand[list(solution.answer.routes[0].visits)].sum()
    assert f"{100 * load / 200:.0f} %" in texts


def test_an_overfull_vehicle_is_red(solution: wb.Solution) -> None:
    small = replace(solution.problem, fleet=(replace(solution.problem.fleet[0], capacity=50.0),))
    assert stairs(plot_loads(small, solution.answer))[0].get_facecolor()[:3] == pytest.approx((0xB4 / 255, 0x23 / 255, 0x18 / 255))


def test_without_capacity_there_is_no_line(solution: wb.Solution) -> None:
    free = replace(solution.problem, fleet=(replace(solution.problem.fleet[0], capacity=np.inf),))
    assert plot_loads(free, solution.answer).get_legend() is None


def test_other_dimensions_than_there_are_are_refused(solution: wb.Solution) -> None:
    with pytest.raises(wb.UsageError, check=coded("out-of-range")):
        solution.plot(view="loads", dimension=2)


def test_a_route_has_one_colour_in_every_picture() -> None:
    from matplotlib.colors import to_hex

    solution = wb.solve(wb.read("demo-r25"), heuristic="insertion", bound_time=0)
    on_map = {int(line.get_gid()): to_hex(line.get_color()) for line in solution.plot().lines if (line.get_gid() or "").isdigit()}
    on_loads = dict(enumerate(to_hex(patch.get_facecolor()) for patch in stairs(solution.plot(view="loads"))))
    ends = [line for line in solution.plot(view="schedule").lines if line.get_marker() == "|" and line.get_markersize() == 9]
    on_schedule = {int(line.get_ydata()[0]): to_hex(line.get_color()) for line in ends}
    assert len(on_map) == len(solution.answer) > 2 and on_map == on_loads == on_schedule
