"""HiGHS models: the arrays as they are, and refusals by name."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.sparse as sp
from exported import PROGRAMS, arrays_of, everything, reference, rows_of, variables

from waybound.formulations.programs.program import Program
from waybound.instances.errors import InputError


@pytest.mark.parametrize("name", PROGRAMS)
def test_highs_holds_every_array_of_the_program(name: str) -> None:
    program = PROGRAMS[name]
    held = arrays_of(program.to_highs())
    for key in ("cost", "lower", "upper", "row_lower", "row_upper", "integer", "offset", "sense"):
        assert np.array_equal(held[key], getattr(program, key)), key
    assert np.array_equal(held["matrix"], program.matrix.toarray())


def test_both_senses_of_a_program_have_opposite_optima() -> None:
    assert reference(everything("max")) == pytest.approx(-reference(everything("min")), abs=1e-9)
    assert reference(everything("max", quadratic=True)) == pytest.approx(-reference(everything("min", quadratic=True)), abs=1e-5)


def test_one_triangle_of_the_products_is_handed_over() -> None:
    program = everything("min", quadratic=True)
    hessian = program.to_highs().getModel().hessian_
    n = program.num_variables
    held = sp.csc_matrix((hessian.value_, hessian.index_, hessian.start_), shape=(n, n)).toarray()
    assert program.quadratic is not None
    assert np.array_equal(held, np.tril(program.quadratic.toarray()))


def test_what_highs_itself_refuses_is_told_with_the_size_of_the_program() -> None:
    """A coefficient beyond 1e15 is an error to HiGHS."""
    row = rows_of("huge", [[1e200]], [0.0], [math.inf])
    with pytest.raises(InputError, match="HiGHS refuses the program huge: 1 variables, 1 rows"):
        Program("huge", "min", (variables("x", [0.0], [1.0], [1.0]),), (row,)).to_highs()
