import math

import numpy as np
import pytest
from programs import AnsweredBy

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.programs.program import Program, Rows, Variables
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import truth
from waybound.solvers.bounds.linear_relaxation import linear_relaxation_bound


def test_bare_programs_are_bounded_by_their_own_relaxation():
    # max 3 x + 2 y over x + y <= 3.5, x <= 2.5, integer: 8, relaxed 9.5, and 9 since the costs are integers on integer variables.
    ints = np.array([0, 2], dtype=np.int32), np.array([0, 1], dtype=np.int32)
    rows = Rows("r", indptr=ints[0], indices=ints[1], data=np.ones(2), lower=np.array([-np.inf]), upper=np.array([3.5]))
    columns = Variables("x", lower=np.zeros(2), upper=np.array([2.5, 9.0]), cost=np.array([3.0, 2.0]), integer=True)
    problem = ArrayProblem(Program("arrays", "max", (columns,), (rows,)))
    evidence = linear_relaxation_bound(problem, Stop(60.0), AnsweredBy(lambda program, seconds: np.array([2.0])))
    assert evidence.kind == "lp-dual"
    assert verified_bound(problem, evidence) == 9.0


@pytest.mark.parametrize("seed", range(40))
def test_optima_of_linear_programs_are_proved_and_that_there_are_no_points(seed: int) -> None:
    problem = KINDS["linear"](np.random.default_rng([seed, 29]))
    known, found = truth(problem), linear_relaxation_bound(problem, Stop(20.0))
    if known.status == "infeasible":
        assert found is not None and verified_bound(problem, found) == (math.inf if problem.sense == "min" else -math.inf)
    elif known.value is not None:
        assert found is not None
        size = max(abs(float(known.value)), problem.program.offset)  # type: ignore[attr-defined]
        assert verified_bound(problem, found) == pytest.approx(float(known.value), rel=1e-9, abs=1e-9 * max(1.0, size))
    else:
        assert found is None or math.isfinite(found.value)
