"""Solutions as vectors of a program: from solvers' files, values by name, or solved models."""

import math
from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np

from ...instances.errors import InputError, UsageError
from ...instances.text import read_text, shown
from .names import in_block
from .program import Floats, Program
from .solution_files import MADE_UP, SolverFile, of_mathopt, solver_file, vector_of


def vector_from(program: Program, solution: Any) -> Floats:
    """The vector of shape (variables,) that ``solution`` stands for; see ``Compiled.answer``."""
    if isinstance(solution, str | PathLike):
        return vector_in_file(program, solution)
    read = solved_model(solution)
    if read is None and isinstance(solution, Mapping):
        read = SolverFile("the values", _valued({str(k): v for k, v in solution.items()}))
    return _vector(program, solution) if read is None else vector_of(program, read)


def solved_model(model: Any) -> SolverFile | None:
    """Values in a model of HiGHS, PuLP, CVXPY or PySCIPOpt, or in MathOpt's result; None for any other object.

    Raises InputError for a model that was not solved, or has no solution.
    """
    module = type(model).__module__.partition(".")[0]
    values: dict[str, Any]
    if module == "highspy" and hasattr(model, "getSolution"):
        solution, names = model.getSolution(), model.getLp().col_names_
        numbers = list(solution.col_value) if solution.value_valid else [None] * model.getNumCol()
        numbered = not all(names) or len(set(names)) < len(numbers)
        values = dict(zip([f"x{k}" for k in range(len(numbers))] if numbered else names, numbers, strict=True))
        return SolverFile("HiGHS", _valued(values), float(model.getInfo().objective_function_value), len(numbers), numbered)
    if module == "pulp" and hasattr(model, "variables"):
        held = model.sol_status in (1, 2)  # optimal, or feasible: CBC leaves values behind where there is no solution
        values = {v.name: v.value() if held else None for v in model.variables() if v.name != "__dummy"}
        return SolverFile("PuLP", _valued(values), None if model.objective is None else model.objective.value(), len(values))
    if module == "cvxpy" and hasattr(model, "var_dict"):
        parts = {name: [None] * v.size if v.value is None else np.ravel(v.value).tolist() for name, v in model.var_dict.items()}
        values = {in_block(name, k): v for name, part in parts.items() for k, v in enumerate(part)}
        return SolverFile("CVXPY", _valued(values), None if model.value is None else float(model.value), len(values))
    if type(model).__module__.startswith("ortools.math_opt.python"):
        if not hasattr(model, "solutions"):
            raise InputError(f"MathOpt's {type(model).__name__} is no result", expected="what mathopt.solve returned")
        return of_mathopt(model.to_proto())
    if module == "pyscipopt" and hasattr(model, "getBestSol"):
        if not model.getStage():  # freed, or never filled: SCIP ends the process where it is asked for more
            raise InputError("the model holds no solution; was it solved?", "missing", found="a model of SCIP without a problem")
        best = model.getBestSol() if model.getNSols() else None
        values = {v.name: None if best is None else model.getSolVal(best, v) for v in model.getVars()}
        columns = sum(name.casefold() not in MADE_UP for name in values)
        return SolverFile("SCIP", _valued(values), None if best is None else model.getSolObjVal(best), columns)
    return None


def vector_in_file(program: Program, path: str | PathLike[str]) -> Floats:
    """The vector in a solver's solution file; raises InputError with the file unless it is one of this program."""
    text = read_text(path)
    try:
        read = solver_file(text)
        if read is None:
            first = repr(text.strip().split("\n")[0][:40])
            raise InputError("is no solver's solution file", expected="one of HiGHS, SCIP, CBC, GLPK, Gurobi or MathOpt", found=first)
        return vector_of(program, read)
    except InputError as error:
        raise error.at(file=path) from None


def _valued(values: Mapping[str, Any]) -> dict[str, float]:
    unknown = next((name for name, value in values.items() if value is None), None)
    if unknown is not None:
        raise InputError("the model holds no solution; was it solved?", "missing", found=f"variable {unknown} without a value")
    numbers: dict[str, float] = {}
    for name, value in values.items():
        try:
            numbers[name] = float(value)
        except (TypeError, ValueError):
            raise InputError(f"the value of variable {name} must be a number", found=shown(str(value))) from None
        if not math.isfinite(numbers[name]):
            raise InputError(f"the value of variable {name} is not finite", "out-of-range", found=str(value))
    return numbers


def _vector(program: Program, values: Any) -> Floats:
    try:
        x = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise UsageError(
            f"a solution is a file, values by name, a vector or a solved model, not {type(values).__name__}", "malformed"
        ) from None
    if x.shape != (program.num_variables,):
        raise InputError(
            "the vector has another size than the model", "wrong-shape", expected=f"({program.num_variables},)", found=str(x.shape)
        )
    if not np.isfinite(x).all():
        raise InputError("the vector holds a value that is not finite", "out-of-range")
    return x
