"""Solution files of outside solvers, as vectors; files of another model are refused."""

import subprocess
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from coded import coded
from exported import everything, rows_of

from waybound import InputError, Program, Rows, Variables
from waybound.formulations.programs.export import write_program
from waybound.formulations.programs.names import column_names
from waybound.formulations.programs.solution_files import SolverFile, is_solver_json, solver_file, vector_of

NAMES = (("a", "b"), ("x-y", "z"))


def program(offset: float = 0.0) -> Program:
    """Four variables ``use-it[a,x-y], ...``, named ``use_it(a,x_y)`` in exports; the objective is 1, 2, 3, 4 times them."""
    i, j = (k.ravel() for k in np.indices((2, 2)))
    block = Variables("use-it", (i, j), NAMES, np.zeros(4), np.full(4, 9.0), np.arange(1.0, 5.0), integer=True)
    return Program("tiny", "min", (block,), (Rows("none"),), offset=offset)


MADE = program()
A, B, C, D = column_names(MADE)

RAW = "Model status\nOptimal\n\n# Primal solution values\nFeasible\nObjective 9\n# Columns 4\n{} 0\n{} 1\n{} 1\n{} 1\n# Rows 0\n"
HEAD = "Columns\n    Index Status        Lower        Upper       Primal         Dual  Type        Name\n"
ROW = "        {}                   0          inf  {:9g}               Integer     {}\n"
TABLE = [ROW.format(k, v, n) for k, (n, v) in enumerate(zip((A, B, C, D), (0, 1, 1, 1), strict=True))]
CBC = f" - objective value 9.00000000\n      1 {B}      1      2\n      2 {C}      1     3\n"

FILES = {
    "HiGHS": RAW.format(A, B, C, D),
    "HiGHS without names": RAW.format("c0", "c1", "c2", "c3"),
    "HiGHS, a table": HEAD + "".join(TABLE) + "Rows\n    Index Status\n\nModel status: Optimal\n\nObjective value: 9\n",
    "SCIP": f"solution status: optimal solution found\nobjective value: 9\n{B}  1 \t(obj:2)\n{C}  1 \t(obj:3)\n{D}  1 \t(obj:4)\n",
    "CBC": f"Optimal{CBC}**    3 {D}    1     4\n",
    "CBC, stopped": f"Stopped on time{CBC}      3 {D}    1     4\n",
    "Gurobi": f"# Solution for model tiny\n# Objective value = 9\n{A} 0\n{B} 1\n{C} 1\n{D} 1\n",
    "MathOpt": "termination {\n  reason: TERMINATION_REASON_OPTIMAL\n}\nsolutions {\n  primal_solution {\n    variable_values {\n"
    "      ids: 0\n      ids: 1\n      ids: 2\n      ids: 3\n      values: 0\n      values: 1\n      values: 1\n      values: 1\n    }\n"
    "    objective_value: 9\n  }\n}\n",
    "MathOpt, JSON": '{"termination": {"reason": "TERMINATION_REASON_OPTIMAL"}, "solutions": [{"primalSolution": {"variableValues":'
    ' {"ids": ["1", "2", "3"], "values": [1.0, 1.0, 1.0]}, "objectiveValue": 9.0}}]}',
    "names of the program": "# Objective value = 9\nuse-it[a,z] 1\nuse-it[b,x-y] 1\nuse-it[b,z] 1\n",
    "numbers with zeros": "# Objective value = 9\nX0000001 1\nX0000002 1\nX0000003 1\n",
}  # fmt: skip


def read(text: str) -> SolverFile:
    values = solver_file(text)
    assert values is not None
    return values


@pytest.mark.parametrize("name", FILES)
def test_every_solver_is_read(name: str) -> None:
    values = read(FILES[name])
    assert values.stated == 9.0
    assert vector_of(MADE, values).tolist() == [0, 1, 1, 1]


def test_names_are_those_of_every_export() -> None:
    assert column_names(MADE) == ["use_it(a,x_y)", "use_it(a,z)", "use_it(b,x_y)", "use_it(b,z)"]


def test_a_constant_that_a_solver_drops_or_a_sign_that_it_turns_is_no_other_model() -> None:
    shifted, stated = program(offset=5.0), "# Objective value = {}\n" + f"{B} 1\n{C} 1\n{D} 1\nobjoffset 1\n"
    for value in ("9", "14", "-14", "-9"):
        assert vector_of(shifted, read(stated.format(value))).sum() == 3
    with pytest.raises(InputError, match="has the objective 14 by its values; expected the objective that it states; found 8"):
        vector_of(shifted, read(stated.format("8")))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (FILES["Gurobi"].replace(D, "use_it(b,q)"), r"names a variable that does not exist; did you mean 'use_it\(b,z\)'"),
        (FILES["Gurobi"].replace("= 9", "= 12"), "has the objective 9 by its values; expected the objective that it states; found 12"),
        (
            FILES["HiGHS without names"].replace("Columns 4", "Columns 5").replace("c3 1", "c3 1\nc4 0"),
            "has another number of variables; expected 4; found 5",
        ),
        ("# Objective value = 1\nx7 1\n", "names a variable that does not exist"),
    ],
)
def test_a_solution_of_another_model_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        vector_of(MADE, read(text))


def test_two_names_of_one_variable_are_refused() -> None:
    with pytest.raises(InputError, check=coded("duplicate")):
        vector_of(MADE, read("# Objective value = 1\nx1 1\nc1 1\n"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Model status\nInfeasible\n\n# Primal solution values\nNone\n", "holds no solution"),
        (FILES["HiGHS"].replace(f"{D} 1\n", ""), "is cut off; expected 4 variables; found 3"),
        (FILES["HiGHS"].replace(f"{D} 1", f"{D} one"), "line 11: value of .* must be a finite number"),
        ("solution status: infeasible\nno solution available\n", "line 1: holds no solution"),
        (FILES["SCIP"] + "what is this line\n", "line 6: line is not understood"),
        ("Infeasible - objective value 9.0\n", "line 1: holds no solution"),
        (FILES["CBC"] + "      3 " + B + "\n", "line 5: line is not understood; expected index, name, value, cost"),
        (FILES["Gurobi"] + B + " 1\n", "line 7: variable .* stands twice"),
        (FILES["Gurobi"] + "x 1 2\n", "line 7: line is not understood"),
        ("termination {\n  reason: TERMINATION_REASON_INFEASIBLE\n}\n", "the result of MathOpt holds no solution"),
        ("termination {\n  reason: NO_SUCH\n}\n", "is no result of MathOpt"),
        ("s mip 1 2 o 3\nj 1 1\nj 2 1\n", "is cut off; expected e o f"),
        ("s mip 1 2 u 3\ne o f\n", "line 1: holds no solution"),
        ("s mip 1 2 o 3\nj 1 x\n", "line 2: value of 'x0' must be a finite number"),
        ("2 1 : Number of columns and rows\nT Primal\nF\nF\nColumns\n1\n", "is cut off; expected 2 variables; found 1"),
        ("Problem: m\nRows: 1\nColumns: 2\nNo. Column name Activity\n--\n 1 a 3 0 1\n", "is cut off; expected 2 variables; found 1"),
    ],
)
def test_a_broken_file_or_one_without_a_solution_is_refused_with_its_line(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(text)


# -- files that the solvers themselves write -----------------------------------------------------------------------------


def knapsack(least: float) -> Program:
    """Choose whole numbers of three things, at least ``least`` of weight, at most 6 of each: with 40 there is no answer."""
    block = Variables("take", (np.arange(3),), (("apple", "pear-and-a-very-long-name", "fig"),), np.zeros(3), np.full(3, 6.0),
                      np.array([2.0, 3.0, 1.5]), integer=True)  # fmt: skip
    return Program("sack", "min", (block,), (rows_of("weight", [[2, 4, 1]], [least], [np.inf]),))


def write_highs(model: Path, out: Path, style: int) -> None:
    highs = pytest.importorskip("highspy").Highs()
    highs.silent()
    highs.readModel(str(model))
    highs.run()
    highs.writeSolution(str(out), style)


def write_scip(model: Path, out: Path, zeros: bool) -> None:
    scip_model = pytest.importorskip("pyscipopt").Model()
    scip_model.hideOutput()
    scip_model.readProblem(str(model))
    scip_model.optimize()
    scip_model.writeBestSol(str(out), write_zeros=zeros)


def write_cbc(model: Path, out: Path, *options: str) -> None:
    cbc = pytest.importorskip("pulp").PULP_CBC_CMD()
    if not cbc.available():
        pytest.skip("PuLP has no CBC here")
    subprocess.run([cbc.path, str(model), *options, "solution", str(out)], capture_output=True, check=True)


WRITERS: dict[str, Callable[[Path, Path], None]] = {
    **{f"HiGHS, style {style}": partial(write_highs, style=style) for style in range(-1, 5)},
    "SCIP": partial(write_scip, zeros=False),
    "SCIP, zeros": partial(write_scip, zeros=True),
    "CBC": lambda model, out: write_cbc(model, out, "solve"),
    "CBC, all": lambda model, out: write_cbc(model, out, "solve", "printingOptions", "all"),
}


@pytest.mark.filterwarnings("ignore:PULP_CBC_CMD")
@pytest.mark.parametrize("suffix", [".mps", ".lp"])
@pytest.mark.parametrize("name", WRITERS)
def test_what_solvers_write_of_an_exported_model_is_read(name: str, suffix: str, tmp_path: Path) -> None:
    p = knapsack(29.0)
    write_program(p, tmp_path / f"m{suffix}")
    WRITERS[name](tmp_path / f"m{suffix}", tmp_path / "s.sol")
    x = vector_of(p, read((tmp_path / "s.sol").read_text()))
    assert p.value(x) == 23.5 and x @ [2.0, 4.0, 1.0] >= 29.0


@pytest.mark.filterwarnings("ignore:PULP_CBC_CMD")
@pytest.mark.parametrize("name", sorted(WRITERS.keys() - {"HiGHS, style -1"}))  # which is empty then
def test_what_solvers_write_where_there_is_no_solution_is_none(name: str, tmp_path: Path) -> None:
    write_program(knapsack(50.0), tmp_path / "m.mps")
    WRITERS[name](tmp_path / "m.mps", tmp_path / "s.sol")
    with pytest.raises(InputError, check=coded("missing")):
        vector_of(knapsack(50.0), read((tmp_path / "s.sol").read_text()))


def test_a_relaxation_that_cbc_writes_for_want_of_a_solution_is_none() -> None:
    with pytest.raises(InputError, match="line 1: holds no solution"):
        read("Stopped on time (no integer solution - continuous used) - objective value 3.5\n      0 a 0.5 1\n")


def test_other_texts_are_none() -> None:
    assert solver_file("Route #1: 1 2\nCost 9\n") is None and solver_file("vehicle,site\n1,a\n") is None
    assert is_solver_json({"solutions": [], "termination": {}}) and not is_solver_json({"routes": []})


def test_names_of_all_blocks_differ() -> None:
    p = everything("min")
    assert len(set(column_names(p))) == p.num_variables
