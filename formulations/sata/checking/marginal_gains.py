"""Evidence ``marginal-gains``: any set of elements, over which the checker recomputes every gain.

For a monotone submodular f with f({}) = 0, any set S and any feasible set O

    f(O)  <=  f(S u O)  <=  f(S) + sum over o in O of (f(S + o) - f(S))  <=  f(S) + the best sum of gains that the constraint allows

(Nemhauser, Wolsey and Fisher 1978). Under a cardinality limit the best sum is that of the largest gains, under a partition matroid that
of the largest of each group, and for a budget it is bounded by its linear relaxation, of several budgets by the tightest. An element of
S gains nothing.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ....instances.sata.set_functions import AT_ITEM, IN_MATRIX, Floats
from ...checking.granularity import lift
from ...evidence import checker
from ...tolerance import EQUAL, room
from .decided_elements import best_of_groups, budgets, contradicted, spent, split
from .item_prices import value_grain

_EPS = float(np.finfo(np.float64).eps)
_ENTRIES = 1 << 21
"""Entries of a matrix, or flags of masks, that are looked at in one step."""


@checker("marginal-gains", "selection", "marginal gains are")
def check_marginal_gains(problem: Any, data: Mapping[str, Any]) -> float:
    """Upper bound on the value of every feasible selection that a set of elements proves.

    ``data`` holds ``prefix``: the elements of S, numbered from 0, none twice; it may be empty, and need not be feasible. The bound is minus
    infinity where decided elements leave no answer, and infinity for a function known by its values that is not declared monotone and
    submodular, or whose values contradict it. An answer may exceed a budget by the tolerance of the check, so the bound counts with that
    much more.

    Source: Nemhauser, Wolsey and Fisher (1978); docs/selection.md#bounds. Sums are rounded upwards.
    """
    n = problem.function.num_elements
    prefix = data["prefix"]
    if not isinstance(prefix, list | tuple) or any(isinstance(e, bool) or not isinstance(e, int) for e in prefix):
        raise InputError("the prefix must be a list of element numbers", found=type(prefix).__name__)
    if len(set(prefix)) != len(prefix) or any(not 0 <= e < n for e in prefix):
        raise InputError("an element of the prefix does not exist or stands twice", "unknown-name", expected=f"0 to {n - 1}")
    chosen = np.array(sorted(prefix), dtype=np.int64)
    if contradicted(problem):
        return -math.inf
    value, gains = _value_and_gains(problem.function, chosen, n)
    if math.isinf(value):
        return math.inf
    gains[chosen] = 0.0
    fixed, undecided = split(problem, gains)
    # Both parts are sums of terms of one sign, rounded correctly; each term is exact up to a few roundings of its own.
    return lift((math.fsum([value, *fixed]) + _best_sum(problem, undecided)) * (1.0 + 8 * _EPS), "max", value_grain(problem.function))


def _value_and_gains(f: Any, chosen: NDArray[np.int64], n: int) -> tuple[float, Floats]:
    weights = f.as_item_weights()  # data: each layout is added up here
    if weights is None:
        return _of_values(f, chosen, n) if f.monotone and f.submodular else (math.inf, np.zeros(n))
    best: Floats = np.zeros(weights.num_items)
    gains: Floats
    if weights.layout == IN_MATRIX:
        for e in chosen.tolist():
            best = np.maximum(best, weights.matrix[e].astype(np.float64))
        gains = np.empty(n)
        step = max(1, _ENTRIES // max(1, weights.num_items))
        for first in range(0, n, step):
            over = weights.matrix[first : first + step].astype(np.float64) - best
            gains[first : first + step] = np.maximum(over, 0.0, out=over).sum(axis=1)
        longest = weights.num_items
    else:
        counts = np.diff(weights.indptr)
        of_edge = weights.weights[weights.indices] if weights.layout == AT_ITEM else weights.weights
        inside = np.zeros(n, dtype=bool)
        inside[chosen] = True
        mine = np.repeat(inside, counts)
        np.maximum.at(best, weights.indices[mine], of_edge[mine])
        owner = np.repeat(np.arange(n), counts)
        gains = np.bincount(owner, np.maximum(of_edge - best[weights.indices], 0.0), minlength=n).astype(np.float64)
        longest = int(counts.max(initial=0))
    # A running sum of m terms of one sign is off by less than m roundings.
    return math.fsum(best), gains * (1.0 + (longest + 2) * _EPS)


def _of_values(f: Any, chosen: NDArray[np.int64], n: int) -> tuple[float, Floats]:
    """Value and gains by whole values; infinite where these contradict the declaration: a loss, or a gain over S, or of all, above that
    over nothing."""
    inside = np.zeros(n, dtype=bool)
    alone = _after_each(f, inside)
    inside[chosen] = True
    value, everything = (float(v) for v in f.values(np.stack([inside, np.ones(n, dtype=bool)])))
    after = _after_each(f, inside)
    slack = EQUAL * max(float(np.abs(after).max(initial=0.0)), abs(value), abs(everything))
    broken = (after - value > alone + slack).any() or (after < value - slack).any() or everything > alone.sum() + slack * n
    gains = np.maximum(after - value, 0.0) + _EPS * (np.abs(after) + abs(value))
    return (math.inf if broken else value), gains


def _after_each(f: Any, inside: NDArray[np.bool_]) -> Floats:
    """Values of the set with each of the elements added to it."""
    n = len(inside)
    values = np.empty(n)
    step = max(1, _ENTRIES // max(1, n))
    for first in range(0, n, step):
        masks = np.repeat(inside[None, :], min(step, n - first), axis=0)
        masks[np.arange(len(masks)), np.arange(first, first + len(masks))] = True
        values[first : first + len(masks)] = f.values(masks)
    return values


def _best_sum(problem: Any, gains: Floats) -> float:
    """Upper bound on the sum of ``gains`` over the undecided elements of an answer that passes the check."""
    groups = best_of_groups(problem, gains)
    if groups is not None:
        return math.fsum(groups)
    # All gains together bound the sum where nothing is known of the constraint.
    return min([math.fsum(gains), *(_within(costs, limit, gains, spent(problem, costs)) for costs, limit in budgets(problem) or ())])


def _within(costs: Floats, budget: float, gains: Floats, used: float) -> float:
    most = max(0.0, room(costs, budget) * (1.0 + 8 * _EPS) - used)
    with np.errstate(over="ignore"):  # in a unit in which the budget is below 1
        costs, most = (np.ldexp(v, -np.frexp(budget)[1]) for v in (costs, most))
    paid = (costs > 0) & (costs <= most)
    c, g = costs[paid], gains[paid]
    free = math.fsum(gains[costs == 0])
    if math.fsum(c) <= most:
        return free + math.fsum(g)
    # Any price of a unit of cost proves a bound; the rate at which the knapsack is full proves the best one.
    with np.errstate(over="ignore"):
        rate = g / c
    order = np.argsort(-rate, kind="stable")
    price = float(rate[order[np.argmax(np.cumsum(c[order]) >= most)]])
    if math.isinf(price):
        return math.inf
    bound: float = free + most * price
    return bound + math.fsum(np.maximum(g * (1.0 + 4 * _EPS) - price * c * (1.0 - 4 * _EPS), 0.0))
