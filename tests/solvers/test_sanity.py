from __future__ import annotations

import math

import numpy as np
import pytest

from waybound.formulations.programs.program import Program, Rows, Variables
from waybound.instances.errors import InputError
from waybound.solvers.sanity import prepared, settled


def program(indices=(0, 1), data=(1.0, 1.0), lower=(0.0, 0.0), upper=(1.0, 1.0), side=(1.0, math.inf)) -> Program:
    x = Variables("x", keys=(np.arange(2),), lower=np.array(lower), upper=np.array(upper), cost=np.ones(2))
    rows = Rows(
        "need", indptr=np.array([0, len(indices)], dtype=np.int32), indices=np.array(indices, dtype=np.int32), data=np.array(data),
        lower=np.array(side[:1]), upper=np.array(side[1:]),
    )  # fmt: skip
    return Program("sane", "min", (x,), (rows,))


def test_a_sound_program_is_handed_on_as_it_is() -> None:
    given = program()
    assert prepared(given) is given


def test_duplicate_entries_are_added_up_without_touching_the_original() -> None:
    given = program(indices=(0, 1, 0), data=(1.0, 5.0, 2.0))
    made = prepared(given)
    assert made.matrix.toarray().tolist() == [[3.0, 5.0]]
    assert len(made.data) == 2
    assert len(given.data) == 3


@pytest.mark.parametrize(
    ("parts", "word"),
    [
        ({"lower": (0.0, math.inf), "upper": (1.0, math.inf)}, r"lower bound of x\[1\]"),
        ({"upper": (-math.inf, 1.0)}, r"upper bound of x\[0\]"),
        ({"side": (math.inf, math.inf)}, "left side of row need"), ({"side": (-math.inf, -math.inf)}, "right side of row need"),
        ({"data": (1.0, math.nan)}, "coefficient"), ({"indices": (0, 2)}, "column that does not exist"),
    ],
)  # fmt: skip
def test_numbers_that_mean_nothing_are_refused_by_name(parts, word: str) -> None:
    with pytest.raises(InputError, match=word):
        prepared(program(**parts))


def test_crossed_bounds_settle_a_program_by_name() -> None:
    result = settled(program(lower=(0.0, 2.0)))
    assert result is not None
    assert result.status == "infeasible"
    assert "x[1]" in result.message


def test_crossed_sides_settle_a_program_by_name() -> None:
    result = settled(program(side=(3.0, 2.0)))
    assert result is not None
    assert (result.status, "need" in result.message) == ("infeasible", True)


def test_every_other_program_is_left_to_the_solver() -> None:
    assert settled(program()) is None


@pytest.mark.parametrize("side", [(1e-9, math.inf), (-math.inf, -1e-9)])
def test_an_empty_row_that_excludes_zero_settles_a_program_by_name_however_small_its_side(side) -> None:
    result = settled(program(data=(0.0, 0.0), side=side))
    assert result is not None
    assert (result.status, "need" in result.message) == ("infeasible", True)
    assert settled(program(data=(0.0, 0.0), side=(-1e-9, 1e-9))) is None
