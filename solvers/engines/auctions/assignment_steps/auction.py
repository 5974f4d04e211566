"""Bertsekas' auction with epsilon scaling, in whole numbers: assignments of the least cost, and the prices that prove it."""

import math
from dataclasses import dataclass, field

import numpy as np

from .....formulations.auctions.bin_assignment import BinAssignment
from .....formulations.evidence import Evidence
from .....formulations.stop import NEVER, Stop
from .....instances.number_arrays import BLOCK
from .sides import Floats, Side, Wholes, joined, proof, sides

FACTOR = 10
"""Factor by which epsilon falls from phase to phase."""

START, NEAR = 100, 8
"""Epsilon of the first phase as a share of the range of costs; before it a smaller one is tried, a share of what tells a row's next pairs
apart."""

SAMPLE = 64
"""Rows whose pairs are looked at to find that difference."""

BITS = 56
"""Bits of the range of costs in whole numbers; fewer where prices grow far beyond it."""

FEWER = 8

FINEST = 900
"""Steps are no smaller than 2^-900, so that their number in a unit is a double."""

FEW = 200
"""Bids a row in an auction without scaling, which ends much sooner than this where there are more columns than rows, or never."""

SETTLED, TRIED, BEGUN = 1.5, 10, 4
"""Bids a row of a phase after which prices hardly change, so that the last phase is tried at once; bids a row allowed to that one, and to a
first phase that is tried."""

MANY = 1 << 62

_WHOLE = 1 << 52
"""Whole numbers below it, and sums of two of them, are doubles."""


@dataclass
class Auction:
    """The outcome of an auction; the answer is incomplete where it was stopped.

    ``complete`` says whether all rows found a column at the least ``epsilon``, which is in the unit of the costs, and ``capped`` whether
    that is the range of the costs though a larger one was asked for. ``exact`` says that the whole numbers stand for the costs exactly,
    ``optimal`` also that n epsilon is below the step of the costs, and ``whole`` that costs and prices are whole numbers which prove the
    answer to the last digit. ``looks`` counts rows that were looked at whole.
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
        return proof(problem, self.parts, self.prices, self.answer, source, NEVER, exact=self.whole and self.optimal)


def auction(problem: BinAssignment, stop: Stop, *, epsilon: float = 0.0, factor: float = FACTOR, scaling: bool = True) -> Auction:
    """Robots bid for bins, or bins for robots, whichever are fewer.

    ``epsilon`` is that of the last phase, 0 for one so small that the assignment is optimal for the costs as they are counted; it falls by
    ``factor`` > 1, in phases if ``scaling`` is asked for.

    Costs are counted in whole steps, columns + 1 to a unit, so that epsilon, one step, is below 1 / columns: then the assignment is optimal
    (Bertsekas 1979), and prices rounded down together, from where no remainder is the largest, prove that to the last digit. Where there
    are more columns than rows, free columns must be no dearer than any taken one: as many further bidders who are indifferent between all
    columns bid for the cheapest (Bertsekas and Castañon 1992).
    """
    parts = sides(problem)
    ended = Auction((), parts=parts)
    columns = []
    for part in parts:
        column, prices = _part(part, stop, epsilon, factor, scaling, ended)
        columns.append(column)
        ended.prices.append(prices)
    ended.answer = joined(problem, parts, columns)
    ended.whole &= len(parts) == 1
    return ended


@dataclass(frozen=True)
class Steps:
    """How costs are counted from 0 in whole steps: ``many`` times the nearest multiple of 2^-power, less ``least``."""

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
    """Steps for the costs of a side: whole costs as they are, others, or if asked for, in the ``finest`` steps that ``bits`` allow."""
    low, high, whole = part.spread
    span, many = max(high - low, abs(high), abs(low)), part.num_columns + 1
    most = min(FINEST, bits - math.ceil(math.log2(many)) - math.frexp(span)[1])
    power = 0 if most >= 0 and not finest and whole else most
    return Steps(power, int(np.rint(low * math.ldexp(1.0, power))), many)


def whole_costs(part: Side, bits: int, finest: bool = False) -> tuple[Wholes, float, bool]:
    """Costs from 0 in whole steps, multiples of columns + 1; the number of steps in a unit; and whether they are exact."""
    steps = steps_of(part, bits, finest)
    return _counted(part, steps), steps.unit, steps.exact(part)


def _counted(part: Side, steps: Steps) -> Wholes:
    counted = np.empty(len(part.cost), dtype=np.int64)
    for begin in range(0, len(counted), BLOCK):
        counted[begin : begin + BLOCK] = steps.count(part.cost[begin : begin + BLOCK])
    return counted


def _part(part: Side, stop: Stop, epsilon: float, factor: float, scaling: bool, run: Auction) -> tuple[Wholes, Floats]:
    bits = BITS
    while True:
        cost = _Costs(part, steps_of(part, bits, finest=epsilon > 0.0))
        unit, span = cost.steps.unit, cost.span
        capped = epsilon * unit > span
        least = max(1, span if capped else round(epsilon * unit))
        ended, column, price = 3, np.zeros(0, np.int64), np.zeros(0, np.int64)
        if not scaling or part.num_columns > part.num_rows:  # rows seldom meet: prices from 0 need no repair
            ended, column, price = _phases(part, cost, stop, least, least, factor, run, FEW * part.num_rows if scaling else MANY)
        if ended == 3 and scaling:
            tried = max(least, _apart(part, cost.steps) // NEAR)
            ended, column, price = _phases(part, cost, stop, least, max(least, span // START), factor, run, MANY, tried)
        if ended != 2 or bits <= 4 * FEWER:
            break
        bits -= FEWER  # prices are many times the costs: count in larger steps
    whole, exact = ended == 0, cost.steps.exact(part)
    run.complete &= whole
    run.exact &= exact
    run.whole = part.complete and part.spread.whole and cost.steps.power == 0 and least == 1 and int(price.max(initial=0)) + span < _WHOLE
    run.optimal &= whole and exact and least * part.num_columns < unit * _step(part, unit)
    if least / unit > run.epsilon:
        run.epsilon, run.capped = least / unit, capped
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
    """The number of which all costs are multiples where they are counted exactly."""
    return max((part.num_columns + 1) / unit, float(part.spread.whole))


class _Costs:
    """Costs in whole steps, counted beforehand or while they are looked at, and their range."""

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
        slack = size * kernels.ROUNDING + 0.5 * (1 if steps.power == 0 and part.spread.whole else 2 + steps.many)
        self.real = part.cost if uncounted else np.zeros(0), steps.scale, steps.least, steps.many, slack


def _apart(part: Side, steps: Steps) -> int:
    """Difference of the dearest and the cheapest pair that a row remembers: the median of a sample of rows."""
    from .auction_kernels import LINE, LINES

    differences = []
    for row in np.unique(np.linspace(0, part.num_rows - 1, min(SAMPLE, part.num_rows)).astype(np.int64)).tolist():
        own = steps.count(part.cost[part.indptr[row] : part.indptr[row + 1]])
        near = np.partition(own, min(LINE * LINES, len(own) - 1))[: LINE * LINES + 1]
        differences.append(int(near.max() - near.min()))
    return sorted(differences)[len(differences) // 2]


def _phases(
    part: Side, cost: _Costs, stop: Stop, least: int, epsilon: int, factor: float, run: Auction, most: int, tried: int = MANY
) -> tuple[int, Wholes, Wholes]:
    """How the phases ended, as kernels tell it, the column of each row, and prices; ``tried`` is an epsilon to begin with if few bids
    suffice."""
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
        run.phases += 1
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
    run.bids += int(counts[0])
    run.looks += int(counts[1])
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
    """Take columns away from rows where free columns are dearer than taken ones, the cheapest first; whether there were any.

    Further bidders that are indifferent between all columns hold the free ones; those that cannot hold a dear one bid for the cheapest of
    the others, all at the price of the next and epsilon.
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
