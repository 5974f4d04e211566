"""The free MPS format.

Numbers are written with all digits that tell them apart. Rows without sides are ``N`` rows after the objective, which readers
may drop. Integer variables carry their bounds always, since readers disagree about their default. The constant of the objective is
minus its right side. ``OBJSENSE`` and ``QUADOBJ`` (one triangle of the matrix in c x + x' Q x / 2) are extensions of CPLEX that HiGHS,
Gurobi and SCIP read.

Source: IBM CPLEX File Formats Reference, "MPS file format"; lp_solve reference guide, "free MPS".
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ..names import file_names

if TYPE_CHECKING:
    from ..program import Program

OBJECTIVE = "obj"


def mps_text(program: Program, *, names: bool = True) -> str:
    """The program as text in free MPS format; see ``write_program``."""
    columns, rows = file_names(program, readable=names)
    title = program.name.replace(" ", "_") or "program"
    lines = [f"NAME {title} FREE"]  # without the word CBC takes short lines for the fixed format
    if program.sense == "max":
        lines += ["OBJSENSE", "    MAX"]
    kinds, sides, ranges = _sides(program)
    lines += ["ROWS", f" N  {OBJECTIVE}"]
    lines += [f" {kind}  {row}" for kind, row in zip(kinds, rows, strict=True)]
    lines += ["COLUMNS", *_columns(program, columns, rows), "RHS"]
    if program.offset:
        lines.append(f"    RHS  {OBJECTIVE}  {-program.offset!r}")
    lines += [f"    RHS  {row}  {side!r}" for row, side, kind in zip(rows, sides, kinds, strict=True) if side and kind != "N"]
    if any(width is not None for width in ranges):
        lines.append("RANGES")
        lines += [f"    RNG  {row}  {width!r}" for row, width in zip(rows, ranges, strict=True) if width is not None]
    bounds = list(_bounds(program, columns))
    if bounds:
        lines += ["BOUNDS", *bounds]
    if program.quadratic is not None:
        lines += ["QUADOBJ", *_quadratic(program, columns)]
    return "\n".join([*lines, "ENDATA", ""])


def _sides(program: Program) -> tuple[list[str], list[float], list[float | None]]:
    """Type, right side and range of each row."""
    kinds, sides, ranges = [], [], []
    for low, high in zip(program.row_lower.tolist(), program.row_upper.tolist(), strict=True):
        width = None
        if low == high:
            kind, side = "E", low
        elif low == -math.inf:
            kind, side = ("L", high) if high < math.inf else ("N", 0.0)
        elif high == math.inf:
            kind, side = "G", low
        else:  # the type whose other side is computed back without a rounding, if there is one
            width = high - low
            kind, side = ("G", low) if low + width == high else ("L", high)
        kinds.append(kind)
        sides.append(side)
        ranges.append(width)
    return kinds, sides, ranges


def _columns(program: Program, columns: list[str], rows: list[str]) -> Iterator[str]:
    import scipy.sparse as sp

    matrix = sp.csc_matrix(program.matrix)
    matrix.sum_duplicates()
    start, index, value = matrix.indptr.tolist(), matrix.indices.tolist(), matrix.data.tolist()
    inside = False
    for j, (name, cost, whole) in enumerate(zip(columns, program.cost.tolist(), program.integer.tolist(), strict=True)):
        if whole != inside:
            inside = whole
            yield f"    MARKER  'MARKER'  '{'INTORG' if whole else 'INTEND'}'"
        if cost or start[j] == start[j + 1]:  # a column that stands nowhere still has to be named
            yield f"    {name}  {OBJECTIVE}  {cost!r}"
        for k in range(start[j], start[j + 1]):
            yield f"    {name}  {rows[index[k]]}  {value[k]!r}"
    if inside:
        yield "    MARKER  'MARKER'  'INTEND'"


def _bounds(program: Program, columns: list[str]) -> Iterator[str]:
    triples = zip(columns, program.lower.tolist(), program.upper.tolist(), program.integer.tolist(), strict=True)
    for name, low, high, whole in triples:
        if low == high:
            yield f" FX BND  {name}  {low!r}"
        elif low == -math.inf and high == math.inf:
            yield f" FR BND  {name}"
        else:
            if low == -math.inf:
                yield f" MI BND  {name}"
            elif low != 0.0 or high <= 0.0:
                yield f" LO BND  {name}  {low!r}"
            if high < math.inf:
                yield f" UP BND  {name}  {high!r}"
            elif whole:
                yield f" PL BND  {name}"


def _quadratic(program: Program, columns: list[str]) -> Iterator[str]:
    import scipy.sparse as sp

    assert program.quadratic is not None
    lower = sp.coo_matrix(sp.tril(program.quadratic))
    order = np.lexsort((lower.row, lower.col))
    for i, j, value in zip(lower.row[order].tolist(), lower.col[order].tolist(), lower.data[order].tolist(), strict=True):
        yield f"    {columns[j]}  {columns[i]}  {value!r}"
