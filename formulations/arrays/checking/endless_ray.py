"""Checker of evidence ``endless-ray``: a point of a program, and a direction along which the objective improves for ever.

With a ray r that leaves every row and bound alone, or moves away from the only side that there is, x + t r is within all of them for any
t >= 0 if x is; r times a power of two is whole, so that integers stay so. The objective at x + t r is ::

    c x + x' Q x / 2  +  t (c + Q x) r  +  t^2 r' Q r / 2

All but the judging of x is done in fractions.
"""

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ...checking.evidence_numbers import numbers
from ...evidence import ENDLESS


@ENDLESS.register("endless-ray")
def check_endless_ray(problem: Any, data: Mapping[str, Any]) -> bool:
    """Check that a program has points, and that those along a ray prove its objective unbounded.

    ``point`` and ``ray`` hold one number per variable each; InputError is raised for anything else. Source: Schrijver (1986), "Theory of
    Linear and Integer Programming", sections 8.2 and 16.2.
    """
    if problem.family != "arrays":
        raise InputError("a ray is evidence for programs given as arrays", "foreign", found=problem.family)
    p = problem.program
    point, ray = numbers(data, "point", p.num_variables), numbers(data, "ray", p.num_variables)
    if p.cones or not problem.evaluate(point).feasible:
        return False
    if ((ray > 0) & (p.upper < math.inf)).any() or ((ray < 0) & (p.lower > -math.inf)).any():
        return False
    moved = [Fraction(0)] * p.num_rows
    row = np.repeat(np.arange(p.num_rows), np.diff(p.indptr))
    for k in np.nonzero((p.data != 0) & (ray[p.indices] != 0))[0].tolist():
        moved[row[k]] += Fraction(p.data[k]) * Fraction(ray[p.indices[k]])
    ends = zip(moved, p.row_lower.tolist(), p.row_upper.tolist(), strict=True)
    if any((by > 0 and high < math.inf) or (by < 0 and low > -math.inf) for by, low, high in ends):
        return False
    slope, bend = sum((Fraction(p.cost[j]) * Fraction(ray[j]) for j in np.nonzero(ray)[0].tolist()), Fraction(0)), Fraction(0)
    if p.quadratic is not None:
        q = p.quadratic.tocoo()
        for i, j, value in zip(q.row.tolist(), q.col.tolist(), q.data.tolist(), strict=True):
            a, b, half = Fraction(ray[i]), Fraction(ray[j]), Fraction(value) / 2
            slope += half * (a * Fraction(point[j]) + b * Fraction(point[i]))
            bend += half * a * b
    gain = bend or slope
    return gain < 0 if p.sense == "min" else gain > 0
