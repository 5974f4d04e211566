import pytest

from tests.program_text import expected, program_text
from tests.programs import program
from waybound.formulations.programs.reductions.continuous_relaxation import CONTINUOUS_RELAXATION
from waybound.formulations.programs.reductions.reduction import Irreducible


def test_integrality_is_dropped_and_bounds_stay() -> None:
    (step,) = CONTINUOUS_RELAXATION.apply(program([1, 1], [[1, 2]], 3, 8, 0, 5, integer=[0, 1]))
    assert program_text(step.program) == expected("""
        min x0 + x1
        row: 3 <= x0 + 2 x1 <= 8
        0 <= x0, x1 <= 5
    """)
    assert str(step.link) == "continuous-relaxation (relaxation): integrality of 2 variables dropped"


def test_products_have_no_continuous_relaxation() -> None:
    with pytest.raises(Irreducible, match="not linear"):
        CONTINUOUS_RELAXATION.apply(program([1, 1], [[1, 2]], 3, 8, 0, 5, integer=[0, 1], quadratic=[[0, 1], [1, 0]]))
