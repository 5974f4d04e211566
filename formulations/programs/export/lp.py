"""The LP format of CPLEX.

All variables stand in the objective, with a coefficient of 0 where they cost nothing, so that readers number them as the program
does. A row with two different sides is written as two rows (``name`` and ``name_low``), since not every reader takes a double
inequality; a row with none is left out. Integer variables are listed as general, never as binary, which would reset their bounds.

Source: IBM CPLEX File Formats Reference, "LP file format".
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from ..names import file_names
from ._checks import merged_rows

if TYPE_CHECKING:
    from ..program import Program

_WIDTH = 200


def lp_text(program: Program, *, names: bool = True) -> str:
    """The program as text in LP format; see ``write_program``."""
    columns, rows = file_names(program, readable=names)
    lines = ["Maximize" if program.sense == "max" else "Minimize"]
    lines += [*_wrapped(" obj:", _objective(program, columns)), "Subject To", *_rows(program, columns, rows)]
    lines += ["Bounds", *_bounds(program, columns)]
    whole = [name for name, integer in zip(columns, program.integer.tolist(), strict=True) if integer]
    if whole:
        lines += ["General", *_wrapped("", whole)]
    return "\n".join([*lines, "End", ""])


def _term(value: float, name: str) -> str:
    return f"{'-' if value < 0 or (value == 0 and math.copysign(1.0, value) < 0) else '+'} {abs(value)!r} {name}"


def _objective(program: Program, columns: list[str]) -> Iterator[str]:
    for value, name in zip(program.cost.tolist(), columns, strict=True):
        yield _term(value, name)
    if program.offset:
        yield _term(program.offset, "").rstrip()
    if program.quadratic is not None:
        import scipy.sparse as sp

        lower = sp.coo_matrix(sp.tril(program.quadratic))
        yield "+ ["
        for i, j, value in zip(lower.row.tolist(), lower.col.tolist(), lower.data.tolist(), strict=True):
            # x' Q x holds both triangles
            yield _term(value, f"{columns[i]} ^ 2") if i == j else _term(2.0 * value, f"{columns[i]} * {columns[j]}")
        yield "] / 2"


def _rows(program: Program, columns: list[str], rows: list[str]) -> Iterator[str]:
    indptr, indices, data = (part.tolist() for part in merged_rows(program))
    taken = set(rows)
    for r, (name, low, high) in enumerate(zip(rows, program.row_lower.tolist(), program.row_upper.tolist(), strict=True)):
        terms = [_term(data[k], columns[indices[k]]) for k in range(indptr[r], indptr[r + 1])] or [f"0 {columns[0]}"]
        if low == high:
            yield from _wrapped(f" {name}:", [*terms, f"= {low!r}"])
            continue
        if high < math.inf:
            yield from _wrapped(f" {name}:", [*terms, f"<= {high!r}"])
        if low > -math.inf:
            other = name
            if high < math.inf:
                other = f"{name}_low"
                while other in taken:
                    other += "_"
                taken.add(other)
            yield from _wrapped(f" {other}:", [*terms, f">= {low!r}"])


def _bounds(program: Program, columns: list[str]) -> Iterator[str]:
    for name, low, high in zip(columns, program.lower.tolist(), program.upper.tolist(), strict=True):
        if low == high:
            yield f" {name} = {low!r}"
        elif low == -math.inf and high == math.inf:
            yield f" {name} free"
        elif low != 0.0 or high < math.inf:
            yield f" {_side(low)} <= {name}" + (f" <= {high!r}" if high < math.inf else "")


def _side(value: float) -> str:
    return "-inf" if value == -math.inf else repr(value)


def _wrapped(start: str, words: Iterable[str]) -> Iterator[str]:
    """Lines of at most some 200 characters, which every reader takes."""
    line = start
    for word in words:
        if len(line) + len(word) > _WIDTH and line.strip():
            yield line
            line = " "
        line += " " + word
    yield line
