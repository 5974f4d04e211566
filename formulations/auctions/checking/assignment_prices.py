"""Evidence ``assignment-prices``: prices of bins, and a level of what a pair may cost, that bound the sum of an assignment's costs.

With prices p, and K pairs asked for, n robots and m bins, every assignment of K pairs costs at least

    sum_i min_j (c_ij + p_j) - sum_j p_j                                      where K = n
    K s - sum_j p_j - sum_i max(0, max_j (s - p_j - c_ij))                    for any level s

since it pays at most the prices of all bins. Prices are at least 0, unless K = m: then each is paid, and prices are free.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ....instances.number_arrays import Floats
from ...evidence import checker
from .job_prices import LARGEST, is_finite

BLOCK = 1 << 17
"""Pairs that are looked at together: few enough to stay in a processor's cache."""

_WHOLE = 2.0**53
"""Whole numbers below it are doubles."""


@checker("assignment-prices", "bin-assignment", "prices of bins are")
def check_assignment_prices(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound on the sum of the costs that any prices prove; sums are rounded down, so that it holds at any scale of the data.

    ``data`` holds ``prices``, one number a bin (negative ones count as 0 unless every bin is asked for), and ``level``, 0 by default, which
    is not needed where every robot is asked for.

    Source: linear programming duality (Kuhn 1955; Bertsekas 1981); docs/formulations/bin-assignment.md#evidence.
    """
    if problem.objective != "sum":
        return -math.inf
    listed, level = data.get("prices"), data.get("level", 0.0)
    if not isinstance(listed, list) or len(listed) != problem.num_bins or not _all_finite(listed) or not is_finite(level):
        raise InputError("evidence needs a list of prices, one finite number a bin", expected=str(problem.num_bins))
    prices, asked = np.array(listed, dtype=np.float64), problem.pairs
    if asked != problem.num_bins:
        prices = np.maximum(prices, 0.0)
    if problem.complete:
        least = _least_of_all(problem.matrix(), prices, problem.spread.whole and bool((np.floor(prices) == prices).all()))
    else:
        least = _least_to_pay(problem.indptr, problem.bins, problem.cost, prices)
    if asked == problem.num_robots:
        return math.inf if np.isinf(least).any() else _sum_below([*least.tolist(), *(-prices).tolist()])
    served = least[least < level].tolist()
    levels = [math.copysign(level, (asked - len(served)) * level)] * abs(asked - len(served))
    return _sum_below([*levels, *served, *(-prices).tolist()])


def _all_finite(values: list[object]) -> bool:
    if set(map(type, values)) <= {float}:
        return bool((np.abs(np.array(values, dtype=np.float64)) < LARGEST).all())
    return all(map(is_finite, values))


def _sum_below(terms: list[float]) -> float:
    """The largest double that is no more than the exact sum."""
    try:
        total = math.fsum(terms)
    except OverflowError:
        return -math.inf
    return math.nextafter(total, -math.inf) if math.fsum([*terms, -total]) < 0.0 else total


def _least_of_all(costs: Floats, prices: Floats, whole: bool) -> Floats:
    """``_least_to_pay`` where every robot has all bins; sums of whole numbers, if they are small enough, are exact."""
    many = max(1, BLOCK // (4 * len(prices)))
    least, paid, near = np.empty(len(costs)), np.empty((many, len(prices))), np.empty((many, len(prices)), dtype=bool)
    for first in range(0, len(costs), many):
        own = costs[first : first + many]
        sums = np.add(own, prices, out=paid[: len(own)])
        lowest = sums.min(axis=1)
        if not whole or (np.abs(lowest) >= _WHOLE).any():
            above = np.nextafter(lowest, math.inf)[:, None]
            close = np.less_equal(sums, above, out=near[: len(own)])  # what is dearer is no less, exactly summed
            row, column = np.divmod(np.flatnonzero(close), len(prices))
            below = row[_lost(own[row, column], prices[column], sums[row, column]) < 0.0]
            lowest[below] = np.nextafter(lowest[below], -math.inf)
        least[first : first + many] = lowest
    return least


def _lost(a: Floats, b: Floats, total: Floats) -> Floats:
    """a + b - total, exactly, where ``total`` is the rounded sum (Knuth 1969)."""
    part = total - a
    return (a - (total - part)) + (b - part)


def _least_to_pay(indptr: NDArray[Any], bins: NDArray[Any], cost: Floats, prices: Floats) -> Floats:
    """A lower bound on min_j (c_ij + p_j) of each robot, equal to it where the sum is a double; infinite for robots without a pair."""
    least = np.full(len(indptr) - 1, math.inf)
    first = 0
    while first < len(least):
        last = max(first + 1, int(np.searchsorted(indptr, indptr[first] + BLOCK, side="right")) - 1)
        begin, end = int(indptr[first]), int(indptr[last])
        many = np.diff(indptr[first : last + 1])
        whole = (many == len(prices)).all()  # bins ascend, so that these are all
        price = np.tile(prices, last - first) if whole else prices.take(bins[begin:end])
        paid = cost[begin:end] + price
        own = np.nonzero(many > 0)[0]
        if len(own):
            starts = indptr[first + own] - begin
            sums = np.minimum.reduceat(paid, starts)
            near = np.nonzero(paid <= np.repeat(np.nextafter(sums, math.inf), many[own]))[0]  # what is dearer is no less, exactly summed
            lost = _lost(cost[begin:end][near], price[near], paid[near])
            below = np.zeros(len(own), dtype=bool)
            below[np.searchsorted(starts, near[lost < 0.0], side="right") - 1] = True
            least[first + own] = np.where(below, np.nextafter(sums, -math.inf), sums)
        first = last
    return least
