"""Walks from the depot and back in whole numbers: the least reduced cost of all that keep their levels, and how it is looked for.

Costs are whole multiples of a power of two, rounded down, multipliers are such multiples, and levels are rounded so that all walks that
keep them in doubles do: what is found for these numbers is exact. docs/proofs.md#routes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...stop import Stop
from .known_features import Flags, Floats, Longs
from .relaxation import Resource, order_resource

Ints = NDArray[np.int32]

BITS = 63
"""Bits of a word that are used; the lowest of a label's first word of memory tells whether a needed move is still to be made."""

FAR = 1 << 61
"""More than any walk costs."""

CELLS = 256
"""Parts of the range of the first level, for bounds on what is left of a walk."""

LONGEST = 1 << 14
"""Visits of a walk; where the levels allow more, visits are counted."""

PASSES = 150_000_000
"""Moves in all cells together."""


class Network(NamedTuple):
    """What the kernels go through; node 0 is the depot.

    ``first`` is the place of each node's first move in ``moves``, of shape (moves, 3 + levels): head, 1 for a needed one, cost, and what it
    adds to each level. ``start`` are the levels on leaving the depot, ``lower`` and ``upper``, shape (nodes, levels), the least and the
    greatest at a node; ``grid`` has the least, the binary logarithm of the width, and the number of cells of the first level. ``listed``
    are the customers who are remembered at a node, from position 1 on, ``place`` the position of each one there or -1, and ``reach`` the
    greatest levels at the node from which he can still be reached. ``rows_at`` are the rows that are remembered at a node, by their bits,
    ``row_place`` the bit of each one or -1, ``turned`` the bits that a visit turns over, and ``prices`` what a row costs that is turned
    back.
    """

    first: Longs
    moves: Longs
    start: Longs
    lower: Longs
    upper: Longs
    grid: Longs
    listed: Ints
    place: Ints
    reach: Longs
    rows_at: Ints
    row_place: Ints
    turned: Longs
    prices: Longs


@dataclass(frozen=True, eq=False)
class Row:
    """A subset row of multiplier 1/2: its customers, the nodes at which it is remembered, and its price, at most 0."""

    sites: Longs
    memory: Longs
    price: float

    @property
    def most(self) -> int:
        """How often routes that visit each customer once have it, all together."""
        return len(self.sites) // 2


@dataclass(frozen=True, eq=False)
class Load:
    """A rounded capacity row: its customers, the moves that enter it at least, and its price, at least 0."""

    sites: Longs
    least: int
    price: float


@dataclass(frozen=True, eq=False)
class Multipliers:
    """Multipliers of all rows; customers are nodes here.

    ``visits`` has one price a customer; ``listed``, shape (nodes, positions), who is remembered at each node, without himself, -1 behind.
    """

    visits: Floats
    loads: Sequence[Load]
    rows: Sequence[Row]
    listed: Ints


@dataclass(frozen=True, eq=False)
class _Levels:
    """Whole levels, the one that cells are made of first; the visits of a walk that keeps them are at most ``most``."""

    weight: Longs
    start: Longs
    lower: Longs
    upper: Longs
    most: int


class Walks:
    """All walks of a relaxation at some multipliers, in whole multiples of ``2^-exponent``.

    Parameters
    ----------
    cost : array of shape (nodes, nodes)
        Infinite where there is no move.
    resources : sequence of Resource
    multipliers : Multipliers
    needed : sequence of bool arrays of shape (nodes, nodes)
        Sets of moves.
    stop : Stop
    room, work : int
        Labels at a time, and comparisons, at most.

    Raises
    ------
    OverflowError
        If numbers are too large to be added up.
    """

    def __init__(
        self,
        cost: Floats,
        resources: Sequence[Resource],
        multipliers: Multipliers,
        needed: Sequence[Flags],
        stop: Stop,
        room: int,
        work: int,
    ) -> None:
        self.multipliers, self.needed, self.stop, self.room, self.work = multipliers, needed, stop, room, work
        self.usable, self.resources = np.isfinite(cost), resources
        levels, many = _levels(resources, self.usable, counted=False), multipliers
        sizes = [np.abs(cost[self.usable]).max(initial=0.0), np.abs(many.visits).max(initial=0.0)]
        size = math.fsum([*sizes, *(load.price for load in many.loads), *(-row.price for row in many.rows)])
        if not math.isfinite(64.0 * size * len(cost) ** 2):
            raise OverflowError
        self.exponent = min(59 - math.frexp(size * (levels.most + 2))[1], 1000) if size > 0 else 0
        self.constant = sum(self._whole(many.visits).tolist())
        reduced = np.floor(np.ldexp(np.where(self.usable, cost, 0.0), self.exponent)).astype(np.int64)
        reduced[:, 1:] -= self._whole(many.visits)
        for load in many.loads:
            price = int(self._whole(load.price))
            reduced[:, load.sites] -= price
            reduced[np.ix_(load.sites, load.sites)] += price
            self.constant += load.least * price
        self.row_prices = -self._whole(np.array([row.price for row in many.rows]))
        self.constant -= sum(row.most * price for row, price in zip(many.rows, self.row_prices.tolist(), strict=True))
        self.reduced = reduced
        self._networks = {False: self._network(levels)}
        self._rest: dict[tuple[bool, int | None], Longs] = {}

    def _whole(self, values: Floats | float) -> Longs:
        return np.rint(np.ldexp(values, self.exponent)).astype(np.int64)

    def _limit(self, claimed: float | None) -> int:
        """A number in whole multiples, rounded down; one that is beyond all walks is cut off."""
        if claimed is None:
            return FAR
        try:
            return math.floor(min(max(math.ldexp(claimed, self.exponent), -FAR), FAR))
        except OverflowError:
            return FAR if claimed > 0.0 else -FAR

    def least(self, which: int | None = None, claimed: float | None = None) -> int | None:
        """The least reduced cost of all walks, or of those that make a move of set ``which``; where that is not below ``claimed``, this.

        None where it was not found within the limits, or the time; ``FAR`` where there is no walk.
        """
        limit = self._limit(claimed)
        found, visits = self._searched(which, limit, counted=False)
        if found is not None and visits >= len(self.usable):  # no route visits more customers than there are
            found, _ = self._searched(which, limit, counted=True)
        return found

    def _searched(self, which: int | None, limit: int, *, counted: bool) -> tuple[int | None, int]:
        """What was found, and the visits of the walk that costs it, 0 without."""
        from .walk_kernels import DONE, completions, least_walk

        if counted not in self._networks:
            self._networks[counted] = self._network(_levels(self.resources, self.usable, counted=counted))
        network, flag, visits = self._networks[counted], self.stop.flag, 0
        marked = which if which is not None or not self.needed else 0
        if marked is not None:
            network = self._marked(network, self.needed[marked])
        if (counted, marked) not in self._rest:
            self._rest[counted, marked] = completions(flag, network, 1 if marked is None else 2)
            self.work -= int(network.grid[2]) * len(network.moves)
        rest = self._rest[counted, marked]
        for careful in (False, True) if limit == FAR else (True,):
            arguments = limit, which is not None, careful, self.room, self.work
            status, found, length, looked = least_walk(flag, network, rest, *arguments)
            self.work -= looked
            if status != DONE:
                return None, 0
            limit, visits = (found, length) if found < limit else (limit, visits)
        return limit, visits

    def _marked(self, network: Network, needed: Flags) -> Network:
        moves = network.moves.copy()
        moves[:, 1] = needed[self.usable]
        return network._replace(moves=moves)

    def _network(self, levels: _Levels) -> Network:
        tails, heads = np.nonzero(self.usable)
        grown = [weight[tails, heads] for weight in levels.weight]
        moves = np.column_stack([heads, np.zeros_like(heads), self.reduced[tails, heads], *grown]).astype(np.int64)
        first = np.searchsorted(tails, np.arange(len(self.usable) + 1)).astype(np.int64)
        listed, place = self._memory()
        reach = np.full((*listed.shape, len(levels.start)), -FAR)  # nobody is reached from himself
        at, positions = np.nonzero((listed >= 0) & (listed != np.arange(len(listed))[:, None]))
        who, inner = listed[at, positions], self.usable[1:, 1:]
        for r, weight in enumerate(levels.weight):
            # Straight, or by a first and a last move of their own.
            added = np.where(inner, weight[1:, 1:], FAR >> 1)
            way = np.minimum(added, added.min(axis=1)[:, None] + added.min(axis=0)[None, :])
            reach[at, positions, r] = levels.upper[who, r] - way[at - 1, who - 1]
        span = max(0, int(levels.upper[:, 0].max() - levels.start[0]))
        shift = (span // min(CELLS, max(64, PASSES // max(1, len(moves))))).bit_length()
        grid = np.array([levels.start[0], shift, (span >> shift) + 1], dtype=np.int64)
        return Network(first, moves, levels.start, levels.lower, levels.upper, grid, listed, place, reach, *self._rows())

    def _memory(self) -> tuple[Ints, Ints]:
        """``listed`` and ``place``, with each customer himself."""
        given = self.multipliers.listed
        nodes = len(given)
        listed = np.full((nodes, given.shape[1] + 2), -1, np.int32)
        listed[1:, 1], listed[1:, 2:] = np.arange(1, nodes), given[1:]
        place = np.full((nodes, nodes), -1, np.int32)
        at, positions = np.nonzero(listed >= 0)
        place[at, listed[at, positions]] = positions
        return listed, place

    def _rows(self) -> tuple[Ints, Ints, Longs, Longs]:
        """``rows_at``, ``row_place``, ``turned`` and ``prices``; rows that cost nothing are left out."""
        nodes, rows = len(self.usable), [(row, int(p)) for row, p in zip(self.multipliers.rows, self.row_prices, strict=True) if p > 0]
        at = np.concatenate([np.zeros(0, np.int64), *(row.memory for row, _ in rows)])
        which = np.repeat(np.arange(len(rows)), [len(row.memory) for row, _ in rows])
        order = np.argsort(at, kind="stable")
        at, which = at[order], which[order]
        bit = np.arange(len(at)) - np.searchsorted(at, at)
        words = -(-int(bit.max(initial=-1) + 1) // BITS)
        rows_at, row_place = np.full((nodes, max(1, BITS * words)), -1, np.int32), np.full((nodes, max(1, len(rows))), -1, np.int32)
        prices, turned = np.zeros(rows_at.shape, np.int64), np.zeros((nodes, words), np.int64)
        rows_at[at, bit], row_place[at, which] = which, bit
        prices[at, bit] = np.array([p for _, p in rows], np.int64)[which]
        for k, (row, _) in enumerate(rows):
            bit = row_place[row.sites, k]
            turned[row.sites, bit // BITS] |= np.int64(1) << (bit % BITS).astype(np.int64)
        return rows_at, row_place, turned, prices


def _levels(resources: Sequence[Resource], usable: Flags, *, counted: bool) -> _Levels:
    """Whole levels of all resources; the one that the fewest visits use up comes first.

    Visits are counted too where that is asked for, or where walks could go on for ever, or for very long.
    """
    customers = len(usable) - 1
    made = [_whole_level(resource, usable) for resource in resources]
    inner = usable[1:, 1:]

    def steps(level: tuple[Longs, int, Longs, Longs]) -> tuple[bool, float]:
        """Whether many moves add nothing, and how many of those that add something there is room for."""
        weight, start, _, upper = level
        added = weight[1:, 1:][inner]
        span = float(upper.max() - start)
        return bool((added == 0).mean() > 0.1) if added.size else False, span / float(added[added > 0].min(initial=max(1, int(span))))

    made.sort(key=steps)
    weight = made[0][0][1:, 1:][inner]
    most = math.floor(steps(made[0])[1]) + 1
    endless = bool((weight == 0).any()) or most > LONGEST
    if counted or endless:
        order = _whole_level(order_resource(customers), usable, 0)
        made = [order, *made] if steps(made[0])[0] else [*made, order]
        most = customers
    weights, starts, lowers, uppers = zip(*made, strict=True)
    return _Levels(np.array(weights), np.array(starts, dtype=np.int64), np.column_stack(lowers), np.column_stack(uppers), most)


def _whole_level(resource: Resource, usable: Flags, exponent: int | None = None) -> tuple[Longs, int, Longs, Longs]:
    """Weights, start, lower and upper levels of a resource in whole multiples of a power of two; what is allowed stays so."""
    weight = np.where(usable, resource.weight, 0.0)
    upper = resource.upper + resource.slack
    lower = np.where(np.isfinite(resource.lower), resource.lower, resource.start)
    top = max(abs(resource.start), *(float(np.abs(v).max(initial=0.0, where=np.isfinite(v))) for v in (weight, lower, upper)))
    upper = np.where(np.isfinite(upper), upper, top)
    if exponent is None:
        exponent = min(52 - math.frexp(top)[1], 1000)

    if weight.min(initial=0.0) < 0.0:
        raise OverflowError  # no level that grows

    def below(values: Floats) -> Longs:
        return np.floor(np.ldexp(values, exponent)).astype(np.int64)

    return below(weight), int(below(np.array(resource.start))), below(lower), below(upper)
