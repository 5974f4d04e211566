"""Routes of negative reduced cost: whole numbers for the labels of ``label_kernels``, from both ends of the routes."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.stop import Stop
from .arcs import Flags, Floats, Integers
from .route_levels import DONE, EXACT, NONE, STOPPED, WORD, Level
from .subset_rows import SubsetRow

Ints = NDArray[np.int32]

BUCKETS = 24
"""Buckets of a node in the first level."""

QUEUE = 4096
"""Steps of the first level in whose order labels are extended."""

COST_BITS, LEVEL_BITS = 32, 40
"""Bits of the largest cost of a move and of the largest level in whole numbers."""

UNEVEN, SHIFT = 1.2, 0.05
"""Ratio of the numbers of labels from both ends above which the halfway point is moved, and by what part of the first level."""


BESIDE, MEETING = 17, 16
"""Bytes of a label beside its row, and where labels are put together."""


class _End:
    """All that labels from one end of the routes take; nodes, moves and levels are those seen from there, nodes come first.

    ``moves`` are the ends of the moves in the kernels' order; ``labels``, ``queues`` and ``buckets`` are what the kernels write to, in the
    order in which ``grow`` takes it.
    """

    def __init__(
        self, weight: Integers, lower: Integers, upper: Integers, start: Integers, above: Integers, room: int, most_bytes: float
    ) -> None:  # fmt: skip
        self.weight, self.lower, self.upper, self.start, self.above = weight, lower, upper, start, above
        room = int(min(room, most_bytes / (BESIDE + MEETING + 8 * (len(start) + 3))))
        self.count, self.nodes, self.room, self.most_bytes = 0, len(lower), room, most_bytes
        self.node, self.parent, self.after, self.waiting = (np.empty(room, np.int32) for _ in range(4))
        self.gone, self.queue = np.empty(room, np.bool_), np.empty(QUEUE, np.int32)
        self.chains, self.cheapest = np.empty((self.nodes, BUCKETS), np.int32), np.empty((self.nodes, BUCKETS), np.int64)
        self.rows = np.empty((0, 0), np.int64)
        self.arcs = self.heads = np.zeros(0, np.int32)
        self.tails = self.cost = np.zeros(0, np.int64)
        self.arc_weight = self.keep = np.zeros((0, 0), np.int64)
        self.latest = np.zeros((0, 0, 0), np.int64)
        self.place = np.zeros(0, np.int8)

    def restrict(self, usable: Flags, cuts: Sequence[SubsetRow], members: Ints, position: NDArray[np.int8]) -> None:
        """Take the moves that ``usable`` marks, from here, and the lists of who is remembered."""
        tails, heads = np.nonzero(usable)
        words = -(-len(cuts) // WORD)
        self.arcs = np.searchsorted(tails, np.arange(self.nodes + 1)).astype(np.int32)
        self.tails, self.heads = tails, heads.astype(np.int32)
        self.arc_weight = np.ascontiguousarray(self.weight[:, tails, heads].T)
        self.place = position[tails, heads]
        self.keep = np.zeros((len(tails), words), np.int64)
        for c, cut in enumerate(cuts):
            self.keep[cut.memory[tails] & cut.memory[heads], c // WORD] |= 1 << (c % WORD)
        self.latest = self._latest(usable, members)
        width = len(self.start) + 3 + words
        if self.rows.shape[1] != width:
            self.rows = np.empty((0, width), np.int64)  # let go of the old ones first
            fitting = int(min(self.room, (self.most_bytes - BESIDE * self.room) / (MEETING + 8 * width)))
            self.rows = np.empty((fitting + 1, width), np.int64)

    def _latest(self, usable: Flags, members: Ints) -> Integers:
        """Levels at each node above which those whom it remembers are out of reach."""
        none, far = np.int64(1 << 60), np.int64(1 << 50)
        latest = np.full((*members.shape, len(self.start)), none, np.int64)
        for r, weight in enumerate(self.weight):
            way = np.where(usable, weight, far)
            for k in range(1, self.nodes):
                np.minimum(way, way[:, k, None] + way[None, k], out=way)
            for p, who in enumerate(members.T[1:], start=1):
                latest[:, p, r] = np.where(who >= 0, self.upper[who, r] - way[np.arange(self.nodes), who], none)
        return latest

    def begin(self, cost: Floats, unit: float) -> None:
        """Take reduced costs of moves, (nodes, nodes), and put the label of the depot in place."""
        self.cost = np.floor(cost[self.tails, self.heads] * unit).astype(np.int64)
        self.rows[0] = 0
        self.rows[0, 1 : 1 + len(self.start)] = self.start

    @property
    def labels(self) -> tuple[NDArray[Any], ...]:
        """Arrays that kernels write to, for as many labels as there is room for."""
        beside = (part[: len(self.rows) - 1] for part in (self.node, self.parent, self.after, self.gone, self.waiting))
        node, parent, after, gone, waiting = beside
        return self.rows, node, parent, after, gone, self.queue, waiting, self.chains, self.cheapest

    @property
    def moves(self) -> tuple[NDArray[Any], ...]:
        return self.arcs, self.heads, self.cost, self.arc_weight, self.keep, self.place

    def walk(self, label: int) -> list[int]:
        """Customers of a label, the last one first."""
        visits = []
        while label > 0:
            visits.append(int(self.node[label]))
            label = int(self.parent[label])
        return visits


class Pricer:
    """Searches for routes over the moves that ``usable`` marks; node 0 is the depot.

    There is one of ``levels`` at least. Those who are remembered are ranked by the distances ``far`` (nodes, nodes); ``dearest`` is the
    largest cost of a move, ``room`` the most labels from each end, and ``most_bytes`` is for the labels from both ends.
    """

    def __init__(
        self, levels: Sequence[Level], usable: Flags, far: Floats, dearest: float, room: int, most_bytes: float = math.inf
    ) -> None:  # fmt: skip
        self.levels, self.nodes = len(levels), len(usable)
        self.unit = 2.0**COST_BITS / dearest if dearest > 0.0 else 1.0
        whole = [self._whole(level, usable) for level in levels]
        above, below = (np.full(len(levels), -1, np.int64) for _ in range(2))
        for r, level in enumerate(levels):
            if level.above >= 0:
                above[r], below[level.above] = level.above, r
        w, first, low, high = (np.array(part, dtype=np.int64) for part in zip(*whole, strict=True))
        self.top = high.max(axis=1)
        self.labels, self.far = 0, far
        back_low, back_high = (np.ascontiguousarray((self.top[:, None] - ends).T) for ends in (high, low))
        back_high[0] = self.top - first
        mirrored = np.ascontiguousarray(w.transpose(0, 2, 1))
        half = most_bytes / 2.0
        ahead, back = (low.T.copy(), high.T.copy(), first, above), (back_low, back_high, back_low[0].copy(), below)
        # From behind it is the other way round: what comes on board on the rest of the way leaves room for what is delivered there.
        self.ends = _End(w, *ahead, room, half), _End(mirrored, *back, room, half)
        self.members, self.position = np.zeros((0, 0), np.int32), np.zeros((0, 0), np.int8)
        self.toggle = np.zeros((self.nodes, 0), np.int64)
        self.halfway = int((max(first[0], 0) + high[0].max()) // 2)
        self.bidirectional = True

    @staticmethod
    def _whole(level: Level, usable: Flags) -> tuple[Integers, int, Integers, Integers]:
        """A level in whole numbers, which allow all that it allows."""
        weight, start, lower, upper = level.weight, level.start, level.lower, level.upper
        size = max(float(np.abs(upper).max()), float(np.abs(lower).max()), abs(start))
        shift = LEVEL_BITS - math.frexp(size)[1]  # the same for levels that are compared, which end at the same number
        moves = np.floor(np.ldexp(np.where(usable, np.minimum(weight, 4.0 * size), 0.0), shift)).astype(np.int64)
        first, low, high = np.floor(np.ldexp(start, shift)), np.floor(np.ldexp(lower, shift)), np.ceil(np.ldexp(upper, shift))
        return moves, int(first), low.astype(np.int64), high.astype(np.int64)

    # -- what changes from node to node of a tree ------------------------------------------------------------------------

    def restrict(self, usable: Flags, near: Flags, cuts: Sequence[SubsetRow]) -> None:
        """Search among ``usable`` moves from now on; ``near`` (nodes, nodes) marks who is remembered where, each customer himself too."""
        n = self.nodes
        near = near.copy()
        near[0] = near[:, 0] = False
        places = max(1, int(near.sum(axis=1).max(initial=1)))
        self.members = np.full((n, places), -1, np.int32)
        self.position = np.full((n, n), -1, np.int8)
        for i in range(1, n):
            others = np.nonzero(near[i] & (np.arange(n) != i))[0]
            own = np.concatenate([[i], others[np.argsort(self.far[i, others], kind="stable")]])
            self.members[i, : len(own)] = own
            self.position[i, own] = np.arange(len(own))
        self.toggle = np.zeros((n, -(-len(cuts) // WORD)), np.int64)
        for c, cut in enumerate(cuts):
            self.toggle[list(cut.customers), c // WORD] |= 1 << (c % WORD)
        for end, mask in zip(self.ends, (usable, usable.T), strict=True):
            end.restrict(mask, cuts, self.members, self.position)

    # -- one search ----------------------------------------------------------------------------------------------------------

    def search(
        self, stop: Stop, reduced: Floats, duals: Floats, how: int, most: int, below: float
    ) -> tuple[int, float, Floats, list[Integers]]:
        """Routes of a reduced cost ``below`` a number, the ``most`` cheapest, and the least reduced cost of all; ``reduced`` (nodes, nodes)
        are the reduced costs of moves, ``duals`` those of the cuts, 0 or less."""
        from .label_kernels import join

        fines = self._fines(duals)
        least_bar = self.bar(below)
        halves = (self.halfway, int(self.top[0]) - self.halfway - 1) if self.bidirectional else (int(self.top[0]), -1)
        status = self._grow(stop, reduced, fines, how, halves)
        if status != DONE:
            return status, -np.inf, np.zeros(0), []
        most_pairs = self.ends[0].count
        pairs, totals = np.empty((most_pairs, 2), np.int32), np.empty(most_pairs, np.int64)
        least, number = join(stop.flag, *self._meeting(fines), least_bar, pairs, totals)
        if number < 0:
            return STOPPED, -np.inf, np.zeros(0), []
        if self.bidirectional:
            self._balance()
        order = np.argsort(totals[:number], kind="stable")[:most]
        ahead, back = self.ends
        routes = [np.array(ahead.walk(f)[::-1] + back.walk(b), dtype=np.int64) for f, b in pairs[order].tolist()]
        return DONE, least / self.unit if least < NONE else np.inf, totals[order] / self.unit, routes

    def arc_costs(self, stop: Stop, reduced: Floats, duals: Floats, below: float) -> Floats | None:
        """The least reduced cost of all routes that make each move, as far as it is below a number, which stands for all others; None
        where there was no time or no room."""
        from .label_kernels import arc_costs

        fines, full = self._fines(duals), int(self.top[0])
        if self._grow(stop, reduced, fines, EXACT, (full, full)) != DONE:
            return None
        ahead = self.ends[0]
        least = np.full(len(ahead.heads), self.bar(below), np.int64)
        if arc_costs(stop.flag, *self._meeting(fines), least) != DONE:
            return None
        costs = np.full(reduced.shape, np.inf)
        costs[ahead.tails, ahead.heads] = least / self.unit
        return costs

    def backwards(self, stop: Stop, reduced: Floats, duals: Floats) -> int:
        """Grow all labels from the end of routes; whether it was done, stopped or full."""
        return self._grow(stop, reduced, self._fines(duals), EXACT, (-1, int(self.top[0])))

    def bar(self, below: float) -> int:
        """A cost in whole numbers, those beyond all sums cut off."""
        return int(min(max(np.floor(below * self.unit), -NONE), NONE))

    def _grow(self, stop: Stop, reduced: Floats, fines: Integers, how: int, halves: tuple[int, int]) -> int:
        """Labels from both ends, each up to its halfway point."""
        from .label_kernels import grow

        for end, grid, half in zip(self.ends, (reduced, reduced.T), halves, strict=True):
            end.begin(grid, self.unit)
            status, end.count = grow(
                stop.flag, *end.moves, self.toggle, fines, end.lower, end.upper, end.above, self.members, self.position, end.latest,
                *end.labels, max(half, int(end.start[0])), how,
            )  # fmt: skip
            self.labels += end.count
            if status != DONE:
                return int(status)
            end.chains[0, 0], end.cheapest[0, 0], end.after[0] = 0, 0, -1  # the label of the depot stands in its bucket too
        return DONE

    def _meeting(self, fines: Integers) -> tuple[Any, ...]:
        """Labels from both ends, as the kernels that put them together take them."""
        ahead, back = self.ends
        return (
            *ahead.moves, fines, self.members, self.position, ahead.rows, ahead.node, ahead.gone, ahead.count,
            back.rows, back.after, back.chains, back.cheapest, back.lower, back.upper, self.top,
        )  # fmt: skip

    def _balance(self) -> None:
        ahead, back = (end.count for end in self.ends)
        step = int(SHIFT * (int(self.top[0]) - int(self.ends[0].start[0])))
        if ahead > UNEVEN * back:
            self.halfway -= step
        elif back > UNEVEN * ahead:
            self.halfway += step
        self.halfway = min(max(self.halfway, int(self.ends[0].start[0])), int(self.top[0]) - 1)

    def _fines(self, duals: Floats) -> NDArray[np.int64]:
        """Sums of the prices of cuts for all values of each byte of a label's cuts, rounded down, shape (words, bytes, 256)."""
        owed = np.zeros((self.toggle.shape[1], WORD // 8, 8), np.int64)
        for c, dual in enumerate(duals.tolist()):
            owed[c // WORD, c % WORD // 8, c % 8] = max(0, int(np.floor(-dual * self.unit)))
        bits = (np.arange(256)[:, None] >> np.arange(8)) & 1
        return np.ascontiguousarray(owed @ bits.T)
