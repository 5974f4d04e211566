"""Pictures of risk allocations."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.patches import Ellipse
from risk_problems import problem

import waybound as wb
from waybound.formulations.risk.allocations import Allocation
from waybound.instances.errors import UsageError
from waybound.reports.plots import save_plot, views
from waybound.reports.plots.risk_allocation import plot_risk_allocation


def test_a_trajectory_has_an_ellipse_a_step_and_its_limits() -> None:
    p = wb.generate("risk-allocation", family="corridor", steps=3)
    ax = plot_risk_allocation(p, np.zeros(6))
    ellipses = [patch for patch in ax.patches if isinstance(patch, Ellipse)]
    assert len(ellipses) == 3
    assert ellipses[0].height == pytest.approx(2 * 2.4477 * 0.01, rel=1e-4)
    assert len(ax.lines) == 1 + 6
    assert "ellipses that hold 95 % each" in ax.texts[0].get_text()


def test_heights_are_drawn_over_time() -> None:
    p = wb.generate("risk-allocation", steps=3)
    ax = plot_risk_allocation(p, np.zeros(3))
    assert ax.get_ylabel() == "altitude" and len(ax.lines) == 1 + 3
    assert ax.lines[0].get_ydata() == pytest.approx([12.0, 12.0, 12.0])


def test_obstacles_are_boxes() -> None:
    p = wb.generate("risk-allocation", family="obstacles", steps=2, obstacles=2)
    ax = plot_risk_allocation(p, np.zeros(4))
    assert sum(not isinstance(patch, Ellipse) for patch in ax.patches) == 2


def test_risks_are_bars_under_their_budget() -> None:
    ax = plot_risk_allocation(problem(), Allocation.of([1.0, 3.0], [0.02, 0.08]))
    assert [bar.get_height() for bar in ax.patches[:2]] == [0.02, 0.08]
    assert ax.lines[0].get_ydata()[0] == pytest.approx(0.05)
    assert "any fails with probability" in ax.texts[0].get_text()


def test_violations_are_counted() -> None:
    ax = plot_risk_allocation(problem(), [5.0, 5.0], view="violations")
    assert [bar.get_height() for bar in ax.patches] == pytest.approx([0.25, 0.5, 0.25], abs=0.02)


def test_other_views_are_refused() -> None:
    with pytest.raises(UsageError, match="shows risks, violations, not 'trajectory'"):
        plot_risk_allocation(problem(), [1.0, 1.0], view="trajectory")


def test_views_are_those_of_a_solution_and_of_the_command_line(tmp_path) -> None:
    assert {"trajectory", "risks", "violations", "history"} == set(views(problem()))
    solution = wb.solve(problem(), heuristic="iterative", bound_time=0)
    assert "any fails with probability" in solution.plot(view="risks").texts[0].get_text()
    assert "samples" in solution.plot(view="violations").get_ylabel()
    save_plot(solution, tmp_path / "risks.svg", "risks")
    assert (tmp_path / "risks.svg").stat().st_size > 1000
