import numpy as np
import pytest
from coded import coded
from matplotlib.patches import Ellipse
from risk_problems import problem

import waybound as wb
from waybound import Allocation, UsageError
from waybound.reports.plots import save_plot, views
from waybound.reports.plots.risk.risk_allocation import plot_risk_allocation


def test_a_trajectory_has_an_ellipse_a_step_and_its_limits() -> None:
    ax = plot_risk_allocation(wb.generate("risk-allocation", family="corridor", steps=3), np.zeros(6))
    ellipses = [patch for patch in ax.patches if isinstance(patch, Ellipse)]
    assert len(ellipses) == 3
    assert ellipses[0].height == pytest.approx(2 * 2.4477 * 0.01, rel=1e-4)
    assert len(ax.lines) == 1 + 6
    assert "ellipses that hold 95 % each" in ax.texts[0].get_text()


def test_heights_are_drawn_over_time() -> None:
    ax = plot_risk_allocation(wb.generate("risk-allocation", steps=3), np.zeros(3))
    assert ax.get_ylabel() == "altitude" and len(ax.lines) == 1 + 3
    assert ax.lines[0].get_ydata() == pytest.approx([12.0, 12.0, 12.0])


def test_all_states_with_limits_of_their_own_are_drawn() -> None:
    two = {
        "state": [[1, 0], [0, 1]], "input": [[1, 0], [0, 1]], "noise": [0.01, 0.04], "start": [4, 5], "steps": 3,
        "states": ["h1", "h2"], "inputs": ["u1", "u2"],
    }  # fmt: skip
    p = problem(
        decisions=None, quantities=None, dynamics=two, constraints=None, cost={"quantities": [1, 1] * 3},
        chance={"quantities": (-np.eye(6)).tolist(), "limits": [-1, -2] * 3},
    )  # fmt: skip
    ax = plot_risk_allocation(p, np.zeros(6))
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["h1", "h2"]
    lines = [line for line in ax.lines if len(line.get_xdata()) == 3]
    assert [line.get_ydata().tolist() for line in lines] == [[4, 4, 4], [5, 5, 5]] and len(ax.lines) == 2 + 6
    band = ax.collections[1].get_paths()[0].vertices[:, 1]
    assert band.max() - band.min() == pytest.approx(2 * 1.96 * 0.12**0.5, rel=1e-4)


def test_joint_risk_allows_no_constraint_one_of_its_own() -> None:
    ax = plot_risk_allocation(problem(risk__kind="joint"), np.array([1.0, 3.0]))
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["at the decision"]
    assert "any fails with probability 0.02278 of 0.1" in ax.texts[0].get_text()


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
    with pytest.raises(UsageError, match="shows risks, violations, not 'trajectory'", check=coded("unknown-name")):
        plot_risk_allocation(problem(), [1.0, 1.0], view="trajectory")


def test_views_are_those_of_a_solution_and_of_the_command_line(tmp_path) -> None:
    assert {"trajectory", "risks", "violations", "history"} == set(views(problem()))
    solution = wb.solve(problem(), heuristic="iterative", bound_time=0)
    assert "any fails with probability" in solution.plot(view="risks").texts[0].get_text()
    assert "samples" in solution.plot(view="violations").get_ylabel()
    save_plot(solution, tmp_path / "risks.svg", "risks")
    assert (tmp_path / "risks.svg").stat().st_size > 1000
