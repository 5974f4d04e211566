import pytest

import waybound as wb
from waybound.formulations.auctions.joint_assignment import JointAssignment
from waybound.instances.generating import generate
from waybound.reports.plots.auctions.joint_assignment import legs, plot_joint_assignment


def small() -> JointAssignment:
    return JointAssignment.from_arrays([[4.0, 1.0], [2.0, 3.0]], [[1.0], [9.0]], [[2.0, 6.0]], [5.0, 0.0])


def test_bars_are_the_way_to_the_request_to_the_bin_and_the_wait() -> None:
    problem = small()
    assert legs(problem, 0, (0, 0)) == (1.0, 3.0, 5.0) and legs(problem, 1, (1, -1)) == (0.0, 3.0, 3.0)
    ax = plot_joint_assignment(problem, ((0, 0), (1, -1)))
    bars = [(bar.get_x(), bar.get_width()) for bar in ax.patches]
    assert bars == [(0.0, 1.0), (1.0, 2.0), (3.0, 2.0), (0.0, 0.0), (0.0, 3.0), (3.0, 0.0)]
    assert [text.get_text() for text in ax.texts[:2]] == ["request 1, bin 1", "bin 2"]


def test_bars_end_at_the_costs_that_are_judged() -> None:
    problem = JointAssignment(generate("joint-assignment", 2))
    solution = wb.solve(problem, "highs", time_limit=20, bound_time=0)
    ends = [legs(problem, robot, errand)[-1] for robot, errand in enumerate(solution.answer)]
    assert sum(ends) == pytest.approx(solution.objective)
    assert solution.plot().get_xlabel() == "time from now"


def test_a_robot_without_an_errand_is_told() -> None:
    ax = plot_joint_assignment(small(), ((-1, -1), (1, -1)))
    assert ax.texts[0].get_text() == "no errand"
