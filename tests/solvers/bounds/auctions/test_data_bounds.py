import pytest
from bin_assignments import worked
from explorations import path
from orchard_cases import retrievals
from task_problems import line, parts

import waybound as wb
from waybound.solvers.bounds import BOUNDS


@pytest.mark.parametrize(
    ("name", "problem", "proved", "source"),
    [
        ("average-part", parts([0, 0, 0, 0], weights=[3, 2, 4, 1], edges="none"), 5.0, "mean of what all parts must cost"),
        ("retrievals", retrievals(((0, 2), (1, 1), (0, 4)), (0, 0, 0)), 6.0, "steps of all retrievals, and of each bin"),
        ("shortest-ways", line([0, 0], [9, -2], "mini-max"), 9.0, "shortest ways to all tasks"),
    ],
)
def test_it_proves_an_optimum(name: str, problem: wb.Problem, proved: float, source: str) -> None:
    bound = wb.bound(problem, bound_time=60.0)
    assert bound.bound == pytest.approx(proved, rel=1e-12) and bound.bound_source == source


def test_an_exploration_is_bounded() -> None:
    found = wb.solve(path(4, 3, 5, 1, 2), heuristic="heard-greedy", bound_time=60.0)
    assert found.objective == 1.0 and found.bound_kind == "verified" and found.status == "optimal"


def test_each_is_for_one_family() -> None:
    assert BOUNDS["average-part"].missing(line([0], [1])) == {"task-allocation problems"}
    assert BOUNDS["best-increments"].missing(worked("O")) == {"bin-assignment problems"}
    assert not BOUNDS["best-increments"].missing(path(3, 0, 1)) and not BOUNDS["shortest-ways"].missing(line([0], [1], "mini-ave"))
    assert BOUNDS["shortest-ways"].missing(parts([0, 1])) == {"balanced-partition problems"}
