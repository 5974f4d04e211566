from __future__ import annotations

import pytest

from tests.programs import INF, program
from waybound.formulations.programs.reductions.finite_numbers import FiniteNumbers
from waybound.formulations.programs.reductions.reduction import Irreducible


def test_numbers_taken_for_infinite_are_refused_and_infinity_is_not() -> None:
    assert FiniteNumbers(1e20).apply(program([1], [[1]], -INF, 9e19)) == ()
    with pytest.raises(Irreducible, match="numbers of 1e\\+20 and more"):
        FiniteNumbers(1e20).apply(program([1], [[1]], -INF, 1e20))
