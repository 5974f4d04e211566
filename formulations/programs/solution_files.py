"""Solution files that solvers write of an exported program: values of variables by name.

Files of HiGHS (all its styles), SCIP, CBC, GLPK (raw and printed), and Gurobi (``name value``, which others write too), and MathOpt's
results as text or JSON are read. Zeros may be left out. Names are those of the exports; positions (``x3``, ``c3``, ``X0000003``), which
solvers make up where a model has none, are taken where every name is one.
"""

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
    """Contents of a solver's solution file: values by name, the objective that it states, and how many variables the model had.

    ``stated`` and ``columns`` are None where the file does not say; ``numbered`` tells that names are numbers of columns, ``x0`` for the
    first one.
    """

    solver: str
    values: dict[str, float] = field(default_factory=dict)
    stated: float | None = None
    columns: int | None = None
    numbered: bool = False


def solver_file(text: str) -> SolverFile | None:
    """Contents of a solver's solution file, None where the text is none; raises InputError, with the line, for a broken one."""
    for marks, read in READERS:
        if marks(text):
            return read(text)
    return None


# -- by solver -------------------------------------------------------------------------------------------------------------


def _value(token: str, line: int, name: str) -> float:
    if not is_number(token):
        raise InputError(f"value of {shown(name)} must be a finite number", line=line, expected="a number", found=shown(token))
    return float(token)


def _put(file: SolverFile, name: str, token: str, line: int) -> None:
    if name in file.values:
        raise InputError(f"variable {shown(name)} stands twice", "duplicate", line=line)
    file.values[name] = _value(token, line, name)


def _highs(text: str) -> SolverFile:
    """Style 0, or style 4, which has a negative number of columns and then name, value and number of those that are not 0."""
    file, count = SolverFile("HiGHS"), 0
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
            _put(file, words[0], words[1], line)
        elif words[0] == "Objective" and len(words) == 2:
            file.stated = _value(words[1], line, "Objective")
        elif row in ("None", "Infeasible"):
            raise InputError("holds no solution", "missing", line=line, found=shown(row))
    if not inside:
        raise InputError("holds no solution", "missing", expected="# Columns")
    if len(file.values) != abs(count):
        raise InputError("is cut off", "missing", expected=f"{abs(count)} variables", found=str(len(file.values)))
    file.columns = count if count > 0 else None
    return file


def _highs_old(text: str) -> SolverFile:
    """Style -1: values alone, in the order of the columns."""
    rows = lines_of(text)
    n = int(rows[0][1].split()[0])
    at = next((k for k, (_, row) in enumerate(rows) if row == "Columns"), None)
    if at is None or (rows[1][1].split() or [""])[0] != "T":
        raise InputError("holds no solution", "missing", line=rows[min(1, len(rows) - 1)][0])
    file = SolverFile("HiGHS", columns=n, numbered=True)
    for k, (line, row) in enumerate(rows[at + 1 : at + 1 + n]):
        _put(file, f"x{k}", row, line)
    if len(file.values) != n:
        raise InputError("is cut off", "missing", expected=f"{n} variables", found=str(len(file.values)))
    return file


def _highs_table(text: str) -> SolverFile:
    file, place = SolverFile("HiGHS"), None
    if (status := re.search(r"^Model status:.*$", text, re.MULTILINE)) and _NONE.search(status[0]):
        raise InputError("holds no solution", "missing", line=text.count("\n", 0, status.start()) + 1, found=shown(status[0]))
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
            _put(file, words[-1], numbers[2], line)
    objective = re.search(r"^Objective value:\s*(\S+)", text, re.MULTILINE)
    file.stated = float(objective[1]) if objective and is_number(objective[1]) else None
    file.columns = len(file.values)
    return file


def _scip(text: str) -> SolverFile:
    file = SolverFile("SCIP")
    for line, row in lines_of(text):
        words = row.split()
        if row.lower().startswith("objective value:"):
            file.stated = _value(words[-1], line, "objective")
        elif row.lower().startswith(("solution status:", "no solution")):
            if _NONE.search(row):
                raise InputError("holds no solution", "missing", line=line, found=shown(row))
        elif len(words) in (2, 3) and (len(words) == 2 or words[2].startswith("(obj:")):
            _put(file, words[0], words[1], line)
        else:
            raise InputError("line is not understood", line=line, expected="a name and a value", found=shown(row))
    return file


def _cbc(text: str) -> SolverFile:
    file, last = SolverFile("CBC"), -1
    for line, row in lines_of(text):
        words = row.split()
        if "objective value" in row and file.stated is None and not file.values:
            if _NONE.search(row):
                raise InputError("holds no solution", "missing", line=line, found=shown(row))
            file.stated = _value(words[-1], line, "objective")
            continue
        words = words[1:] if words[0] == "**" else words  # a value beyond its bounds: the judge sees it
        if len(words) != 4 or not words[0].isdigit():
            raise InputError("line is not understood", line=line, expected="index, name, value, cost", found=shown(row))
        if int(words[0]) <= last:
            file.values.clear()  # what came before were the rows, which it prints where it is asked for all
        last = int(words[0])
        _put(file, words[1], words[2], line)
    return file


def _glpk(text: str) -> SolverFile:
    """GLPK's raw text: a line ``s`` with kind and sizes, and a line ``j`` a column, by number."""
    file, places = SolverFile("GLPK", numbered=True), {"mip": 2, "ipt": 2, "bas": 3}
    place, ended = 2, False
    for line, row in lines_of(text):
        words = row.split()
        if words[0] == "s":
            if len(words) < 6 or words[1] not in places or not words[3].isdigit():
                raise InputError(
                    "line is not understood", line=line, expected="s, kind, rows, columns, status, objective", found=shown(row)
                )
            if not set(words[4:-1]) <= {"o", "f"}:
                raise InputError("holds no solution", "missing", line=line, found=shown(row))
            place, file.columns, file.stated = places[words[1]], int(words[3]), _value(words[-1], line, "objective")
        elif words[0] == "j" and len(words) > place and words[1].isdigit():
            _put(file, f"x{int(words[1]) - 1}", words[place], line)
        elif words == ["e", "o", "f"]:
            ended = True
        elif words[0] not in ("c", "i"):
            raise InputError("line is not understood", line=line, expected="c, s, i, j or e", found=shown(row))
    if not ended:
        raise InputError("is cut off", "missing", expected="e o f")
    return file


def _glpk_printed(text: str) -> SolverFile:
    """GLPK's printed solution: a table of rows and one of columns, in which long names have a line of their own."""
    file, inside, name = SolverFile("GLPK"), False, ""
    for line, row in lines_of(text):
        words = row.split()
        if words[0] == "Status:" and _NONE.search(row):
            raise InputError("holds no solution", "missing", line=line, found=shown(row))
        if words[0] == "Objective:" and "=" in words:
            file.stated = _value(words[words.index("=") + 1], line, "objective")
        elif words[0] == "Columns:" and words[1].isdigit():
            file.columns = int(words[1])
        elif words[0] == "No.":
            inside = "Column" in words
        elif inside and not row.startswith("-"):
            if not name and words[0].isdigit() and len(words) > 1:
                name, words = words[1], words[2:]
            elif not name:
                break
            words = [word for word in words if word not in ("*", "B", "NL", "NU", "NF", "NS")]
            if words:
                _put(file, name, words[0], line)
                name = ""
    if file.columns is None or len(file.values) != file.columns:
        raise InputError("is cut off", "missing", expected=f"{file.columns} variables", found=str(len(file.values)))
    return file


def _plain(text: str) -> SolverFile:
    file = SolverFile("the solver")
    for line, row in lines_of(text):
        if row.startswith("#"):
            objective = re.search(r"objective value\s*[=:]\s*(\S+)", row, re.IGNORECASE)
            file.stated = float(objective[1]) if objective and is_number(objective[1]) else file.stated
            file.solver = "Gurobi" if "Solution for model" in row else file.solver
            continue
        words = row.split()
        if len(words) != 2:
            raise InputError("line is not understood", line=line, expected="a name and a value", found=shown(row))
        _put(file, words[0], words[1], line)
    return file


def _mathopt(text: str) -> SolverFile:
    from google.protobuf import json_format, text_format
    from ortools.math_opt import result_pb2

    result = result_pb2.SolveResultProto()
    try:
        if text.lstrip().startswith("{"):
            parse_json(text)
            json_format.Parse(text, result, ignore_unknown_fields=True)
        else:
            text_format.Parse(text, result)
    except (json_format.ParseError, text_format.ParseError) as error:
        raise InputError(f"is no result of MathOpt: {' '.join(str(error).split())[:160]}") from None
    return of_mathopt(result)


def of_mathopt(result: object) -> SolverFile:
    """The first solution in a ``SolveResultProto``."""
    held = [s.primal_solution for s in result.solutions if s.HasField("primal_solution")]  # type: ignore[attr-defined]
    if not held:
        raise InputError("the result of MathOpt holds no solution", "missing")
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
"""For each solver, the test if a text is a file of it, and the reader."""


# -- as a vector -----------------------------------------------------------------------------------------------------------


def vector_of(program: Program, read: SolverFile) -> Floats:
    """The vector of shape (variables,) that a solver's file holds.

    Raises InputError if the file names other variables, has another number of them, or states another objective than its values have.
    """
    n = program.num_variables
    if read.columns is not None and read.columns != n:
        raise InputError("has another number of variables", "wrong-shape", expected=str(n), found=str(read.columns))
    x = np.zeros(n)
    for column, value in _named(program, read).items():
        x[column] = value
    if read.stated is not None and not _agrees(program, x, read.stated):
        here = f"{program.value(x):.10g}"
        raise InputError(
            f"has the objective {here} by its values", "contradiction",
            expected="the objective that it states", found=f"{read.stated:.10g}",
        )  # fmt: skip
    return x


def _named(program: Program, read: SolverFile) -> Mapping[int, float]:
    """Values by column, from names of exports, of the program, of blocks, or positions."""
    n, values = program.num_variables, {name: v for name, v in read.values.items() if name.casefold() not in MADE_UP}
    columns = {name: k for k, name in enumerate(column_names(program))}
    if not read.numbered:
        if all(name in columns for name in values):
            return {columns[name]: value for name, value in values.items()}
        own = {name: k for k, name in enumerate(own_names(program.variables))}
        if all(name in own for name in values):
            return {own[name]: value for name, value in values.items()}
        blocks = zip(block_names(program), program.variables, strict=True)
        places = {name: k for k, name in enumerate(in_block(name, k) for name, block in blocks for k in range(block.size))}
        if values.keys() == places.keys():
            return {places[name]: value for name, value in values.items()}
    places = {name: int(position[1]) for name in values if (position := _POSITION.match(name))}
    if len(places) == len(values) and all(k < n for k in places.values()):
        if len(set(places.values())) < len(places):
            raise InputError("names two variables of one number", "duplicate", found=", ".join(list(values)[:3]))
        return {places[name]: value for name, value in values.items()}
    strange = next(name for name in values if name not in columns)
    hint = did_you_mean(strange, list(columns)[:2000])
    raise InputError(f"names a variable that does not exist{hint}", "unknown-name", expected=", ".join(list(columns)[:3]) + ", ...",
                     found=shown(strange))  # fmt: skip


def _agrees(program: Program, x: Floats, stated: float) -> bool:
    """True if a stated objective is that of the values; solvers drop its constant, or turn its sign to minimise."""
    value, terms = program.value(x), np.abs(program.cost * x)
    size = max(abs(value), abs(stated), float(terms.max(initial=0.0)), 1e-300)
    meant = (stated, stated + program.offset, -stated, -stated + program.offset)
    return any(math.isfinite(m) and abs(m - value) <= SAME * size for m in meant)


def is_solver_json(data: object) -> bool:
    """True if a parsed document is a result of MathOpt."""
    return isinstance(data, dict) and "solutions" in data and "termination" in data


def solver_json(data: object) -> SolverFile:
    """Contents of a parsed result of MathOpt."""
    return _mathopt(json.dumps(data))
