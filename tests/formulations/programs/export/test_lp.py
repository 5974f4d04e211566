import math
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from exported import PROGRAMS, arrays_of, read_back, rows_of, variables

from waybound.formulations.programs.export.lp import lp_text
from waybound.formulations.programs.program import Program


@pytest.mark.parametrize("name", PROGRAMS)
def test_lp_read_back_by_highs_holds_the_same_variables_and_rows(name: str, tmp_path: Path) -> None:
    program, path = PROGRAMS[name], tmp_path / "model.lp"
    program.write(path)
    back = arrays_of(read_back(path))
    for key in ("cost", "lower", "upper", "integer", "offset", "sense"):
        assert np.array_equal(back[key], getattr(program, key)), key
    expected = []  # a range is two rows, a free row none
    for row, low, high in zip(program.matrix.toarray(), program.row_lower, program.row_upper, strict=True):
        if low == high:
            expected.append((row.tolist(), low, high))
        else:
            expected.extend((row.tolist(), a, b) for a, b in ((-math.inf, high), (low, math.inf)) if math.isfinite(a) or math.isfinite(b))
    assert list(zip(back["matrix"].tolist(), back["row_lower"], back["row_upper"], strict=True)) == expected


def test_every_sort_of_row_bound_and_term_has_its_words() -> None:
    """A range is two rows, a row without sides none; a binary is a general variable with its bounds; a product stands in brackets."""
    x = variables("x", [-math.inf, 2.5, -math.inf], [math.inf, 2.5, 4.0], [1.0, 0.0, -0.5])
    k = variables("k", [0.0], [1.0], [3.0], integer=True)
    rows = (
        rows_of("range", [[1, 0, 0, -2]], [-1.0], [5.5]),
        rows_of("equal", [[0, 1, 0, 1]], [3.0], [3.0]),
        rows_of("free", [[1, 1, 1, 1]], [-math.inf], [math.inf]),
        rows_of("none", [[0, 0, 0, 0]], [-math.inf], [0.0]),
    )
    quadratic = sp.csr_matrix(np.array([[2.0, 0, 0.5, 0], [0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0, 0, 0]]))
    assert lp_text(Program("words", "min", (x, k), rows, offset=-7.0, quadratic=quadratic)) == (
        "Minimize\n"
        " obj: + 1.0 x(0) + 0.0 x(1) - 0.5 x(2) + 3.0 k - 7.0 + [ + 2.0 x(0) ^ 2 + 1.0 x(2) * x(0) ] / 2\n"
        "Subject To\n"
        " range: + 1.0 x(0) - 2.0 k <= 5.5\n"
        " range_low: + 1.0 x(0) - 2.0 k >= -1.0\n"
        " equal: + 1.0 x(1) + 1.0 k = 3.0\n"
        " none: 0 x(0) <= 0.0\n"
        "Bounds\n"
        " x(0) free\n"
        " x(1) = 2.5\n"
        " -inf <= x(2) <= 4.0\n"
        " 0.0 <= k <= 1.0\n"
        "General\n"
        " k\n"
        "End\n"
    )


def test_the_second_row_of_a_range_takes_a_name_that_is_free() -> None:
    x = variables("x", [0.0], [9.0], [1.0])
    rows = (rows_of("load", [[1]], [1.0], [2.0]), rows_of("load_low", [[1]], [0.0], [math.inf]))
    text = lp_text(Program("names", "max", (x,), rows))
    assert text.splitlines()[3:6] == [" load: + 1.0 x <= 2.0", " load_low_: + 1.0 x >= 1.0", " load_low: + 1.0 x >= 0.0"]


def test_long_rows_are_wrapped_between_terms() -> None:
    n = 400
    x = variables("x", np.zeros(n), np.ones(n), np.ones(n))
    lines = lp_text(Program("long", "min", (x,), (rows_of("all", np.ones(n), [1.0], [math.inf]),)), names=False).splitlines()
    assert max(map(len, lines)) <= 220
    assert sum(line.count("+ 1.0 x") for line in lines) == 2 * n
