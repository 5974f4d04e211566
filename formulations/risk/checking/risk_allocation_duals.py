"""Evidence ``risk-allocation-duals``: prices of the rows, chance rows and budgets of a risk allocation, multiplied out.

For any prices y of the rows, q >= 0 of the chance rows, v >= 0 of the budgets, and vectors that the convex terms and cones allow, every
decision x costs at least

    min over x in rows and bounds of (c + q a - ...) x  -  q b  +  sum_i least over z >= z_i of (q_i s_i z + v_i tail(z))  -  v budgets

where s_i is the deviation of row i, v_i the sum of the prices of its budgets, tail(z) the probability of a normal number above z, and
z_i >= 0 has tail(z_i) = the most risk that the constraint can have. No quantile is needed: the least of the convex function of z lies where
``q_i s_i = v_i density(z)``, and between two points at which its slope has different signs, beyond the rounding of either, it is at least
the one part at the lower and the other at the upper of these. The tail is ``erfc``, counted as wrong by ``TAIL_ERROR`` of itself.
"""

import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from ....instances.number_arrays import Flags, Floats
from ...checking.evidence_numbers import numbers
from ...checking.row_duals import least_value
from ...evidence import checker

TAIL_ERROR = 1e-13
"""Relative, of the tail and the density as computed here: 450 roundings, where glibc's erfc is within 2 and the exponent within 400."""

_EPS = float(np.finfo(np.float64).eps)
_LARGEST_Z = 38.0
_FARTHEST = 40
"""Times that the distance between the two points is doubled at most before the least is taken to be that of either part alone."""


@checker("risk-allocation-duals", "risk-allocation", "prices of chance constraints are", of="risk allocation")
def check_risk_allocation_duals(problem: Any, data: Mapping[str, Any]) -> float:
    """Bound on the cost of a risk allocation that any prices prove (weak duality).

    ``rows``: one number each, positive where the lower side counts. ``chance``: one a chance row, ``budgets``: one a budget; negative
    ones count as 0, and those of alternatives, of which any suffices. ``terms``: one a row of the convex terms. ``cones``: of each
    cone one for its limit and one a row. ``infeasible``, true: the cost counts as 0, and prices of a positive value prove that there
    is no answer. Where risk is ``joint``, budgets have no price: no constraint may have more risk than all of its budgets.

    The bound is minus infinity (``min``) or infinity (``max``) where nothing is proved, and the other one where it is proved that there is
    no answer. Raises InputError for a list that is missing, has another length, or holds anything but finite numbers. Source: Lagrangian
    duality; docs/formulations/risk-allocation.md#the-bound. Sums are rounded to the safe side by ``lp-dual``'s rules.
    """
    sizes = {
        "rows": len(problem.row_lower), "chance": len(problem.limits), "budgets": len(problem.budgets),
        "terms": sum(len(t[3]) for t in problem.terms), "cones": sum(1 + len(c[1]) for c in problem.cones),
    }  # fmt: skip
    rows, chance, budgets, terms, cones = (numbers(data, key, size) for key, size in sizes.items())
    infeasible = data.get("infeasible") is True
    alternatives = np.bincount(problem.constraint, weights=problem.open, minlength=len(problem.names))
    if (alternatives == 0.0).any():
        return float(problem.sign * math.inf)
    single = problem.open & (alternatives[problem.constraint] == 1.0)
    chance = np.where(single, np.maximum(chance, 0.0), 0.0)
    budgets = np.maximum(budgets, 0.0) if problem.risk.kind == "allocated" else np.zeros(len(budgets))
    terms, constant = _allowed_terms(problem, np.zeros(len(terms)) if infeasible else terms)
    cones = _allowed_cones(problem, cones)
    program = _program(problem, single)
    # Definitions p = F x + f carry the same number as price and as cost of p, so that their reduced costs are 0 exactly.
    cost = np.concatenate([np.zeros(len(problem.linear)) if infeasible else problem.sign * problem.linear, terms, -cones])
    with np.errstate(over="ignore", invalid="ignore"):
        least, duals = least_value(program, cost, np.concatenate([rows, -chance, terms, -cones]))
        chance = np.maximum(-duals[len(rows) : len(rows) + len(chance)], 0.0)  # it may have moved them: the margins cost what the rows do
        parts = [least, constant]
        parts += _least_margins(problem, chance, budgets)
        spent = [-price * budget.risk for price, budget in zip(budgets.tolist(), problem.budgets, strict=True)]
        parts += spent
        rounding = 8.0 * _EPS * math.fsum(map(abs, spent))
    if not all(map(math.isfinite, parts)):
        return float(-problem.sign * math.inf)
    if not infeasible:
        parts.append(problem.sign * problem.offset)
    bound = math.fsum([*parts, -rounding])
    bound -= 4.0 * _EPS * abs(bound)
    if infeasible:
        size = max(map(abs, parts))
        return float(problem.sign * (math.inf if bound > 1e-9 * size > 0.0 else -math.inf))
    return float(problem.sign * bound)


def _allowed_terms(problem: Any, prices: Floats) -> tuple[Floats, float]:
    """Vectors v with ``term(r) >= v r + constant``: the given ones, cut to what the weights allow; and the sum of the constants."""
    allowed, constants, start = prices.copy(), [], 0
    for kind, weight, _, constant in problem.terms:
        part = slice(start, start + len(constant))
        start = part.stop
        if kind == "absolute":
            allowed[part] = np.clip(allowed[part], -weight, weight)
        elif kind == "norm":
            allowed[part] = _shortened(allowed[part], weight)
        elif weight > 0.0:
            square = math.fsum((allowed[part] ** 2).tolist()) / (4.0 * weight)
            constants.append(-square * (1.0 + 8.0 * _EPS))
        else:
            allowed[part] = 0.0
    return allowed, math.fsum(constants)


def _allowed_cones(problem: Any, prices: Floats) -> Floats:
    """Numbers (t, v) with t >= |v|, cone after cone."""
    allowed, start = prices.copy(), 0
    for _, constant, _, _ in problem.cones:
        part = slice(start + 1, start + 1 + len(constant))
        allowed[start] = max(allowed[start], 0.0)
        allowed[part] = _shortened(allowed[part], float(allowed[start]))
        start = part.stop
    return allowed


def _shortened(vector: Floats, length: float) -> Floats:
    own = float(np.linalg.norm(vector)) * (1.0 + (len(vector) + 4) * _EPS)
    return vector if own <= length else vector * (length / own * (1.0 - 4.0 * _EPS))


def _program(problem: Any, single: Flags) -> Any:
    """Rows and bounds of x, chance rows without margins, definitions of the rows of terms and cones: the arrays of a linear program."""
    n, defined = len(problem.linear), [(t[2], t[3]) for t in problem.terms]
    for matrix, constant, limit, most in problem.cones:
        defined += [(limit[None], np.array([most])), (matrix, constant)]
    extra = sum(len(constant) for _, constant in defined)
    known = len(problem.row_lower) + len(problem.limits)
    matrix = np.zeros((known + extra, n + extra))
    matrix[:known, :n] = np.concatenate([problem.rows, problem.chance])
    constants = np.concatenate([np.zeros(0), *(constant for _, constant in defined)])
    if extra:
        matrix[known:, :n] = -np.concatenate([part for part, _ in defined])
        matrix[known:, n:] = np.eye(extra)
    row, column = np.nonzero(matrix)
    free = np.full(extra, math.inf)
    least = -free
    start = sum(len(t[3]) for t in problem.terms)
    for _, constant, _, _ in problem.cones:
        least[start] = 0.0  # the limit of a norm
        start += 1 + len(constant)
    return SimpleNamespace(
        lower=np.concatenate([problem.lower, least]), upper=np.concatenate([problem.upper, free]),
        row_lower=np.concatenate([problem.row_lower, np.full(len(problem.limits), -math.inf), constants]),
        row_upper=np.concatenate([problem.row_upper, np.where(single, problem.limits, math.inf), constants]),
        num_rows=known + extra, indptr=np.concatenate([[0], np.cumsum(np.bincount(row, minlength=known + extra))]), indices=column,
        data=matrix[row, column],
    )  # fmt: skip


# -- the normal tail, by erfc --------------------------------------------------------------------------------------------


def tail(z: float) -> float:
    """Probability of a normal number above z >= 0, within ``TAIL_ERROR`` of it."""
    return 0.5 * math.erfc(z * math.sqrt(0.5))


def density(z: float) -> float:
    """Normal density at z >= 0, within ``TAIL_ERROR`` of it."""
    return math.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi)


def least_quantile(risk: float) -> float:
    """Lower bound on the standard normal quantile that is exceeded with probability ``risk``, tight but for rounding."""
    if risk >= 0.5:
        return 0.0
    low, high = 0.0, _LARGEST_Z
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if tail(middle) * (1.0 - TAIL_ERROR) >= risk else (low, middle)
    return low


def _least_margins(problem: Any, chance: Floats, budgets: Floats) -> list[float]:
    """Lower bounds, one for each priced chance row, on ``chance * deviation * z + price * tail(z)`` over the z that its risk allows."""
    price = np.zeros(len(problem.names))
    for budget, own in zip(problem.budgets, budgets.tolist(), strict=True):
        price[budget.constraints] += own
    margins, floors = [], {}
    for k in np.nonzero((chance > 0.0) & (problem.deviation > 0.0))[0].tolist():
        constraint = int(problem.constraint[k])
        cap = float(problem.caps[constraint])
        if cap not in floors:
            floors[cap] = least_quantile(cap)
        slope = float(chance[k] * problem.deviation[k]) * (1.0 - 4.0 * _EPS)
        margins.append(_least_margin(slope, float(price[constraint]) * (1.0 - len(budgets) * _EPS), floors[cap]))
    return margins


def _least_margin(slope: float, price: float, floor: float) -> float:
    """Lower bound on ``slope z + price tail(z)`` over z >= floor."""
    if price <= 0.0 or slope >= price * density(floor) * (1.0 + 4.0 * TAIL_ERROR):  # rising from the floor on
        return (slope * floor + price * tail(floor) * (1.0 - TAIL_ERROR)) * (1.0 - 8.0 * _EPS)
    ratio = slope / price * math.sqrt(2.0 * math.pi)
    middle = math.sqrt(max(0.0, -2.0 * math.log(ratio))) if ratio > 0.0 else _LARGEST_Z
    width = 1e-12 * (1.0 + middle)
    for _ in range(_FARTHEST):
        low, high = max(floor, middle - width), max(floor, middle) + width
        falls = low <= floor or slope <= price * density(low) * (1.0 - 4.0 * TAIL_ERROR)
        if falls and slope >= price * density(high) * (1.0 + 4.0 * TAIL_ERROR):
            return (slope * low + price * tail(high) * (1.0 - TAIL_ERROR)) * (1.0 - 8.0 * _EPS)
        width *= 2.0
    return slope * floor * (1.0 - 8.0 * _EPS)
