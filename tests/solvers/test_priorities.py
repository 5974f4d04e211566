"""Levels of priority are searched one after the other, and what was reached stays, at any scale and wherever a search ends."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from programs import program

from waybound.formulations.programs.program import FurtherLevel, Program
from waybound.instances.errors import UnsupportedError
from waybound.solvers.backend import Control, LevelClaim, Options, RawResult
from waybound.solvers.backends.highs import Highs
from waybound.solvers.priorities import Held, by_priority


def levels(scale: float = 1.0, *, whole: bool = True) -> Program:
    """At most three of four things: first the most worth, then the least weight, then the last one if it may be."""
    made = program(
        [scale * 3, scale * 2, scale * 2, scale * 2], [[1, 1, 1, 1]], -np.inf, 3, 0, 1, integer=range(4) if whole else [], sense="max"
    )
    weight, last = np.array([1.0, 4.0, 2.0, 2.0]) * scale, np.array([0.0, 0.0, 0.0, 1.0])
    return replace(made, further=(FurtherLevel("min", weight, 5.0), FurtherLevel("max", last)))


@pytest.mark.parametrize("scale", [1.0, 0.1, 2.0**-30, 1e9])
@pytest.mark.parametrize("whole", [True, False])
def test_each_level_decides_among_the_optima_of_those_before_in_any_unit(scale: float, whole: bool) -> None:
    found = Highs().run(levels(scale, whole=whole), Options(time_limit=60.0), Control())
    assert found.status == "optimal"
    assert found.answer == pytest.approx([1, 0, 1, 1], abs=1e-5)
    assert (found.objective, found.bound) == pytest.approx((7 * scale, 7 * scale))
    assert [level.objective for level in found.further] == pytest.approx([5 * scale + 5.0, 1.0], abs=1e-5)
    assert [level.bound for level in found.further] == pytest.approx([5 * scale + 5.0, 1.0], abs=1e-5)


def test_a_level_of_whole_steps_is_held_exactly_and_any_other_as_closely_as_solvers_see() -> None:
    def held(costs: list[float], x: list[float], integer: Any) -> float:
        made = program(costs, [[1] * len(costs)], -np.inf, 9, 0, 9, integer=integer)
        return float(Held().add(made, np.array(x), FurtherLevel("min", np.ones(len(costs)))).row_upper[-1])

    assert held([0.1, 0.2], [1.0 - 1e-7, 1.0], [0, 1]) == 0.3
    assert held([3.0, 5.0], [2.0, 1.0], []) == 11.0
    assert held([np.pi, np.e], [1.0, 1.0], [0, 1]) == pytest.approx(np.pi + np.e, rel=2e-9)
    assert held([1.0, -1.0], [8.5, 8.25], []) == pytest.approx(0.25 + 16.75e-6)


def test_an_answer_that_is_worse_by_less_than_a_millionth_does_not_take_the_place_of_the_best() -> None:
    """A makespan of 100.10005 with a cost of 1, and one of 100.1 with a cost of 2."""
    made = program([0.0, 0.0, 1.0], [[1, 1, 0], [100.10005, 100.1, -1]], [1, -np.inf], [1, 0], 0, [1, 1, 900], integer=[0, 1])
    found = Highs().run(replace(made, further=(FurtherLevel("min", np.array([1.0, 2.0, 0.0])),)), Options(time_limit=60.0), Control())
    assert found.status == "optimal"
    assert found.answer[:2] == pytest.approx([0, 1], abs=1e-6)
    assert found.further[0].objective == pytest.approx(2.0)


def test_a_level_is_held_as_closely_as_solvers_see_where_nothing_lies_closer() -> None:
    first, second = RawResult("optimal", "none", np.array([0.5, 0.5, 0.3]), 1.1, 1.1), RawResult("optimal", "none", X[:3], 7.0, 7.0)
    sides, results, value = [], [first, RawResult("infeasible"), second], (np.pi + np.e) / 2 + 0.3

    def run(made: Program, options: Options, control: Control) -> RawResult:
        sides.append(made.row_upper[-1])
        return results.pop(0)

    made = replace(program([np.pi, np.e, 1.0], [[1, 1, 1]], 1, 3, 0, 1), further=(FurtherLevel("min", np.ones(3)),))
    assert by_priority("it", run, made, Options(), Control()).status == "feasible"  # the second is worse at the first level
    assert sides[1:] == pytest.approx([value * (1 + 1e-9), value * (1 + 1e-6)], rel=1e-12)


def told(*results: RawResult) -> Any:
    """A solver that says these things, one after the other."""
    said = iter(results)
    return lambda program, options, control: next(said)


X, Y = np.array([1.0, 1.0, 1.0, 0.0]), np.array([1.0, 0.0, 1.0, 1.0])


@pytest.mark.parametrize(
    ("second", "status", "limit"),
    [
        (RawResult("unknown", "time"), "feasible", "time"),
        (RawResult("unknown", "interrupt", bound=9.0), "feasible", "interrupt"),
        (RawResult("infeasible"), "feasible", "none"),
        (RawResult("feasible", "gap", np.array([0.0, 0.0, 1.0, 1.0]), 9.0, 9.0), "feasible", "gap"),
    ],
)
def test_what_was_reached_stays_whatever_becomes_of_a_later_level(second: RawResult, status: str, limit: str) -> None:
    first = RawResult("optimal", "none", X, 7.0, 7.0)
    found = by_priority("it", told(first, second, second), levels(), Options(), Control())
    assert (found.status, found.limit, found.objective, found.bound) == (status, limit, 7.0, 7.0)
    assert found.answer is X
    assert found.further[0] == LevelClaim(12.0, second.bound)
    assert ("it says infeasible" in found.message) == (second.status == "infeasible")


def test_no_later_level_is_begun_without_an_answer_or_after_the_end() -> None:
    for first, limit in ((RawResult("infeasible"), "none"), (RawResult("feasible", "time", X, 7.0, 8.0), "time")):
        found = by_priority("it", told(first), levels(), Options(), Control())
        assert (found.status, found.limit, found.further) == (first.status, limit, ())
    stopped = Control()
    stopped.stop()
    found = by_priority("it", told(RawResult("optimal", "none", X, 7.0, 7.0)), levels(), Options(), stopped)
    assert (found.status, found.limit, found.bound) == ("feasible", "interrupt", 7.0)


def test_incumbents_of_later_levels_are_published_where_they_keep_the_first() -> None:
    heard: list[Any] = []

    def run(made: Program, options: Options, control: Control) -> RawResult:
        if made.sense == "min":
            assert options.start is X
            for point in (Y, np.array([0.0, 0.0, 1.0, 1.0])):
                control.publish(point, made.value(point), 1.0)
            heard.append(outer.answer)
        return RawResult("optimal", "none", X if made.sense == "max" else Y, 7.0, 7.0)

    outer = Control()
    by_priority("it", run, levels(), Options(), outer)
    assert heard[0] is Y
    assert outer.objective == 7.0


def test_nothing_follows_a_quadratic_objective() -> None:
    with pytest.raises(UnsupportedError, match="levels of priority after a quadratic objective"):
        Highs().run(replace(levels(), quadratic=sp.identity(4, format="csr")), Options(), Control())
