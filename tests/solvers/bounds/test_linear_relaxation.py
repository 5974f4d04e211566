"""Duals of a form's linear relaxation prove a bound."""

from __future__ import annotations

import numpy as np
from programs import AnsweredBy

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import verified_bound
from waybound.formulations.programs.program import Program, Rows, Variables
from waybound.formulations.stop import Stop
from waybound.solvers.bounds.linear_relaxation import linear_relaxation_bound


def test_bare_programs_are_bounded_by_their_own_relaxation():
    # max 3 x + 2 y over x + y <= 3.5, x <= 2.5, integer: 8, relaxed 9.5, and 9 since the costs are integers on integer variables.
    ints = np.array([0, 2], dtype=np.int32), np.array([0, 1], dtype=np.int32)
    rows = Rows("r", indptr=ints[0], indices=ints[1], data=np.ones(2), lower=np.array([-np.inf]), upper=np.array([3.5]))
    columns = Variables("x", lower=np.zeros(2), upper=np.array([2.5, 9.0]), cost=np.array([3.0, 2.0]), integer=True)
    problem = ArrayProblem(Program("arrays", "max", (columns,), (rows,)))
    evidence = linear_relaxation_bound(problem, Stop(5.0), AnsweredBy(lambda program, seconds: np.array([2.0])))
    assert evidence is not None
    assert evidence.kind == "lp-dual"
    assert verified_bound(problem, evidence) == 9.0
