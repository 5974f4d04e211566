"""What solvers write of a program that they were given as a file: values of variables by name.

Read are the files of HiGHS (raw and table), SCIP, CBC, and Gurobi (``name value``, which others write too), and MathOpt's results as
text or JSON. Zeros may be left out. Names are those of the exports; positions (``x3``, ``c3``, ``X0000003``), which solvers make up where a
model has none, are taken where every name is one.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from ...instances.document import parse_json
from ...instances.errors import InputError
from ...instances.suggestions import did_you_mean
from ...instances.text import is_number, lines_of, shown
from .names import column_names
from .program import Floats, Program

_POSITION = re.compile(r"(?:x|c|col|var)_?0*([0-9]+)\Z", re.IGNORECASE)
_MADE_UP = frozenset({"objoffset", "objconstant", "constant", "const"})
"""Variables that readers add for the constant of an objective."""

SAME = 1e-5
"""Relative difference up to which a stated objective is that of the values beside it: files hold some ten digits."""

_NONE = re.compile(r"infeasible|unbounded|no solution", re.IGNORECASE)


@dataclass
class SolverFile:
    """The contents of a solver's solution file.

    Parameters
    ----------
    solver : str
    values : dict
        By name; of MathOpt by number of the column.
    stated : float, optional
        The objective that it states.
    columns : int, optional
        How many variables the model had, where it says so.
    """

    solver: str
    values: dict[str, float] = field(default_factory=dict)
    stated: float | None = None
    columns: int | None = None


def solver_file(text: str) -> SolverFile | None:
    """The contents of a solver's solution file, None where the text is none.

    Raises
    ------
    InputError
        If it is one, and broken or without a solution; with the line.
    """
    for marks, read in READERS:
        if marks(text):
            return read(text)
    return None


# -- by solver -------------------------------------------------------------------------------------------------------------


def _value(token: str, line: int, name: str) -> float:
    if not is_number(token):
        raise InputError(f"value of {shown(name)} must be a finite number", line=line, expected="a number", found=shown(token))
    return float(token)


def _put(made: SolverFile, name: str, token: str, line: int) -> None:
    if name in made.values:
        raise InputError(f"variable {shown(name)} stands twice", line=line)
    made.values[name] = _value(token, line, name)


def _highs(text: str) -> SolverFile:
    made, inside = SolverFile("HiGHS"), False
    for line, row in lines_of(text):
        words = row.split()
        if row.startswith("# Columns") and made.columns is None:
            inside, made.columns = True, int(words[2])
        elif row.startswith("#") and inside:
            break
        elif inside:
            if len(words) != 2:
                raise InputError("line is not understood", line=line, expected="a name and a value", found=shown(row))
            _put(made, words[0], words[1], line)
        elif words[0] == "Objective" and len(words) == 2:
            made.stated = _value(words[1], line, "Objective")
        elif row in ("None", "Infeasible") and made.columns is None:
            raise InputError("holds no solution", line=line, found=shown(row))
    if made.columns is None:
        raise InputError("holds no solution", expected="# Columns")
    if len(made.values) != made.columns:
        raise InputError("is cut off", expected=f"{made.columns} variables", found=str(len(made.values)))
    return made


def _highs_table(text: str) -> SolverFile:
    made, place = SolverFile("HiGHS"), None
    for line, row in lines_of(text):
        words = row.split()
        if row == "Rows":
            break
        if words[:2] == ["Index", "Status"]:
            place = True
        elif place and len(words) >= 5 and words[0].isdigit():
            # Between index and name stand status and dual, of which either may be missing, and the kind: bounds are the first two numbers.
            numbers = [w for w in words[1:-1] if is_number(w) or w in ("inf", "-inf")]
            if len(numbers) < 3:
                raise InputError("line is not understood", line=line, expected="bounds, a value and a name", found=shown(row))
            _put(made, words[-1], numbers[2], line)
    found = re.search(r"^Objective value:\s*(\S+)", text, re.MULTILINE)
    made.stated = float(found[1]) if found and is_number(found[1]) else None
    made.columns = len(made.values)
    return made


def _scip(text: str) -> SolverFile:
    made = SolverFile("SCIP")
    for line, row in lines_of(text):
        words = row.split()
        if row.lower().startswith("objective value:"):
            made.stated = _value(words[-1], line, "objective")
        elif row.lower().startswith(("solution status:", "no solution")):
            if _NONE.search(row):
                raise InputError("holds no solution", line=line, found=shown(row))
        elif len(words) in (2, 3) and (len(words) == 2 or words[2].startswith("(obj:")):
            _put(made, words[0], words[1], line)
        else:
            raise InputError("line is not understood", line=line, expected="a name and a value", found=shown(row))
    return made


def _cbc(text: str) -> SolverFile:
    made = SolverFile("CBC")
    for line, row in lines_of(text):
        words = row.split()
        if "objective value" in row and made.stated is None and not made.values:
            if _NONE.search(row):
                raise InputError("holds no solution", line=line, found=shown(row))
            made.stated = _value(words[-1], line, "objective")
            continue
        words = words[1:] if words[0] == "**" else words  # a value beyond its bounds: the judge sees it
        if len(words) != 4 or not words[0].isdigit():
            raise InputError("line is not understood", line=line, expected="index, name, value, cost", found=shown(row))
        _put(made, words[1], words[2], line)
    return made


def _plain(text: str) -> SolverFile:
    made = SolverFile("the solver")
    for line, row in lines_of(text):
        if row.startswith("#"):
            found = re.search(r"objective value\s*[=:]\s*(\S+)", row, re.IGNORECASE)
            made.stated = float(found[1]) if found and is_number(found[1]) else made.stated
            made.solver = "Gurobi" if "Solution for model" in row else made.solver
            continue
        words = row.split()
        if len(words) != 2:
            raise InputError("line is not understood", line=line, expected="a name and a value", found=shown(row))
        _put(made, words[0], words[1], line)
    return made


def _mathopt(text: str) -> SolverFile:
    from google.protobuf import json_format, text_format
    from ortools.math_opt import result_pb2

    said = result_pb2.SolveResultProto()
    try:
        if text.lstrip().startswith("{"):
            parse_json(text)
            json_format.Parse(text, said, ignore_unknown_fields=True)
        else:
            text_format.Parse(text, said)
    except (json_format.ParseError, text_format.ParseError) as error:
        raise InputError(f"is no result of MathOpt: {' '.join(str(error).split())[:160]}") from None
    return of_mathopt(said)


def of_mathopt(said: object) -> SolverFile:
    """The first solution in a ``SolveResultProto``."""
    held = [s.primal_solution for s in said.solutions if s.HasField("primal_solution")]  # type: ignore[attr-defined]
    if not held:
        raise InputError("the result of MathOpt holds no solution")
    values = held[0].variable_values
    numbers = zip(values.ids, values.values, strict=True)
    return SolverFile("MathOpt", {f"x{k}": float(v) for k, v in numbers}, float(held[0].objective_value))


def _starts(pattern: str) -> Callable[[str], bool]:
    return partial(_has, re.compile(pattern, re.IGNORECASE))


def _has(pattern: re.Pattern[str], text: str) -> bool:
    return pattern.match(text.lstrip()[:400]) is not None


READERS: tuple[tuple[Callable[[str], bool], Callable[[str], SolverFile]], ...] = (
    (_starts(r"Model status\s*\n"), _highs),
    (_starts(r"Columns\s*\n\s*Index\s+Status"), _highs_table),
    (_starts(r"(?:solution status:|objective value:|no solution available)"), _scip),
    (_starts(r"(?:[A-Za-z][A-Za-z ()]*- )objective value"), _cbc),
    (_starts(r"(?:termination|solutions|solve_stats)\s*\{|\{\s*\"(?:termination|solutions|solveStats)\""), _mathopt),
    (_starts(r"#\s*(?:Solution for model|Objective value)"), _plain),
)
"""Whether a text is meant as a file of each solver, and its reader."""


# -- as a vector -----------------------------------------------------------------------------------------------------------


def vector_of(program: Program, read: SolverFile) -> Floats:
    """The vector of shape (variables,) that a solver's file holds.

    Raises
    ------
    InputError
        If the file cannot be one of this program: it names other variables, has another number of them, or states another objective than
        its values have here.
    """
    n = program.num_variables
    if read.columns is not None and read.columns != n:
        raise InputError("has another number of variables", expected=str(n), found=str(read.columns))
    x = np.zeros(n)
    for column, value in _named(program, read).items():
        x[column] = value
    if read.stated is not None and not _agrees(program, x, read.stated):
        here = f"{program.value(x):.10g}"
        raise InputError(
            f"has the objective {here} by its values", expected="the objective that it states", found=f"{read.stated:.10g}",
        )  # fmt: skip
    return x


def _named(program: Program, read: SolverFile) -> Mapping[int, float]:
    """Values by column."""
    n, given = program.num_variables, {name: v for name, v in read.values.items() if name.casefold() not in _MADE_UP}
    columns = {name: k for k, name in enumerate(column_names(program))}
    if read.solver != "MathOpt":
        if all(name in columns for name in given):
            return {columns[name]: value for name, value in given.items()}
        own = {program.variable_name(k): k for k in range(n)}
        if all(name in own for name in given):
            return {own[name]: value for name, value in given.items()}
    places = {name: int(found[1]) for name in given if (found := _POSITION.match(name))}
    if len(places) == len(given) and all(k < n for k in places.values()):
        if len(set(places.values())) < len(places):
            raise InputError("names two variables of one number", found=", ".join(list(given)[:3]))
        return {places[name]: value for name, value in given.items()}
    strange = next(name for name in given if name not in columns)
    hint = did_you_mean(strange, list(columns)[:2000])
    raise InputError(f"names a variable that does not exist{hint}", expected=", ".join(list(columns)[:3]) + ", ...",
                     found=shown(strange))  # fmt: skip


def _agrees(program: Program, x: Floats, stated: float) -> bool:
    """Whether a stated objective is that of the values; solvers drop its constant, or turn its sign to minimise."""
    value, terms = program.value(x), np.abs(program.cost * x)
    size = max(abs(value), abs(stated), float(terms.max(initial=0.0)), 1e-300)
    meant = (stated, stated + program.offset, -stated, -stated + program.offset)
    return any(math.isfinite(m) and abs(m - value) <= SAME * size for m in meant)


def is_solver_json(data: object) -> bool:
    """Whether a parsed document is a result of MathOpt."""
    return isinstance(data, dict) and "solutions" in data and "termination" in data


def solver_json(data: object) -> SolverFile:
    """Its contents."""
    return _mathopt(json.dumps(data))
