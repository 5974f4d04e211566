"""Bound ``endless-ray``: a direction in which the objective of a program improves for ever, and a point to begin at."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np

from ....formulations.arrays.problem import ArrayProblem
from ....formulations.evidence import ENDLESS, Evidence
from ....formulations.programs.program import Floats, Program
from ....formulations.programs.reductions.units import scaled
from ....formulations.stop import NEVER, Stop
from ...backend import Control, Options
from ...backends.highs import Highs
from ...linear_programs import LinearPrograms
from ...linear_session import LinearSession
from .. import bound_method, of_family
from ..linear_relaxation import ENTRIES_PER_SECOND

DENOMINATORS = (1, 12, 1000, 10**6)
"""Largest denominators of the fractions that entries of a ray are tried as."""

LEAST_GAIN = 1e-9
"""Rounding error of the objective along a ray, in ordinary units."""


def _lacks(problem: ArrayProblem) -> frozenset[str]:
    p = problem.program
    missing = {"a quadratic objective"} if p.quadratic is not None else set()
    missing |= {"cones"} if p.cones else set()
    gain = -p.cost if p.sense == "min" else p.cost
    gains = ((gain > 0) & np.isinf(p.upper)) | ((gain < 0) & np.isinf(p.lower))
    return frozenset(missing | (set() if gains.any() else {"bounds on all that gains"}))


@bound_method("endless-ray", of_family("arrays", _lacks), order=8)
def endless_ray(problem: ArrayProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence of kind ``endless-ray`` that the objective of a linear program, mixed-integer or not, has no bound.

    None where no ray improves the objective, none does so in fractions, or no point was reached in time.
    """
    program = problem.program
    if stop.reached() or len(program.data) > ENTRIES_PER_SECOND * stop.seconds_left:
        return None
    units = scaled(program)
    ray = _ray(units.program, stop, 1 if linear is None else linear.seed)
    if ray is None:
        return None
    point = _point(program, stop)
    if point is None:
        return None
    worst = -math.inf if program.sense == "min" else math.inf
    for denominator in DENOMINATORS:
        direction = units.vector(_whole(ray, denominator))
        data = {"point": point.tolist(), "ray": direction.tolist()}
        if np.isfinite(direction).all() and ENDLESS["endless-ray"](problem, data):
            return Evidence("endless-ray", "a point and a ray along which the objective improves for ever", worst, data)
    return None


def _ray(program: Program, stop: Stop, seed: int) -> Floats | None:
    """The best direction of the linear relaxation whose entries are within -1 and 1; None where none improves the objective."""
    lower, upper = (np.where(np.isinf(end), np.sign(end), 0.0) for end in (program.lower, program.upper))
    rows = tuple(
        replace(block, lower=np.where(np.isinf(block.lower), -math.inf, 0.0), upper=np.where(np.isinf(block.upper), math.inf, 0.0))
        for block in program.rows
    )
    bare = replace(program, rows=rows, offset=0.0, variables=tuple(replace(b, integer=False) for b in program.variables))
    result = LinearSession(bare.with_bounds(lower, upper), seed).solve(stop)
    gain = result.value if program.sense == "max" else -result.value
    return result.x if result.status == "optimal" and gain > LEAST_GAIN else None


def _point(program: Program, stop: Stop) -> Floats | None:
    """Any point of the program."""
    bare = replace(program, offset=0.0).with_costs(np.zeros(program.num_variables))
    control = Control()
    with stop.telling(control.stop):
        result = Highs().run(bare, Options(time_limit=max(stop.seconds_left, 0.01)), control)
    return None if result.answer is None else np.asarray(result.answer, dtype=np.float64)


def _whole(ray: Floats, denominator: int) -> Floats:
    """The nearest fractions of at most this denominator, multiplied so that all are whole."""
    near = [Fraction(float(r) / float(np.abs(ray).max())).limit_denominator(denominator) for r in ray]
    factor = math.lcm(*(f.denominator for f in near))
    return np.array([float(f * factor) if abs(f * factor) < 2**53 else math.nan for f in near])
