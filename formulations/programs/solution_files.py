"""What solvers write of a program that they were given as a file: values of variables by name.

Read are the files of HiGHS (all its styles), SCIP, CBC, GLPK (raw and printed), and Gurobi (``name value``, which others write too), and
MathOpt's results as text or JSON. Zeros may be left out. Names are those of the exports; positions (``x3``, ``c3``, ``X0000003``), which
solvers make up where a model has none, are taken where every name is one.
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
from .names import block_names, column_names, in_block, own_names
from .program import Floats, Program

_POSITION = re.compile(r"(?:x|c|col|var)_?0*([0-9]+)\Z", re.IGNORECASE)
MADE_UP = frozenset({"objoffset", "objconstant", "constant", "const"})
"""Variables that readers add for the constant of an objective."""

SAME = 1e-5
"""Relative difference up to which a stated objective is that of the values beside it: files hold some ten digits."""

_NONE = re.compile(r"infeasible|unbounded|undefined|empty|no (?:integer )?solution", re.IGNORECASE)


@dataclass
class SolverFile:
    """The contents of a solver's solution file.

    Parameters
    ----------
    solver : str
    values : dict
        By name.
    stated : float, optional
        The objective that it states.
    columns : int, optional
        How many variables the model had, where it says so.
    numbered : bool
        Whether names are numbers of columns, ``x0`` for the first one.
    """

    solver: str
    values: dict[str, float] = field(default_factory=dict)
    stated: float | None = None
    columns: int | None = None
    numbered: bool = False


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
    """Of style 0, and of style 4, which has a negative number of columns and then name, value and number of those that are not 0."""
    made, count = SolverFile("HiGHS"), 0
    inside = False
    for line, row in lines_of(text):
        words = row.split()
        if row.startswith("# Columns") and not inside:
            inside, count = True, int(words[2])
        elif row.startswith("#") and inside:
            break
        elif inside:
            if len(words) != (2 if count > 0 else 3):
                raise InputError("line is not understood", line=line, expected="a name and a value", found=shown(row))
            _put(made, words[0], words[1], line)
        elif words[0] == "Objective" and len(words) == 2:
            made.stated = _value(words[1], line, "Objective")
        elif row in ("None", "Infeasible"):
            raise InputError("holds no solution", line=line, found=shown(row))
    if not inside:
        raise InputError("holds no solution", expected="# Columns")
    if len(made.values) != abs(count):
        raise InputError("is cut off", expected=f"{abs(count)} variables", found=str(len(made.values)))
    made.columns = count if count > 0 else None
    return made


def _highs_old(text: str) -> SolverFile:
    """Of style -1: values alone, in the order of the columns."""
    rows = lines_of(text)
    n = int(rows[0][1].split()[0])
    at = next((k for k, (_, row) in enumerate(rows) if row == "Columns"), None)
    if at is None or (rows[1][1].split() or [""])[0] != "T":
        raise InputError("holds no solution", line=rows[min(1, len(rows) - 1)][0])
    made = SolverFile("HiGHS", columns=n, numbered=True)
    for k, (line, row) in enumerate(rows[at + 1 : at + 1 + n]):
        _put(made, f"x{k}", row, line)
    if len(made.values) != n:
        raise InputError("is cut off", expected=f"{n} variables", found=str(len(made.values)))
    return made


def _highs_table(text: str) -> SolverFile:
    made, place = SolverFile("HiGHS"), None
    if (found := re.search(r"^Model status:.*$", text, re.MULTILINE)) and _NONE.search(found[0]):
        raise InputError("holds no solution", line=text.count("\n", 0, found.start()) + 1, found=shown(found[0]))
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
    made, last = SolverFile("CBC"), -1
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
        if int(words[0]) <= last:
            made.values.clear()  # what came before were the rows, which it prints where it is asked for all
        last = int(words[0])
        _put(made, words[1], words[2], line)
    return made


def _glpk(text: str) -> SolverFile:
    """GLPK's raw text: ``s`` what it is, ``j`` a column by number."""
    made, places = SolverFile("GLPK", numbered=True), {"mip": 2, "ipt": 2, "bas": 3}
    place, ended = 2, False
    for line, row in lines_of(text):
        words = row.split()
        if words[0] == "s":
            if len(words) < 6 or words[1] not in places or not words[3].isdigit():
                raise InputError(
                    "line is not understood", line=line, expected="s, kind, rows, columns, status, objective", found=shown(row)
                )
            if not set(words[4:-1]) <= {"o", "f"}:
                raise InputError("holds no solution", line=line, found=shown(row))
            place, made.columns, made.stated = places[words[1]], int(words[3]), _value(words[-1], line, "objective")
        elif words[0] == "j" and len(words) > place and words[1].isdigit():
            _put(made, f"x{int(words[1]) - 1}", words[place], line)
        elif words == ["e", "o", "f"]:
            ended = True
        elif words[0] not in ("c", "i"):
            raise InputError("line is not understood", line=line, expected="c, s, i, j or e", found=shown(row))
    if not ended:
        raise InputError("is cut off", expected="e o f")
    return made


def _glpk_printed(text: str) -> SolverFile:
    """What GLPK prints of a solution: a table of rows and one of columns, in which long names have a line of their own."""
    made, inside, name = SolverFile("GLPK"), False, ""
    for line, row in lines_of(text):
        words = row.split()
        if words[0] == "Status:" and _NONE.search(row):
            raise InputError("holds no solution", line=line, found=shown(row))
        if words[0] == "Objective:" and "=" in words:
            made.stated = _value(words[words.index("=") + 1], line, "objective")
        elif words[0] == "Columns:" and words[1].isdigit():
            made.columns = int(words[1])
        elif words[0] == "No.":
            inside = "Column" in words
        elif inside and not row.startswith("-"):
            if not name and words[0].isdigit() and len(words) > 1:
                name, words = words[1], words[2:]
            elif not name:
                break
            words = [word for word in words if word not in ("*", "B", "NL", "NU", "NF", "NS")]
            if words:
                _put(made, name, words[0], line)
                name = ""
    if made.columns is None or len(made.values) != made.columns:
        raise InputError("is cut off", expected=f"{made.columns} variables", found=str(len(made.values)))
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
    return SolverFile("MathOpt", {f"x{k}": float(v) for k, v in numbers}, float(held[0].objective_value), numbered=True)


def _starts(pattern: str) -> Callable[[str], bool]:
    return partial(_has, re.compile(pattern, re.IGNORECASE))


def _has(pattern: re.Pattern[str], text: str) -> bool:
    return pattern.match(text.lstrip()[:400]) is not None


READERS: tuple[tuple[Callable[[str], bool], Callable[[str], SolverFile]], ...] = (
    (_starts(r"Model status\s*\n"), _highs),
    (_starts(r"\d+ \d+ : Number of columns and rows"), _highs_old),
    (_starts(r"c Problem:|c Rows:|s (?:mip|bas|ipt) "), _glpk),
    (_starts(r"Problem:.*\n\s*Rows:"), _glpk_printed),
    (_starts(r"Columns\s*\n\s*Index\s+Status"), _highs_table),
    (_starts(r"(?:solution status:|objective value:|no solution available)"), _scip),
    (_starts(r"[A-Za-z][A-Za-z (),-]*- objective value"), _cbc),
    (_starts(r"(?:termination|solutions|solve_stats)\s*\{|\{\s*\"(?:termination|solutions|solveStats)\""), _mathopt),
    (_starts(r"(?:#[^\n]*\n\s*)*#\s*(?:Solution for model|Objective value)"), _plain),
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
    n, given = program.num_variables, {name: v for name, v in read.values.items() if name.casefold() not in MADE_UP}
    columns = {name: k for k, name in enumerate(column_names(program))}
    if not read.numbered:
        if all(name in columns for name in given):
            return {columns[name]: value for name, value in given.items()}
        own = {name: k for k, name in enumerate(own_names(program.variables))}
        if all(name in own for name in given):
            return {own[name]: value for name, value in given.items()}
        blocks = zip(block_names(program), program.variables, strict=True)
        places = {name: k for k, name in enumerate(in_block(name, k) for name, block in blocks for k in range(block.size))}
        if given.keys() == places.keys():
            return {places[name]: value for name, value in given.items()}
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
