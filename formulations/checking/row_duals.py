"""Row duals of a linear program multiplied out against its arrays: at most the least objective, whatever the duals, in safe arithmetic."""

import math
import sys
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...instances.number_arrays import Floats

_EPS = float(np.finfo(np.float64).eps)


_SMALLEST, _NORMAL = math.ulp(0.0), sys.float_info.min


_PASSES = 3


MOST_FRACTIONS = 2_000
"""Entries of a program whose bound is worked out in fractions where doubles are not enough."""


_WIDEST = 1e12
"""Implied bounds beyond this are not worth having: the rounding of a reduced cost times it would swallow the bound."""


def least_value(program: Any, cost: Floats, duals: Floats) -> tuple[float, Floats]:
    """Lower bound on ``cost x`` within rows and bounds, derived from duals; NaN or minus infinity if they prove none.

    Also returns the duals that were used, which may be far from the given ones: a caller that prices more than the rows must use these.
    Fractions among them are rounded towards 0.
    """
    arrays = _Arrays(
        cost, program.lower, program.upper, program.row_lower, program.row_upper,
        np.repeat(np.arange(program.num_rows), np.diff(program.indptr)), program.indices, program.data,
    )  # fmt: skip
    with np.errstate(over="ignore", invalid="ignore"):
        return _bound(arrays, duals)


@dataclass(frozen=True, eq=False)
class _Arrays:
    """A program to be minimised; the matrix as (row, column, value) triples."""

    cost: Floats
    lower: Floats
    upper: Floats
    row_lower: Floats
    row_upper: Floats
    row: NDArray[np.int64]
    column: NDArray[np.int32]
    value: Floats


def _bound(p: _Arrays, y: Floats) -> tuple[float, Floats]:
    y = _one_sided(p, y)
    low, high = _reduced_costs(p, y)
    lower, upper = p.lower, p.upper
    if _endless(low, high, lower, upper).any():
        lower, upper = _implied(p)
        for _ in range(_PASSES):
            wrong = np.nonzero(_endless(low, high, lower, upper))[0]
            if len(wrong) == 0:
                break
            y = _one_sided(p, _turned(p, y, wrong, low, high, lower, upper))
            low, high = _reduced_costs(p, y)
        for j in np.nonzero(_endless(low, high, lower, upper))[0]:
            exact = _exact_reduced_cost(p, y, int(j))
            low[j], high[j] = (0.0 if exact >= 0 else low[j]), (0.0 if exact <= 0 else high[j])
        if _endless(low, high, lower, upper).any():
            return _in_fractions(p, y)
    corners = [(low, lower), (low, upper), (high, lower), (high, upper)]
    least = np.minimum.reduce([_times(a, x) for a, x in corners])
    sides = np.where(y > 0, p.row_lower, np.where(y < 0, p.row_upper, 0.0))
    rows = y * sides
    error = 4 * _EPS * (float(np.abs(rows).sum()) + float(np.abs(least).sum()))
    error += _SMALLEST * float(_vanishing(y, sides).sum() + np.logical_or.reduce([_vanishing(a, x) for a, x in corners]).sum())
    if not math.isfinite(error):
        return -math.inf, y
    return math.fsum(rows) + math.fsum(least) - error, y


def _in_fractions(p: _Arrays, y: Floats) -> tuple[float, Floats]:
    """The bound in fractions, at duals near ``y`` whose reduced costs are 0 wherever they would drive a variable to infinity."""
    columns: list[list[tuple[int, Fraction]]] = [[] for _ in p.cost]
    if len(p.value) > MOST_FRACTIONS:
        return -math.inf, y
    for i, j, a in zip(p.row.tolist(), p.column.tolist(), p.value.tolist(), strict=True):
        columns[j].append((i, Fraction(a)))
    fractions = [Fraction(v) for v in y.tolist()]
    free = {j for j, (a, b) in enumerate(zip(p.lower.tolist(), p.upper.tolist(), strict=True)) if a == -math.inf and b == math.inf}
    for _ in range(_PASSES):
        duals = _moved(columns, fractions, p.cost.tolist(), sorted(free))
        if duals is None:
            return -math.inf, y
        reduced = [
            Fraction(c) - sum((a * duals[i] for i, a in entries), Fraction(0)) for c, entries in zip(p.cost.tolist(), columns, strict=True)
        ]
        ends = [*zip(reduced, p.lower.tolist(), p.upper.tolist(), strict=True)]
        wrong = {j for j, (d, low, high) in enumerate(ends) if (d > 0 and low == -math.inf) or (d < 0 and high == math.inf)}
        if not wrong:
            ends += zip(duals, p.row_lower.tolist(), p.row_upper.tolist(), strict=True)
            sides = [(d, low if d > 0 else high) for d, low, high in ends if d]
            if any(math.isinf(side) for _, side in sides):
                return -math.inf, y
            exact = sum((d * Fraction(side) for d, side in sides), Fraction(0))
            try:
                bound, taken = float(exact), np.array([_towards_zero(d) for d in duals])
            except OverflowError:
                return -math.inf, y
            return bound if bound <= exact else math.nextafter(bound, -math.inf), taken
        free |= wrong
    return -math.inf, y


def _towards_zero(number: Fraction) -> float:
    """The double nearest to a number of those that are not farther from 0."""
    rounded = float(number)
    return rounded if abs(Fraction(rounded)) <= abs(number) else math.nextafter(rounded, 0.0)


def _moved(columns: list[list[tuple[int, Fraction]]], duals: list[Fraction], cost: list[float], free: list[int]) -> list[Fraction] | None:
    """Duals near the given ones, 0 where these are, at which the columns ``free`` have no reduced cost; None if there are none."""
    rows = sorted({i for j in free for i, _ in columns[j] if duals[i]})
    system = []
    for j in free:
        entries = dict.fromkeys(rows, Fraction(0))
        rest = Fraction(cost[j])
        for i, a in columns[j]:
            rest -= a * duals[i]
            if i in entries:
                entries[i] += a
        system.append([*entries.values(), rest])
    moved, done = list(duals), 0
    pivots = []
    for _ in system:
        left = [(abs(equation[k]), k, e) for e, equation in enumerate(system[done:], start=done) for k in range(len(rows)) if equation[k]]
        if not left:
            break
        _, k, e = max(left)
        system[done], system[e] = system[e], system[done]
        pivot = system[done]
        pivot[:] = [v / pivot[k] for v in pivot]
        for other in system:
            if other is not pivot and other[k]:
                factor = other[k]
                other[:] = [v - factor * w for v, w in zip(other, pivot, strict=True)]
        pivots.append(k)
        done += 1
    if any(equation[-1] for equation in system[done:]):
        return None
    for equation, k in zip(system, pivots, strict=False):
        moved[rows[k]] += equation[-1]
    return moved


def _vanishing(a: Floats, x: Floats) -> NDArray[np.bool_]:
    """Which products of two numbers that are not 0 may have lost digits below the normal doubles: each less than ``_SMALLEST``."""
    vanishing: NDArray[np.bool_] = (a != 0) & (x != 0) & (np.abs(_times(a, x)) < _NORMAL)
    return vanishing


def _one_sided(p: _Arrays, y: Floats) -> Floats:
    """``y`` without the entries that would multiply an infinite side."""
    return np.where(((y > 0) & np.isfinite(p.row_lower)) | ((y < 0) & np.isfinite(p.row_upper)), y, 0.0)


def _reduced_costs(p: _Arrays, y: Floats) -> tuple[Floats, Floats]:
    """Limits between which the reduced costs lie for certain."""
    product = p.value * y[p.row]
    d = p.cost - np.bincount(p.column, product, minlength=len(p.cost))
    weight = np.abs(p.cost) + np.bincount(p.column, np.abs(product), minlength=len(p.cost))
    doubt = _EPS * (np.bincount(p.column, minlength=len(p.cost)) + 4) * weight
    doubt += _SMALLEST * np.bincount(p.column, _vanishing(p.value, y[p.row]), minlength=len(p.cost))
    return d - doubt, d + doubt


def _endless(low: Floats, high: Floats, lower: Floats, upper: Floats) -> NDArray[np.bool_]:
    """Variables that a reduced cost of the wrong sign, or of unknown sign, could drive to infinity."""
    endless: NDArray[np.bool_] = ((low < 0) & (upper == math.inf)) | ((high > 0) & (lower == -math.inf))
    return endless


def _turned(p: _Arrays, y: Floats, wrong: NDArray[np.int64], low: Floats, high: Floats, lower: Floats, upper: Floats) -> Floats:
    """Duals moved a little, so that the reduced costs of ``wrong`` variables point to a side that has a bound."""
    y = y.copy()
    for j in wrong.tolist():
        entries = np.nonzero((p.column == j) & (p.value != 0))[0]
        if len(entries) == 0:
            continue
        doubt, middle = high[j] - low[j], (low[j] + high[j]) / 2.0
        aim = (doubt if upper[j] == math.inf else 0.0) - (doubt if lower[j] == -math.inf else 0.0)
        k = entries[int(np.argmax(np.abs(p.value[entries] * y[p.row[entries]])))]
        y[p.row[k]] += (middle - aim) / p.value[k]
    return y


def _times(a: Floats, x: Floats) -> Floats:
    """Products in which 0 times infinity is 0."""
    return np.where(a == 0, 0.0, a * x)


def _exact_reduced_cost(p: _Arrays, y: Floats, j: int) -> Fraction:
    at = np.nonzero(p.column == j)[0]
    terms = (Fraction(float(p.value[k])) * Fraction(float(y[p.row[k]])) for k in at)
    return Fraction(float(p.cost[j])) - sum(terms, Fraction(0))


def _implied(p: _Arrays) -> tuple[Floats, Floats]:
    """Bounds of the variables where given, else bounds that single rows imply, rounded outwards."""
    lower, upper = p.lower.copy(), p.upper.copy()
    rows = len(p.row_lower)
    for _ in range(_PASSES):
        up = p.value > 0
        smallest = np.where(p.value == 0, 0.0, p.value * np.where(up, lower[p.column], upper[p.column]))
        largest = np.where(p.value == 0, 0.0, p.value * np.where(up, upper[p.column], lower[p.column]))
        ceiling = _others(p, smallest, rows, p.row_upper, 1.0)
        floor = _others(p, largest, rows, p.row_lower, -1.0)
        with np.errstate(divide="ignore"):
            above = np.where(up, ceiling / p.value, floor / p.value)
            below = np.where(up, floor / p.value, ceiling / p.value)
        above = np.where(np.isfinite(above) & (np.abs(above) < _WIDEST), above + 8 * _EPS * np.abs(above), math.inf)
        below = np.where(np.isfinite(below) & (np.abs(below) < _WIDEST), below - 8 * _EPS * np.abs(below), -math.inf)
        new_upper, new_lower = np.full(len(upper), math.inf), np.full(len(lower), -math.inf)
        np.minimum.at(new_upper, p.column, above)
        np.maximum.at(new_lower, p.column, below)
        changed = (np.isinf(upper) & np.isfinite(new_upper)) | (np.isinf(lower) & np.isfinite(new_lower))
        upper, lower = np.where(np.isinf(upper), new_upper, upper), np.where(np.isinf(lower), new_lower, lower)
        if not changed.any():
            break
    return lower, upper


def _others(p: _Arrays, extreme: Floats, rows: int, side: Floats, towards: float) -> Floats:
    """Per entry: the row's side minus the extreme activity of the row's other entries, moved outwards by its rounding error."""
    endless = ~np.isfinite(extreme)
    count = np.bincount(p.row, endless, minlength=rows)
    finite = np.where(endless, 0.0, extreme)
    total, size = np.bincount(p.row, finite, minlength=rows), np.bincount(p.row, np.abs(finite), minlength=rows)
    entries = np.bincount(p.row, minlength=rows)
    rest = side[p.row] - (total[p.row] - finite)
    rest += towards * _EPS * (entries[p.row] + 4) * (size[p.row] + np.where(np.isfinite(side), np.abs(side), 0.0)[p.row])
    return np.where(count[p.row] - endless == 0, rest, math.nan)
