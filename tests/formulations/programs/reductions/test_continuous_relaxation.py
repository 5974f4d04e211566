from __future__ import annotations

import pytest

from tests.programs import program
from waybound.formulations.programs.export.lp import lp_text
from waybound.formulations.programs.reductions.continuous_relaxation import CONTINUOUS_RELAXATION
from waybound.formulations.programs.reductions.reduction import Irreducible


def test_integrality_is_dropped_and_bounds_stay() -> None:
    (step,) = CONTINUOUS_RELAXATION.apply(program([1, 1], [[1, 2]], 3, 8, 0, 5, integer=[0, 1]))
    assert (
        lp_text(step.program)
        == """\
Minimize
 obj: + 1.0 x0 + 1.0 x1
Subject To
 row: + 1.0 x0 + 2.0 x1 <= 8.0
 row_low: + 1.0 x0 + 2.0 x1 >= 3.0
Bounds
 0.0 <= x0 <= 5.0
 0.0 <= x1 <= 5.0
End
"""
    )
    assert str(step.link) == "continuous-relaxation (relaxation): integrality of 2 variables dropped"


def test_products_have_no_continuous_relaxation() -> None:
    with pytest.raises(Irreducible, match="not linear"):
        CONTINUOUS_RELAXATION.apply(program([1, 1], [[1, 2]], 3, 8, 0, 5, integer=[0, 1], quadratic=[[0, 1], [1, 0]]))
