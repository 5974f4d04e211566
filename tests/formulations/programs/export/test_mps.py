import math
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from exported import PROGRAMS, arrays_of, read_back, rows_of, variables

from waybound.formulations.programs.export.mps import mps_text
from waybound.formulations.programs.program import Program


@pytest.mark.parametrize("name", PROGRAMS)
def test_mps_read_back_by_highs_holds_the_same_arrays_to_the_last_bit(name: str, tmp_path: Path) -> None:
    program, path = PROGRAMS[name], tmp_path / "model.mps"
    program.write(path)
    back = arrays_of(read_back(path))
    kept = np.isfinite(program.row_lower) | np.isfinite(program.row_upper)
    for key in ("cost", "lower", "upper", "integer", "offset", "sense"):
        assert np.array_equal(back[key], getattr(program, key)), key
    assert np.array_equal(back["matrix"], program.matrix.toarray()[kept])
    assert np.array_equal(back["row_lower"], program.row_lower[kept])
    assert np.array_equal(back["row_upper"], program.row_upper[kept])


def test_every_sort_of_row_bound_and_term_has_its_card() -> None:
    """A range has a width; a row without sides is N; the constant is minus the objective's right side; integers keep their bounds."""
    x = variables("x", [-math.inf, 2.5, -math.inf], [math.inf, 2.5, 4.0], [1.0, 0.0, -0.5])
    k = variables("k", [0.0, -5.0], [1.0, math.inf], [3.0, 0.0], integer=True)
    rows = (
        rows_of("range", [[1, 0, 0, -2, 0]], [-1.0], [5.5]),
        rows_of("equal", [[0, 1, 0, 1, 0]], [3.0], [3.0]),
        rows_of("open", [[1, 0, 1, 0, 0]], [-math.inf], [math.inf]),
    )
    quadratic = sp.csr_matrix(([2.0, 0.5, 0.5], ([0, 0, 2], [0, 2, 0])), shape=(5, 5))
    assert mps_text(Program("three words here", "max", (x, k), rows, offset=-7.0, quadratic=quadratic)).splitlines() == [
        "NAME three_words_here FREE",
        "OBJSENSE",
        "    MAX",
        "ROWS",
        " N  obj",
        " G  range",
        " E  equal",
        " N  open",
        "COLUMNS",
        "    x(0)  obj  1.0",
        "    x(0)  range  1.0",
        "    x(0)  open  1.0",
        "    x(1)  equal  1.0",
        "    x(2)  obj  -0.5",
        "    x(2)  open  1.0",
        "    MARKER  'MARKER'  'INTORG'",
        "    k(0)  obj  3.0",
        "    k(0)  range  -2.0",
        "    k(0)  equal  1.0",
        "    k(1)  obj  0.0",
        "    MARKER  'MARKER'  'INTEND'",
        "RHS",
        "    RHS  obj  7.0",
        "    RHS  range  -1.0",
        "    RHS  equal  3.0",
        "RANGES",
        "    RNG  range  6.5",
        "BOUNDS",
        " FR BND  x(0)",
        " FX BND  x(1)  2.5",
        " MI BND  x(2)",
        " UP BND  x(2)  4.0",
        " UP BND  k(0)  1.0",
        " LO BND  k(1)  -5.0",
        " PL BND  k(1)",
        "QUADOBJ",
        "    x(0)  x(0)  2.0",
        "    x(0)  x(2)  0.5",
        "ENDATA",
    ]


def test_a_range_is_written_from_the_side_that_comes_back_without_rounding() -> None:
    """1e-20 + (1.0 - 1e-20) is 1.0; 0.2 + (0.9 - 0.2) is not 0.9, so that row is written from above."""
    for low, high, kind, side in ((1e-20, 1.0, "G", 1e-20), (0.2, 0.9, "L", 0.9)):
        x = variables("x", [0.0], [9.0], [1.0])
        lines = mps_text(Program("range", "min", (x,), (rows_of("r", [[1]], [low], [high]),))).splitlines()
        assert f" {kind}  r" in lines and f"    RHS  r  {side!r}" in lines
