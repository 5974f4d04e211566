from __future__ import annotations

from tests.programs import INF, program
from waybound.formulations.programs.reductions.whole_bounds import WHOLE_BOUNDS


def test_whole_and_infinite_bounds_are_left_alone_and_so_are_those_of_continuous_variables() -> None:
    assert WHOLE_BOUNDS.apply(program([1, 1, 1], [[1, 1, 1]], 1, 2, [0, -INF, 0.5], [1, INF, 0.7], integer=[0, 1])) == ()


def test_bounds_of_integer_variables_are_rounded_inwards_but_for_the_rounding_of_floats() -> None:
    given = program([1] * 4, [[1] * 4], 1, 2, [0.3, -1.5, 1.0 + 1e-12, 0.2], [1.5, INF, 3.0 - 1e-12, 0.8], integer=range(4))
    (step,) = WHOLE_BOUNDS.apply(given)
    assert step.program.lower.tolist() == [1, -1, 1, 1]
    assert step.program.upper.tolist() == [1, INF, 3, 0]
    assert str(step.link) == "whole-bounds (exact): bounds of 4 integer variables rounded"
