"""Checker of evidence ``lp-dual``: the row duals of a linear program, multiplied out against its arrays.

For min c x over L <= A x <= U, l <= x <= u and any y::

    c x  >=  sum_i min over r in [L_i, U_i] of y_i r  +  sum_j min over x_j in [l_j, u_j] of d_j x_j,      d = c - A' y

The sum of the right side for c = 0 is at most 0 wherever there is an x; a ray y that makes it positive proves that there is none (Farkas).

A dual that points to a side that is not there is set to 0 first: that too is a dual vector. What makes such a bound fail in practice
is a reduced cost of 1e-17 on a variable without a bound. Three remedies are tried in turn: bounds that single rows imply for the variable,
duals moved by a rounding so that the reduced cost points to a side that has a bound, and its sign in exact arithmetic. Where none
helps, duals of a small program are moved in fractions until it is 0; else nothing is proved.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...checking.evidence_numbers import numbers
from ...checking.granularity import grain, lift
from ...checking.row_duals import least_value
from ...evidence import checker

_EPS = float(np.finfo(np.float64).eps)
_VANISHING = 1e-250
"""Below it products vanish, and the sign of a sum with them."""


@checker("lp-dual", "arrays", "row duals are", of="programs given as arrays")
def check_lp_dual(problem: Any, data: Mapping[str, Any]) -> float:
    """Bound on a linear (or mixed-integer linear) program that any row duals prove (weak duality with bounded variables).

    ``duals``: one number per row, d objective / d right side, of a linear objective, without cones. Or ``ray``, whatever the objective: one
    number a row, positive where the lower side of the row counts, in either sense of the program. The bound is minus infinity (``min``) or
    infinity (``max``) where nothing is proved, and the other way round where the ray, or limits of a variable between which there is no
    number, prove that no x is within the limits. Raises InputError for a list that is missing, of another length, or of other than finite
    numbers. Source: Neumaier and Shcherbina (2004), "Safe bounds in linear and mixed-integer linear programming";
    docs/formulations/arrays.md#row-duals.
    """
    program = problem.program
    ray = "ray" in data
    duals = numbers(data, "ray" if ray else "duals", program.num_rows)
    sign = 1.0 if program.sense == "min" else -1.0
    if (program.lower > program.upper).any():
        return sign * math.inf
    if not ray and (program.quadratic is not None or program.cones):
        return -sign * math.inf
    if ray:
        with np.errstate(over="ignore", invalid="ignore"):
            duals /= max(float(np.abs(duals).max(initial=0.0)), _VANISHING)
    bound, _ = least_value(program, np.zeros(program.num_variables) if ray else sign * program.cost, duals if ray else sign * duals)
    if ray:
        ends = [v[np.isfinite(v)] for v in (program.lower, program.upper, program.row_lower, program.row_upper)]
        lost = _VANISHING * (1.0 + max(float(np.abs(v).max(initial=0.0)) for v in ends))
        return sign * math.inf if bound > lost else -sign * math.inf
    if not math.isfinite(bound):
        return -sign * math.inf
    counted = program.cost[program.cost != 0]
    step = grain(counted) if program.integer[program.cost != 0].all() else None
    if step is not None and (np.fmod(counted, step.size) == 0.0).all():  # exactly: terms of both signs may cancel
        bound = lift(bound, "min", step)
    offset = float(program.offset)
    bound = sign * bound + offset
    return bound - sign * 4 * _EPS * abs(bound) if offset else bound
