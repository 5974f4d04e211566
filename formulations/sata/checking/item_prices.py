"""Evidence ``item-prices``: one price per item, multiplied out against the elements.

For prices p >= 0 of the items and any set S of elements, each item is worth its price and what the best element gives beyond it::

    f(S) = sum_j max_{e in S} c_ej  <=  sum_j p_j + sum_{e in S} sum_j max(0, c_ej - p_j)

and the last sum is at most that of the best set that the constraint allows, elements now counting each for itself: the k best, the
best of each group, or under a budget the best by worth for cost with the last one in part (of several budgets, and any sum of them,
the tightest).
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.sata.set_functions import AT_ITEM, IN_MATRIX, Floats
from ...checking.evidence_numbers import numbers
from ...checking.granularity import Grain, grain, lift
from ...evidence import CHECKERS
from ...tolerance import room
from .decided_elements import best_of_groups, budgets, contradicted, spent, split

_EPS = float(np.finfo(np.float64).eps)
_TINY = 5e-324
_STRIP = 2**22
"""Entries of a full matrix that are looked at in one go."""


@CHECKERS.register("item-prices")
def check_item_prices(problem: Any, data: Mapping[str, Any]) -> float:
    """Upper bound on a coverage or facility-location problem that any prices of its items prove.

    ``data`` holds ``prices``, one number per item, of which negative ones count as 0, and under several budgets possibly ``multipliers``,
    one number per row, for a budget that they make of all. The bound is infinite where the sums overflow, and minus infinity where decided
    elements leave no answer. All sums are of nonnegative terms, and are rounded upwards.

    Source: linear programming duality for the facility-location problem (Cornuéjols, Fisher, Nemhauser 1977);
    docs/formulations/winner-takes-all.md#item-prices.
    """
    weights = problem.function.as_item_weights() if problem.family == "selection" else None  # data: each layout is added up here
    if weights is None:
        raise InputError("prices of items are evidence for coverage and facility-location problems", "foreign", found=problem.problem)
    p = np.maximum(numbers(data, "prices", weights.num_items), 0.0)
    if contradicted(problem):
        return -math.inf
    with np.errstate(over="ignore", invalid="ignore"):
        worth, longest = _worths(weights, p, problem.num_elements)
        fixed, undecided = split(problem, worth)
        parts = np.concatenate([fixed, _best(problem, undecided, data)])
        if not (np.isfinite(worth).all() and np.isfinite(parts).all()):
            return math.inf
        try:
            total = math.fsum(p) + math.fsum(parts)
        except OverflowError:
            return math.inf
        return lift(total * (1.0 + (longest + 16) * _EPS) + (_TINY if total > 0 else 0.0), "max", value_grain(problem.function))


def _worths(weights: Any, p: Floats, n: int) -> tuple[Floats, int]:
    """Worth of each element beyond the prices, and the number of terms in the longest of these sums."""
    if weights.layout == IN_MATRIX:
        parts = [np.maximum(strip - p, 0.0).sum(axis=1) for strip in _strips(weights.matrix)]
        return np.concatenate([np.zeros(0), *parts]), weights.num_items
    counts = np.diff(weights.indptr)
    element = np.repeat(np.arange(n), counts)
    of_edge = weights.weights[weights.indices] if weights.layout == AT_ITEM else weights.weights
    beyond = np.maximum(of_edge - p[weights.indices], 0.0)
    return np.bincount(element, beyond, minlength=n).astype(np.float64), int(counts.max(initial=0))


def _strips(matrix: Any) -> Iterator[Floats]:
    """Blocks of rows in full precision, one after the other."""
    step = max(1, _STRIP // max(1, matrix.shape[1]))
    for first in range(0, matrix.shape[0], step):
        yield matrix[first : first + step].astype(np.float64)


def _best(problem: Any, worth: Floats, data: Mapping[str, Any]) -> Floats:
    """Terms whose sum no set of undecided elements exceeds that is allowed beside the taken ones; all terms where nothing is known of
    the constraint."""
    groups = best_of_groups(problem, worth)
    if groups is not None:
        return groups
    rows = budgets(problem)
    if rows is None:
        return worth
    if "multipliers" in data:  # what the rows allow, so does their sum, each times a number >= 0
        y = np.maximum(numbers(data, "multipliers", len(rows)), 0.0)
        total = math.fsum(factor * room(costs, limit) for factor, (costs, limit) in zip(y, rows, strict=True))
        together = sum((factor * costs for factor, (costs, _) in zip(y, rows, strict=True)), np.zeros(len(worth)))
        rows.append((together, total * (1.0 + (len(rows) + 4) * _EPS)))
    return min([worth, *(_fractional_knapsack(costs, limit, worth, spent(problem, costs)) for costs, limit in rows)], key=np.sum)


def _fractional_knapsack(costs: Floats, budget: float, worth: Floats, used: float) -> Floats:
    """The terms, for a rate q >= 0 of worth for cost, of q budget and the worth of the elements beyond q times their cost.

    The best q is the ratio at which the budget runs out; no other needs to be right for the bound to hold.
    """
    most = max(0.0, room(costs, budget) * (1.0 + 4 * _EPS) - used)  # evaluate lets that much pass
    with np.errstate(over="ignore", under="ignore"):  # in a unit in which the budget is below 1
        costs, most = (np.ldexp(v, -np.frexp(budget)[1]) for v in (costs, most))
    fits = costs <= most
    costs, worth = costs[fits], worth[fits]
    paid = (costs > 0) & (worth > 0)
    rate = worth[paid] / costs[paid]
    order = np.argsort(-rate, kind="stable")
    at = int(np.searchsorted(np.cumsum(costs[paid][order]), most, side="right"))
    q = float(rate[order][at]) if at < len(rate) else 0.0
    if not math.isfinite(q):
        q = 0.0
    # The rounding of the product, in the direction that leaves more.
    return np.append(np.maximum(worth - q * costs * (1.0 - 2 * _EPS), 0.0), q * most)


def value_grain(function: Any) -> Grain | None:
    """The number of which every value of a function with weights at items or entries is a multiple; None for full matrices and other
    functions."""
    weights = function.as_item_weights()
    return None if weights is None or weights.layout == IN_MATRIX else grain(weights.weights)
