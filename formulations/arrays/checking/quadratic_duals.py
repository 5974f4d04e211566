"""Checker of evidence ``quadratic-duals``: a linear function below a quadratic objective, and row duals of its linear program.

To be minimised is ``c x + x' Q x / 2`` over rows and bounds, Q symmetric. Of ``x' Q x / 2`` either the whole is replaced by its tangent at
a point t, if Q is positive semidefinite, which is found out in fractions ::

    x' Q x / 2  >=  t' Q x - t' Q t / 2

or each of its terms by a line or plane that is below it within the bounds l <= x <= u::

    q x_i x_j  >=  q times a mixture, by shares s and 1 - s, of two planes:
                   l_j x_i + l_i x_j - l_i l_j  and  u_j x_i + u_i x_j - u_i u_j        (q > 0)
                   u_j x_i + l_i x_j - l_i u_j  and  l_j x_i + u_i x_j - u_i l_j        (q < 0)
    q x_i^2    >=  q (2 t_i x_i - t_i^2),  or for an integer variable, k = floor(t_i),
                   q ((2 k + 1) x_i - k (k + 1))                                        (q > 0)
                   q ((l_i + u_i) x_i - l_i u_i)                                        (q < 0)

All of them meet the term at the corners of the box, that for integers at k and k + 1: where the integers are fixed, and one variable of
each product is one of them, nothing is lost. The duals are multiplied out as those of ``lp-dual``.

Source: McCormick (1976), Mathematical Programming 10, 147-175.
"""

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ...checking.evidence_numbers import numbers
from ...checking.granularity import Floats, grain, lift
from ...checking.row_duals import least_value
from ...evidence import CHECKERS

MOST_STEPS = 100_000
"""Most products of fractions in the test whether a matrix is semidefinite; a matrix that needs more proves nothing."""

_EPS = float(np.finfo(np.float64).eps)

Line = tuple[dict[int, Fraction], Fraction]
"""Coefficients and constant of a linear function."""


@CHECKERS.register("quadratic-duals")
def check_quadratic_duals(problem: Any, data: Mapping[str, Any]) -> float:
    """Bound on a program with a quadratic objective that row duals prove, together with lines below the objective.

    ``duals``: one number per row, d objective / d right side. ``point``: t, one number per variable, 0 where there is none. ``shares``: one
    number s from 0 to 1 for each product of two different variables, in the order of rows and columns of the upper triangle; without them
    the whole tangent is taken. The bound is infinite, with the sign of no proof, where a limit that it takes is missing, or the matrix is
    not semidefinite; with the other sign where limits of a variable cross. Raises InputError for lists that are missing, of another length,
    or of other than finite numbers.
    """
    if problem.family != "arrays" or problem.program.quadratic is None:
        raise InputError("this is evidence for programs with a quadratic objective", "foreign", found=problem.family)
    program = problem.program
    sign = 1.0 if program.sense == "min" else -1.0
    nothing = -sign * math.inf
    terms = _terms(program, int(sign))
    products = sum(i < j for i, j in terms)
    duals = numbers(data, "duals", program.num_rows)
    point = numbers(data, "point", program.num_variables) if "point" in data else np.zeros(program.num_variables)
    shares = np.clip(numbers(data, "shares", products), 0.0, 1.0) if "shares" in data else None
    if (program.lower > program.upper).any():
        return -nothing
    if program.cones:
        return nothing
    below = _tangent(terms, point) if shares is None else _lines(program, terms, point, shares)
    if below is None:
        return nothing
    slope, constant = below
    cost, lost = sign * program.cost, Fraction(0)
    for j, coefficient in slope.items():
        exact = Fraction(cost[j]) + coefficient
        cost[j] = float(exact)
        doubt = abs(exact - Fraction(cost[j]))
        if doubt:
            furthest = max(abs(float(program.lower[j])), abs(float(program.upper[j])))
            if math.isinf(furthest):
                return nothing
            lost += doubt * Fraction(furthest)
    bound, _ = least_value(program, cost, sign * duals)
    if not math.isfinite(bound):
        return nothing
    exact = Fraction(bound) + constant - lost
    try:
        bound = float(exact)
    except OverflowError:
        return nothing
    bound = bound if bound <= exact else math.nextafter(bound, -math.inf)
    step = _step(program, terms)
    if step is not None:
        bound = lift(bound, "min", step)
    value = sign * bound + float(program.offset)
    return value - sign * 4 * _EPS * max(abs(bound), abs(value)) if program.offset else value


def _terms(program: Any, sign: int) -> dict[tuple[int, int], Fraction]:
    """Coefficients of ``x_i x_j``, i <= j, of the objective as it is minimised, in order."""
    matrix = program.quadratic.tocoo()
    coefficients: dict[tuple[int, int], Fraction] = {}
    for i, j, q in zip(matrix.row.tolist(), matrix.col.tolist(), matrix.data.tolist(), strict=True):
        at = (min(i, j), max(i, j))
        coefficients[at] = coefficients.get(at, Fraction(0)) + sign * Fraction(q) / 2
    return {at: coefficients[at] for at in sorted(coefficients) if coefficients[at]}


def _step(program: Any, terms: Mapping[tuple[int, int], Fraction]) -> Any:
    """A number of which the objective without its constant is an exact multiple; None where none is known."""
    counted = np.array([*program.cost[program.cost != 0].tolist(), *map(float, terms.values())])
    used = np.unique([*np.nonzero(program.cost)[0].tolist(), *(k for at in terms for k in at)]).astype(np.int64)
    step = grain(counted) if program.integer[used].all() else None
    return step if step is not None and (np.fmod(counted, step.size) == 0.0).all() else None


def _tangent(terms: Mapping[tuple[int, int], Fraction], point: Floats) -> Line | None:
    """The tangent at ``point``; None unless the function is convex."""
    if not _semidefinite(terms):
        return None
    slope: dict[int, Fraction] = {}
    constant = Fraction(0)
    for (i, j), q in terms.items():
        a, b = Fraction(point[i]), Fraction(point[j])
        slope[i] = slope.get(i, Fraction(0)) + q * b
        slope[j] = slope.get(j, Fraction(0)) + q * a
        constant -= q * a * b
    return slope, constant


def _semidefinite(terms: Mapping[tuple[int, int], Fraction]) -> bool:
    """Test by elimination if the symmetric matrix of a quadratic form is positive semidefinite; False where that takes too long."""
    rows: dict[int, dict[int, Fraction]] = {}
    for (i, j), q in terms.items():
        rows.setdefault(i, {})[j] = rows.setdefault(j, {})[i] = 2 * q if i == j else q
    steps = 0
    for i in sorted(rows, key=lambda i: len(rows[i])):
        mine = rows.pop(i)
        pivot = mine.pop(i, Fraction(0))
        others = {j: v for j, v in mine.items() if j in rows and v}
        if pivot < 0 or (pivot == 0 and others):
            return False
        steps += len(others) ** 2
        if steps > MOST_STEPS:
            return False
        for j, v in others.items():
            factor, row = v / pivot, rows[j]
            for k, w in others.items():
                row[k] = row.get(k, Fraction(0)) - factor * w
    return True


def _lines(program: Any, terms: Mapping[tuple[int, int], Fraction], point: Floats, shares: Floats) -> Line | None:
    """A line or plane below each term; None where one needs a limit that is not there."""
    whole, low, high = program.integer.tolist(), program.lower.tolist(), program.upper.tolist()
    lower = [math.ceil(v) if w and math.isfinite(v) else v for v, w in zip(low, whole, strict=True)]
    upper = [math.floor(v) if w and math.isfinite(v) else v for v, w in zip(high, whole, strict=True)]
    slope: dict[int, Fraction] = {}
    constant, mixed = Fraction(0), iter(shares.tolist())

    def add(j: int, coefficient: Fraction) -> None:
        slope[j] = slope.get(j, Fraction(0)) + coefficient

    for (i, j), q in terms.items():
        share = Fraction(next(mixed)) if i < j else Fraction(0)
        if (i < j or q < 0) and not all(map(math.isfinite, (lower[i], upper[i], lower[j], upper[j]))):
            return None
        if i == j and q > 0:
            t = Fraction(point[i])
            k = math.floor(t)
            add(i, q * (2 * k + 1 if whole[i] else 2 * t))
            constant -= q * (k * (k + 1) if whole[i] else t * t)
            continue
        a, b = (Fraction(lower[i]), Fraction(lower[j])), (Fraction(upper[i]), Fraction(upper[j]))
        if i == j:
            add(i, q * (a[0] + b[0]))
            constant -= q * a[0] * b[0]
            continue
        corners = (a, b) if q > 0 else ((a[0], b[1]), (b[0], a[1]))
        for weight, (at_i, at_j) in zip((share, 1 - share), corners, strict=True):
            add(i, q * weight * at_j)
            add(j, q * weight * at_i)
            constant -= q * weight * at_i * at_j
    return slope, constant
