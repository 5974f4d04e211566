from __future__ import annotations

import pytest

from tests.programs import program
from waybound.formulations.programs.reductions.reduction import Irreducible
from waybound.formulations.programs.reductions.separable_objective import SEPARABLE_OBJECTIVE


def test_squares_pass_and_products_are_refused() -> None:
    assert SEPARABLE_OBJECTIVE.apply(program([1, 1], [[1, 1]], 1, 2)) == ()
    assert SEPARABLE_OBJECTIVE.apply(program([1, 1], [[1, 1]], 1, 2, quadratic=[[2, 0], [0, 1]])) == ()
    with pytest.raises(Irreducible, match="products of two variables"):
        SEPARABLE_OBJECTIVE.apply(program([1, 1], [[1, 1]], 1, 2, quadratic=[[2, -1], [-1, 1]]))
