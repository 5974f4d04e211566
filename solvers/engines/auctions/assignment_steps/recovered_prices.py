"""Prices that prove an assignment optimal, for methods that find none."""

import numpy as np

from .....formulations.auctions.bin_assignment import BinAssignment
from .....formulations.evidence import Evidence
from .....formulations.stop import Stop
from .auction import whole_costs
from .sides import Floats, Side, Wholes, proof, sides, split

BITS = 56
"""Bits of the range of costs in whole numbers."""

UNREACHED = 1 << 60

FEW_PAIRS = 20_000
"""Pairs up to which no compiled loop is loaded."""

SWEEPS = 1000
"""Sweeps after which rounded costs are taken for a cycle that no sweep ends."""


def recovered_prices(problem: BinAssignment, answer: tuple[int, ...], source: str, stop: Stop) -> Evidence:
    """Evidence ``assignment-prices`` by shortest paths from the free columns, over pairs alternately out of and in the assignment.

    Where the answer is not optimal, or the search is stopped, the evidence proves less than its costs. Prices of columns that no such path
    reaches rise together until the others are no dearer for them. Source: Ahuja, Magnanti and Orlin (1993), Network Flows, section 9.5.
    """
    parts = sides(problem)
    prices = [_prices(part, column, stop) for part, column in zip(parts, split(problem, parts, answer), strict=True)]
    return proof(problem, parts, prices, answer, source, stop)


def _lower(part: Side, cost: Wholes, column: Wholes, price: Wholes, stop: Stop) -> None:
    """``lower_labels``, compiled for many pairs, else all rows at once."""
    if len(cost) > FEW_PAIRS:
        from .price_kernels import lower_labels

        lower_labels(stop.flag, part.indptr, part.columns, cost, column.astype(np.int64), price, SWEEPS)
        return
    paid = cost[part.columns == np.repeat(column, np.diff(part.indptr))]
    for _ in range(SWEEPS):
        lowered = np.minimum(price[column], np.minimum.reduceat(cost + price[part.columns], part.indptr[:-1]) - paid)
        if stop.reached() or (lowered == price[column]).all():
            return
        price[column] = lowered


def _prices(part: Side, column: Wholes, stop: Stop) -> Floats:
    cost, unit, _ = whole_costs(part, BITS)
    steps = part.num_columns + 1
    cost, unit = cost // steps, unit / steps
    held = np.zeros(part.num_columns, dtype=bool)
    held[column] = True
    price = np.where(held, UNREACHED if not held.all() else 0, 0).astype(np.int64)
    _lower(part, cost, column, price, stop)
    far = held & (price > UNREACHED // 2) if not held.all() else held
    if far.any():
        price[far] -= price[far].min()
        rows = np.repeat(np.arange(part.num_rows), np.diff(part.indptr))
        own = column[rows]
        crossing = far[part.columns] & ~far[own]
        if crossing.any():
            paid = np.zeros(part.num_rows, dtype=np.int64)
            at = part.columns == own
            paid[rows[at]] = cost[at]
            short = price[own] + paid[rows] - cost - price[part.columns]
            price[far] += max(0, int(short[crossing].max()))
    return np.maximum(price, 0) / unit
