"""Bertsekas' auction with epsilon scaling, in whole numbers: assignments of the least cost, and the prices that prove it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from .....formulations.evidence import Evidence
from .....formulations.stop import NEVER, Stop
from .....instances.number_arrays import BLOCK
from .sides import Floats, Side, Wholes, joined, proof, sides

if TYPE_CHECKING:
    from .....formulations.auctions.bin_assignment import BinAssignment

FACTOR = 10
"""By which epsilon falls from phase to phase."""

START, NEAR = 100, 8
"""Epsilon of the first phase is this part of the range of the costs; a smaller one, this part of what tells a row's next pairs apart, is
tried before."""

SAMPLE = 64
"""Rows whose pairs say what that is."""

BITS = 56
"""Of the range of the costs in whole numbers; fewer where prices grow far beyond it."""

FEWER = 8

FINEST = 900
"""Steps are no smaller than 2^-900: their number in a unit stays a double."""

FEW = 200
"""Bids a row in an auction without scaling, which is over much sooner where there are more columns than rows, or never."""

SETTLED, TRIED, BEGUN = 1.5, 10, 4
"""Bids a row of a phase after which prices hardly change, so that the last one is tried at once; bids a row that it may take then, and that
a first phase may take that is tried."""

MANY = 1 << 62

_WHOLE = 1 << 52
"""Whole numbers below it, and their sums by twos, are doubles."""


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
    capped : bool
        Whether that is the range of the costs, a larger one having been asked for.
    exact : bool
        Whether the whole numbers stand for the costs exactly.
    optimal : bool
        Whether they do, and n epsilon is below the step of the costs.
    whole : bool
        Whether costs and prices are whole numbers that prove the answer to the last digit.
    """

    answer: tuple[int, ...]
    complete: bool = True
    bids: int = 0
    phases: int = 0
    looks: int = 0
    epsilon: float = 0.0
    capped: bool = False
    exact: bool = True
    optimal: bool = True
    whole: bool = False
    parts: list[Side] = field(default_factory=list)
    prices: list[Floats] = field(default_factory=list)

    def evidence(self, problem: BinAssignment, source: str) -> Evidence:
        """Evidence ``assignment-prices``."""
        return proof(problem, self.parts, self.prices, self.answer, source, NEVER, exact=self.whole and self.optimal)


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
    made.whole &= len(parts) == 1
    return made


@dataclass(frozen=True)
class Steps:
    """How costs are counted from 0 in whole steps: ``many`` times the multiple of 2^-power that is the nearest, less ``least``.

    Parameters
    ----------
    power, least, many : int
    """

    power: int
    least: int
    many: int

    @property
    def unit(self) -> float:
        """Steps in a unit."""
        return math.ldexp(self.many, self.power)

    @property
    def scale(self) -> float:
        return math.ldexp(1.0, self.power)

    def count(self, costs: Floats) -> Wholes:
        counted = np.rint(costs * self.scale).astype(np.int64)
        counted -= self.least
        counted *= self.many
        return counted

    def exact(self, part: Side) -> bool:
        """Whether all costs are counted exactly: steps may have vanished."""
        if self.power == 0 and part.spread.whole:
            return True
        back, cost = math.ldexp(1.0, -self.power), part.cost
        blocks = (cost[begin : begin + BLOCK] for begin in range(0, len(cost), BLOCK))
        return all(bool((np.rint(some * self.scale) * back == some).all()) for some in blocks)


def steps_of(part: Side, bits: int, finest: bool = False) -> Steps:
    """Whole costs are counted as they are, others, and if they are asked for, in the ``finest`` steps that ``bits`` are enough for."""
    low, high, whole = part.spread
    span, many = max(high - low, abs(high), abs(low)), part.num_columns + 1
    most = min(FINEST, bits - math.ceil(math.log2(many)) - math.frexp(span)[1])
    power = 0 if most >= 0 and not finest and whole else most
    return Steps(power, int(np.rint(low * math.ldexp(1.0, power))), many)


def whole_costs(part: Side, bits: int, finest: bool = False) -> tuple[Wholes, float, bool]:
    """Costs from 0 in whole steps, the number of steps in a unit, and whether they are exact. Costs are multiples of columns + 1 steps.

    Whole costs are counted as they are, unless the ``finest`` steps are asked for.
    """
    steps = steps_of(part, bits, finest)
    return _counted(part, steps), steps.unit, steps.exact(part)


def _counted(part: Side, steps: Steps) -> Wholes:
    counted = np.empty(len(part.cost), dtype=np.int64)
    for begin in range(0, len(counted), BLOCK):
        counted[begin : begin + BLOCK] = steps.count(part.cost[begin : begin + BLOCK])
    return counted


def _part(part: Side, stop: Stop, epsilon: float, factor: float, scaling: bool, made: Auction) -> tuple[Wholes, Floats]:
    bits = BITS
    while True:
        cost = _Costs(part, steps_of(part, bits, finest=epsilon > 0.0))
        unit, span = cost.steps.unit, cost.span
        capped = epsilon * unit > span
        least = max(1, span if capped else round(epsilon * unit))
        ended, column, price = 3, np.zeros(0, np.int64), np.zeros(0, np.int64)
        if not scaling or part.num_columns > part.num_rows:  # rows seldom meet: prices from 0 need no repair
            ended, column, price = _phases(part, cost, stop, least, least, factor, made, FEW * part.num_rows if scaling else MANY)
        if ended == 3 and scaling:
            tried = max(least, _apart(part, cost.steps) // NEAR)
            ended, column, price = _phases(part, cost, stop, least, max(least, span // START), factor, made, MANY, tried)
        if ended != 2 or bits <= 4 * FEWER:
            break
        bits -= FEWER  # prices are many times the costs: count in larger steps
    whole, exact = ended == 0, cost.steps.exact(part)
    made.complete &= whole
    made.exact &= exact
    made.whole = part.complete and part.spread.whole and cost.steps.power == 0 and least == 1 and int(price.max(initial=0)) + span < _WHOLE
    made.optimal &= whole and exact and least * part.num_columns < unit * _step(part, unit)
    if least / unit > made.epsilon:
        made.epsilon, made.capped = least / unit, capped
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
    return max((part.num_columns + 1) / unit, float(part.spread.whole))


class _Costs:
    """Costs in whole steps, of all pairs or counted while they are looked at; and the largest."""

    def __init__(self, part: Side, steps: Steps) -> None:
        from . import auction_kernels as kernels

        self.steps = steps
        self.span = int(steps.count(np.array([part.spread.largest]))[0]) if len(part.cost) else 0
        lines = kernels.LINES if part.complete else kernels.LINES_SPARSE
        self.lines = 0 if len(part.cost) <= kernels.MANY_PAIRS * part.num_rows else lines
        uncounted = part.complete and self.lines > 0 and part.num_columns > kernels.LINE * kernels.LINES
        self.columns = np.zeros(0, np.int32) if uncounted else part.columns
        self.counted = np.zeros(0, np.int64) if uncounted else _counted(part, steps)
        size = max(abs(part.spread.least), abs(part.spread.largest)) * steps.scale * steps.many
        slack = size * kernels.ROUNDING + (1.0 if steps.power == 0 and part.spread.whole else 1.0 + 0.5 * steps.many)
        self.real = part.cost if uncounted else np.zeros(0), steps.scale, steps.least, steps.many, slack


def _apart(part: Side, steps: Steps) -> int:
    """By how much the dearest of the pairs that a row remembers is dearer than its cheapest one: the median of a sample of rows."""
    from .auction_kernels import LINE, LINES

    found = []
    for row in np.unique(np.linspace(0, part.num_rows - 1, min(SAMPLE, part.num_rows)).astype(np.int64)).tolist():
        own = steps.count(part.cost[part.indptr[row] : part.indptr[row + 1]])
        near = np.partition(own, min(LINE * LINES, len(own) - 1))[: LINE * LINES + 1]
        found.append(int(near.max() - near.min()))
    return sorted(found)[len(found) // 2]


def _phases(
    part: Side, cost: _Costs, stop: Stop, least: int, epsilon: int, factor: float, made: Auction, most: int, tried: int = MANY
) -> tuple[int, Wholes, Wholes]:
    """How it ended, as kernels say it, the column of each row, and prices; ``tried`` is an epsilon to begin with if few bids do."""
    from . import auction_kernels as kernels

    n, m = part.num_rows, part.num_columns
    price, owner = np.zeros(m, np.int64), np.full(m, -1, np.int64)
    counts = np.zeros(2, np.int64)
    memory = remembered(n, cost.lines) if cost.lines else None
    pairs = part.indptr, cost.columns, cost.counted
    ended, waiting, patience = 0, 0, BEGUN * n
    if tried < epsilon:
        epsilon, waiting = tried, epsilon
    while True:
        owner[:] = -1
        made.phases += 1
        began, cap = int(counts[0]), most if not waiting else min(most, int(counts[0]) + patience)
        while True:
            bids = price, owner, epsilon, cost.span, cap
            if memory is not None:
                ended = kernels.remembering_phase(stop.flag, *pairs, *cost.real, *bids, memory, counts)
            else:
                ended = kernels.sparse_phase(stop.flag, *pairs, *bids, counts)
            if ended or not _outbid(price, owner, epsilon):
                break
        if waiting and ended == 3 and cap < most:  # not as settled as it seemed
            ended, epsilon, waiting = 0, waiting, 0
            continue
        if ended or epsilon <= least:
            break
        waiting, patience, epsilon = 0, TRIED * n, max(least, int(epsilon / factor))
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
