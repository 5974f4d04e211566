"""Bound ``tangent``: a convex quadratic program, linearised at its optimum."""

import math
from dataclasses import replace

import numpy as np

from ....formulations.arrays.problem import ArrayProblem
from ....formulations.evidence import Evidence
from ....formulations.programs.duals import dual_value
from ....formulations.programs.program import QUADRATIC
from ....formulations.stop import NEVER, Stop
from ....formulations.verified_bounds import verified_bound
from ...backend import Control, Options
from ...backends.highs import Highs
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from ..linear_relaxation import ENTRIES_PER_SECOND, vertex


def _lacks(problem: ArrayProblem) -> frozenset[str]:
    features = problem.program.features()
    return frozenset() if features >= QUADRATIC and not problem.program.cones else frozenset({"a linear objective, or cones"})


@bound_method("tangent", of_family("arrays", _lacks), order=2)
def tangent_bound(problem: ArrayProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence of kind ``quadratic-duals`` at the optimum of the continuous relaxation, or that no point is within rows and bounds.

    None where the relaxation is not convex, or was not solved in time.
    """
    linear, program = linear or LinearPrograms(), problem.program
    if stop.reached() or len(program.data) > ENTRIES_PER_SECOND * stop.seconds_left:
        return None
    relaxed = replace(program, variables=tuple(replace(block, integer=False) for block in program.variables))
    control = Control()
    with stop.telling(control.stop):
        result = Highs().run(relaxed, Options(time_limit=max(stop.seconds_left, 0.01), seed=linear.seed), control)
    if result.status == "infeasible":
        return vertex(problem.compile("arrays"), stop, linear.seed)
    if result.answer is None or program.quadratic is None:
        return None
    point = np.asarray(result.answer, dtype=np.float64)
    flat = replace(relaxed, quadratic=None, offset=0.0).with_costs(program.cost + program.quadratic @ point)
    duals = linear.duals(flat, stop)
    if duals is None:
        return None
    value = dual_value(flat, duals) + float(program.offset) - float(point @ (program.quadratic @ point)) / 2.0
    data = {"duals": duals.tolist(), "point": point.tolist()}
    evidence = Evidence("quadratic-duals", "tangent at the relaxation's optimum", value, data)
    return evidence if math.isfinite(verified_bound(problem, evidence)) else None
