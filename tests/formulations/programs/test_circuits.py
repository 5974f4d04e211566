import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coded import coded
from programs import program

import waybound as wb
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.programs.circuits import Circuit
from waybound.formulations.programs.program import CIRCUITS, INTEGERS, Program
from waybound.instances.errors import InputError, UnsupportedError, UsageError


def graph(arcs: str, nodes: int, several: bool = False) -> Circuit:
    """One arc a column: ``"01 12 20"``."""
    tail, head = (np.array([int(arc[end]) for arc in arcs.split()], dtype=np.int32) for end in (0, 1))
    return Circuit("tour", nodes, tail, head, np.arange(len(tail), dtype=np.int32), several)


def over(circuit: Circuit, cost: Any = 1.0) -> Program:
    """Least cost of a circuit, one binary an arc."""
    n = len(circuit.tail)
    return replace(program(np.broadcast_to(cost, n), np.zeros((0, n)), 0, 0, 0, 1, integer=range(n)), circuits=(circuit,))


@pytest.mark.parametrize(
    ("used", "excess"),
    [
        ("01 12 20 33", 0.0),
        ("01 10 22 33", 0.0),
        ("00 11 22 33", 0.0),  # all nodes are left out
        ("00 12 21 33", 0.0),  # it need not pass node 0
        ("01 10 23 32", 1.0),  # two of them
        ("01 12 20", 1.0),  # 3 is neither on it nor left out
        ("01 12 20 33 11", 1.0),  # 1 is both
        ("01 12 33", 1.0),  # a path
    ],
)
def test_one_circuit_passes_each_node_that_has_not_its_own_loop(used: str, excess: float) -> None:
    arcs = [f"{i}{j}" for i in range(4) for j in range(4)]
    assert graph(" ".join(arcs), 4).excess(np.isin(arcs, used.split()).astype(float)) == excess


@pytest.mark.parametrize(
    ("used", "excess"),
    [
        ("01 12 23 30", 0.0),
        ("01 10 02 23 30", 0.0),
        ("01 10 02 20 03 30", 0.0),
        ("01 10 23 32", 1.0),  # one of them misses node 0
        ("01 10 02 23", 1.0),
        ("01 10", 1.0),  # 2 and 3 are left out
    ],
)
def test_several_circuits_share_node_0_and_leave_out_nobody(used: str, excess: float) -> None:
    arcs = [f"{i}{j}" for i in range(4) for j in range(4) if i != j]
    assert graph(" ".join(arcs), 4, several=True).excess(np.isin(arcs, used.split()).astype(float)) == excess


def test_fractions_break_the_balance_by_as_much_as_is_missing() -> None:
    assert graph("01 10 11", 2).excess(np.array([0.75, 0.75, 0.0])) == pytest.approx(0.25)
    assert graph("01 10", 2).excess(np.array([math.nan, 1.0])) == 1.0
    assert graph("", 1, several=True).excess(np.zeros(0)) == 0.0
    assert graph("", 2, several=True).excess(np.zeros(0)) == graph("", 1).excess(np.zeros(0)) == 1.0


@pytest.mark.parametrize(
    ("circuit", "fault"),
    [
        (graph("01 12 20", 2), "a node that does not exist"),
        (graph("01 10 11", 2, several=True), "there are no loops"),
        (graph("01 10 01", 2), "stands there twice"),
        (replace(graph("01 10", 2), column=np.array([0, 2])), "a column that does not exist"),
        (replace(graph("01 10", 2), column=np.array([0])), "different lengths"),
        (graph("", 0), "no nodes"),
    ],
)
def test_arrays_that_are_no_graph_are_refused(circuit: Circuit, fault: str) -> None:
    tour = replace(over(graph("01 10", 2)), circuits=(circuit,))
    with pytest.raises(InputError, match=f"circuit tour: .*{fault}"):
        ArrayProblem(tour)


def test_a_column_of_an_arc_is_binary() -> None:
    for lower, upper, integer in ((0, 2, [0, 1]), (-1, 1, [0, 1]), (0, 1, [1])):
        binary = program([1, 1], np.zeros((0, 2)), 0, 0, lower, upper, integer=integer)
        with pytest.raises(InputError, match="not binary"):
            ArrayProblem(replace(binary, circuits=(graph("01 10", 2),)))


def test_a_program_with_circuits_says_so_and_is_judged_by_them() -> None:
    tour = over(graph("01 10 12 21 02 20 11", 3))
    assert tour.features() == INTEGERS | CIRCUITS
    assert tour.kind == "circuit MILP"
    problem = ArrayProblem(tour)
    assert problem.features() == {"LP", "integer", "circuits"}
    assert problem.digest() != ArrayProblem(replace(tour, circuits=())).digest()
    verdict = problem.evaluate([0, 0, 0, 0, 0, 0, 0])
    assert [(v.check, v.amount) for v in verdict.violations] == [("tour", 1.0)]
    assert problem.evaluate([0, 0, 0, 0, 1, 1, 1]).feasible
    solution = wb.solve(problem, bound_time=0.0)
    assert (solution.solver, solution.status, solution.objective) == ("cpsat", "optimal", 3.0)


def test_what_knows_no_circuits_refuses_them_by_name(tmp_path: Path) -> None:
    tour = over(graph("01 10", 2))
    for hand_over in (tour.to_highs, tour.to_pulp, tour.to_cvxpy, tour.to_mathopt, lambda: tour.write(tmp_path / "m.lp")):
        with pytest.raises(UnsupportedError, match="does not handle circuits"):
            hand_over()
    for solver in ("highs", "pulp", "scip", "mathopt", "mathopt:cp-sat", "cvxpy"):
        with pytest.raises(UnsupportedError, match="does not handle circuits; can take it: cpsat"):
            wb.solve(tour, solver)
    with pytest.raises(UsageError, check=coded("unsupported")):
        wb.solve(tour, "cpsat", relax=True)
