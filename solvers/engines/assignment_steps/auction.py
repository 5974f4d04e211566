"""Bertsekas' auction with epsilon scaling, in whole numbers: assignments of the least cost, and the prices that prove it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.stop import NEVER, Stop
from .sides import Floats, Side, Wholes, joined, proof, sides

if TYPE_CHECKING:
    from ....formulations.auctions.bin_assignment import BinAssignment

FACTOR = 10
"""By which epsilon falls from phase to phase."""

START = 100
"""Epsilon of the first phase is this part of the range of the costs."""

BITS = 56
"""Of the range of the costs in whole numbers; fewer where prices grow far beyond it."""

FEWER = 8

FINEST = 900
"""Steps are no smaller than 2^-900: their number in a unit stays a double."""

FEW = 200
"""Bids a row in an auction without scaling, which is over much sooner where there are more columns than rows, or never."""

SETTLED, TRIED = 1.5, 10
"""Bids a row of a phase after which prices hardly change, so that the last one is tried at once; bids a row that it may take then."""

MANY = 1 << 62


@dataclass
class Auction:
    """What an auction ended with.

    Attributes
    ----------
    answer : tuple of int
        Bin of each robot; incomplete where it was stopped.
    complete : bool
        Whether all found their column at the least epsilon.
    bids, phases, looks : int
        Bids, phases of epsilon scaling, and rows that were looked at whole.
    epsilon : float
        The least, in the unit of the costs.
    exact : bool
        Whether the whole numbers stand for the costs exactly.
    optimal : bool
        Whether they do, and n epsilon is below the step of the costs.
    """

    answer: tuple[int, ...]
    complete: bool = True
    bids: int = 0
    phases: int = 0
    looks: int = 0
    epsilon: float = 0.0
    exact: bool = True
    optimal: bool = True
    parts: list[Side] = field(default_factory=list)
    prices: list[Floats] = field(default_factory=list)

    def evidence(self, problem: BinAssignment, source: str) -> Evidence:
        """Evidence ``assignment-prices``."""
        return proof(problem, self.parts, self.prices, self.answer, source, NEVER)


def auction(problem: BinAssignment, stop: Stop, *, epsilon: float = 0.0, factor: float = FACTOR, scaling: bool = True) -> Auction:
    """Robots bid for bins, or bins for robots, whichever are fewer.

    Parameters
    ----------
    problem : BinAssignment
    stop : Stop
    epsilon : float
        Of the last phase; 0 for one so small that the assignment is optimal for the costs as they are counted.
    factor : float
        Above 1: by which epsilon falls.
    scaling : bool
        Whether there are phases before the last one.

    Notes
    -----
    Costs are counted in whole steps, as many of them as columns and one to a unit, so that epsilon, one step, is below 1 / columns:
    then the assignment is optimal (Bertsekas 1979), and prices rounded down together, from where no remainder is the largest, prove
    that to the last digit. Where there are more columns than rows, those left over must be no dearer than any taken one: as many further
    bidders who are indifferent between all columns bid for the cheapest (Bertsekas and Castañon 1992).
    """
    parts = sides(problem)
    made = Auction((), parts=parts)
    columns = []
    for part in parts:
        column, prices = _part(part, stop, epsilon, factor, scaling, made)
        columns.append(column)
        made.prices.append(prices)
    made.answer = joined(problem, parts, columns)
    return made


def whole_costs(part: Side, bits: int, finest: bool = False) -> tuple[Wholes, float, bool]:
    """Costs from 0 in whole steps, the number of steps in a unit, and whether they are exact. Costs are multiples of columns + 1 steps.

    Whole costs are counted as they are, unless the ``finest`` steps are asked for.
    """
    low, high = float(part.cost.min(initial=0.0)), float(part.cost.max(initial=0.0))
    span, many = max(high - low, abs(high), abs(low)), part.num_columns + 1
    most = min(FINEST, bits - math.ceil(math.log2(many)) - math.frexp(span)[1])
    power = 0 if most >= 0 and not finest and bool((np.floor(part.cost) == part.cost).all()) else most
    steps = np.ldexp(part.cost, power)
    whole = np.rint(steps)
    exact = bool((np.ldexp(whole, -power) == part.cost).all())  # steps may have vanished
    counted = whole.astype(np.int64)
    counted -= counted.min(initial=np.iinfo(np.int64).max) if len(counted) else 0
    counted *= many
    return counted, math.ldexp(many, power), exact


def _part(part: Side, stop: Stop, epsilon: float, factor: float, scaling: bool, made: Auction) -> tuple[Wholes, Floats]:
    bits = BITS
    while True:
        cost, unit, exact = whole_costs(part, bits, finest=epsilon > 0.0)
        span = int(cost.max(initial=0))
        least = max(1, round(epsilon * unit) if epsilon * unit < span else span)
        ended, column, price = 3, np.zeros(0, np.int64), np.zeros(0, np.int64)
        if not scaling or part.num_columns > part.num_rows:  # rows seldom meet: prices from 0 need no repair
            ended, column, price = _phases(part, cost, stop, least, least, factor, made, FEW * part.num_rows if scaling else MANY)
        if ended == 3 and scaling:
            ended, column, price = _phases(part, cost, stop, least, max(least, span // START), factor, made, MANY)
        if ended != 2 or bits <= 4 * FEWER:
            break
        bits -= FEWER  # prices are many times the costs: count in larger steps
    whole = ended == 0
    made.complete &= whole
    made.exact &= exact
    made.optimal &= whole and exact and least * part.num_columns < unit * _step(part, unit)
    made.epsilon = max(made.epsilon, least / unit)
    if not whole:
        return column, np.zeros(part.num_columns)
    if least == 1:
        steps = part.num_columns + 1
        taken = np.zeros(steps, dtype=bool)
        taken[price % steps] = True
        price = (price + (steps - 1 - int(np.argmin(taken)))) // steps
        unit /= steps
    held = np.zeros(part.num_columns, dtype=bool)
    held[column] = True
    floor = 0 if held.all() else int(price[held].min())
    return column, np.where(held, price - floor, 0) / unit


def _step(part: Side, unit: float) -> float:
    """What all costs are multiples of where they are counted exactly."""
    return max((part.num_columns + 1) / unit, float(bool((np.floor(part.cost) == part.cost).all())))


def _phases(
    part: Side, cost: Wholes, stop: Stop, least: int, epsilon: int, factor: float, made: Auction, most: int
) -> tuple[int, Wholes, Wholes]:
    """How it ended, as kernels say it, the column of each row, and prices."""
    from . import auction_kernels as kernels

    n, m = part.num_rows, part.num_columns
    price, owner = np.zeros(m, np.int64), np.full(m, -1, np.int64)
    span, counts = int(cost.max(initial=0)), np.zeros(2, np.int64)
    lines = 0 if len(part.columns) <= kernels.MANY_PAIRS * n else kernels.LINES if part.complete else kernels.LINES_SPARSE
    memory = remembered(n, lines) if lines else None
    pairs = part.indptr, part.columns, cost, price, owner
    ended, waiting = 0, 0
    while True:
        owner[:] = -1
        made.phases += 1
        began, cap = int(counts[0]), most if not waiting else min(most, int(counts[0]) + TRIED * n)
        while True:
            limits = epsilon, span, cap
            if memory is not None:
                ended = kernels.remembering_phase(stop.flag, *pairs, *limits, memory, counts)
            else:
                ended = kernels.sparse_phase(stop.flag, *pairs, *limits, counts)
            if ended or not _outbid(price, owner, epsilon):
                break
        if waiting and ended == 3 and cap < most:  # not as settled as it seemed
            ended, epsilon, waiting = 0, waiting, 0
            continue
        if ended or epsilon <= least:
            break
        waiting, epsilon = 0, max(least, int(epsilon / factor))
        if counts[0] - began <= SETTLED * n and epsilon > least:
            waiting, epsilon = epsilon, least
    made.bids += int(counts[0])
    made.looks += int(counts[1])
    column, held = np.full(n, -1, np.int64), owner >= 0
    column[owner[held]] = np.nonzero(held)[0]
    return int(ended), column, price


def remembered(rows: int, lines: int) -> Wholes:
    """Memory of rows that never looked, shape (rows, lines, 8), for ``remembering_phase``; it begins where a processor's line does."""
    words = np.empty(8 * (rows * lines + 1), np.int64)
    first = -(words.ctypes.data // 8) % 8
    memory = words[first : first + 8 * rows * lines].reshape(rows, lines, 8)
    memory[:, 0, 0] = -1
    return memory


def _outbid(price: Wholes, owner: Wholes, epsilon: int) -> bool:
    """Whether columns that are left over were dearer than taken ones; as many of the cheapest are then taken away from rows.

    Further bidders that are indifferent between all columns hold those left over; who cannot hold a dear one bids for the cheapest of
    the others, all of them at the price of the next and epsilon.
    """
    free = owner < 0
    if not free.any():
        return False
    least = price[~free].min()
    dear = free & (price > least + epsilon)
    many = int(dear.sum())
    if not many:
        return False
    asked = np.nonzero(dear | ~free)[0]
    order = asked[np.argsort(price[asked], kind="stable")]
    taken = order[:many]
    price[taken] = price[order[many]] + epsilon
    owner[taken] = -1
    return True
