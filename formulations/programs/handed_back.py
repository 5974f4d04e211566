"""Solutions of a program, from wherever it was handed to, as vectors."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np

from ...instances.errors import InputError, UsageError
from ...instances.text import read_text
from .program import Floats, Program
from .solution_files import SolverFile, of_mathopt, solver_file, vector_of


def vector_from(program: Program, solution: Any) -> Floats:
    """The vector of shape (variables,) that ``solution`` stands for; see ``Compiled.answer``."""
    if isinstance(solution, str | PathLike):
        return vector_in_file(program, solution)
    module = type(solution).__module__.partition(".")[0]
    if module == "highspy" and hasattr(solution, "getSolution"):
        found = solution.getSolution()
        return _vector(program, found.col_value if found.value_valid else [], "the model")
    if module == "pulp":
        return vector_of(program, SolverFile("PuLP", _valued({v.name: v.value() for v in solution.variables() if v.name != "__dummy"})))
    if module == "cvxpy":
        from .export.cvxpy import vector_of as values_of

        made = values_of(program, solution)
        return _vector(program, [] if made is None else made, "the model")
    if module == "ortools" and hasattr(solution, "to_proto"):
        return vector_of(program, of_mathopt(solution.to_proto()))
    if isinstance(solution, Mapping):
        return vector_of(program, SolverFile("the values", _valued({str(k): v for k, v in solution.items()})))
    return _vector(program, solution, "the vector")


def vector_in_file(program: Program, path: str | PathLike[str]) -> Floats:
    """The vector in a solver's solution file; raises InputError with the file for what is none of this program."""
    text = read_text(path)
    try:
        read = solver_file(text)
        if read is None:
            found = text.strip().split("\n")[0][:40]
            raise InputError("is no solver's solution file", expected="one of HiGHS, SCIP, CBC, GLPK, Gurobi or MathOpt", found=repr(found))
        return vector_of(program, read)
    except InputError as error:
        raise error.at(file=path) from None


def _valued(values: Mapping[str, Any]) -> dict[str, float]:
    unknown = next((name for name, value in values.items() if value is None), None)
    if unknown is not None:
        raise InputError("the model holds no solution", expected="one that was solved", found=f"variable {unknown} without a value")
    return {name: float(value) for name, value in values.items()}


def _vector(program: Program, values: Any, whose: str) -> Floats:
    try:
        x = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise UsageError(f"a solution is a file, values by name, a vector or a solved model, not {type(values).__name__}") from None
    if x.shape != (program.num_variables,):
        empty = "; was it solved?" if x.size == 0 else ""
        raise InputError(f"{whose} has another size than the model{empty}", expected=f"({program.num_variables},)", found=str(x.shape))
    if not np.isfinite(x).all():
        raise InputError(f"{whose} holds a value that is not finite")
    return x
