"""Routes of negative reduced cost: whole numbers for the labels of ``label_kernels``, from both ends of the routes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ....formulations.stop import Stop
from .arcs import Flags, Floats, Longs
from .subset_rows import SubsetRow

BUCKETS = 24
"""Buckets of a node in the first level."""

QUEUE = 4096
"""Steps of the first level in whose order labels are extended."""

COST_BITS, LEVEL_BITS = 32, 40
"""Bits of the largest cost of a move and of the largest level in whole numbers."""

UNEVEN, SHIFT = 1.2, 0.05
"""Ratio of the numbers of labels from both ends above which the halfway point is moved, and by what part of the first level."""


@dataclass(eq=False)
class _End:
    """All that labels from one end of the routes take; nodes, moves and levels are those seen from there."""

    weight: Longs
    lower: Longs
    upper: Longs
    start: Longs
    rows: NDArray[np.int64]
    arcs: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    tails: Longs = field(default_factory=lambda: np.zeros(0, np.int64))
    heads: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    count: int = 0


class Pricer:
    """Searches for routes over the moves that ``usable`` marks; node 0 is the depot.

    Parameters
    ----------
    weight : array of shape (levels, nodes, nodes)
        What moves add to the levels; those from the depot are in row 0, those to it in column 0.
    start : array of shape (levels,)
        Levels on leaving the depot.
    lower, upper : arrays of shape (levels, nodes)
        Ranges of the levels; in entry 0 on return.
    usable : array of shape (nodes, nodes)
    dearest : float
        The largest cost of a move.
    room : int
        Most labels from each end.
    """

    def __init__(self, weight: Floats, start: Floats, lower: Floats, upper: Floats, usable: Flags, dearest: float, room: int) -> None:
        self.levels, self.nodes = len(start), len(usable)
        self.unit = 2.0**COST_BITS / dearest if dearest > 0.0 else 1.0
        whole = [self._whole(weight[r], start[r], lower[r], upper[r], usable) for r in range(self.levels)]
        w, first, low, high = (np.array(part, dtype=np.int64) for part in zip(*whole, strict=True))
        self.top = high.max(axis=1)
        self.room, self.labels = room, 0
        ahead = _End(w, low.T.copy(), high.T.copy(), first, np.empty((0, 0), np.int64))
        back_low = np.ascontiguousarray((self.top[:, None] - high).T)
        back_high = np.ascontiguousarray((self.top[:, None] - low).T)
        back_high[0] = self.top - first
        back = _End(np.ascontiguousarray(w.transpose(0, 2, 1)), back_low, back_high, back_low[0].copy(), np.empty((0, 0), np.int64))
        self.ends = ahead, back
        self.halfway = int((max(first[0], 0) + high[0].max()) // 2)
        self.bidirectional = True

    @staticmethod
    def _whole(weight: Floats, start: float, lower: Floats, upper: Floats, usable: Flags) -> tuple[Longs, int, Longs, Longs]:
        """A resource in whole numbers, which allow all that it allows."""
        size = max(float(np.abs(upper).max()), float(np.abs(lower).max()), abs(start))
        shift = LEVEL_BITS - math.frexp(size)[1]
        moves = np.floor(np.ldexp(np.where(usable, np.minimum(weight, 4.0 * size), 0.0), shift)).astype(np.int64)
        first, low, high = np.floor(np.ldexp(start, shift)), np.floor(np.ldexp(lower, shift)), np.ceil(np.ldexp(upper, shift))
        return moves, int(first), low.astype(np.int64), high.astype(np.int64)

    # -- what changes from node to node of a tree ------------------------------------------------------------------------

    def restrict(self, usable: Flags, near: Flags, cuts: Sequence[SubsetRow]) -> None:
        """Search among ``usable`` moves from now on; ``near`` (nodes, nodes) marks who is remembered where, each customer himself too."""
        from .label_kernels import WORD

        n = self.nodes
        near = near.copy()
        near[0] = near[:, 0] = False
        places = max(1, int(near.sum(axis=1).max(initial=1)))
        self.members = np.full((n, places), -1, np.int32)
        self.position = np.full((n, n), -1, np.int8)
        for i in range(1, n):
            own = np.concatenate([[i], np.nonzero(near[i] & (np.arange(n) != i))[0]])
            self.members[i, : len(own)] = own
            self.position[i, own] = np.arange(len(own))
        words = -(-len(cuts) // WORD)
        self.cuts = cuts
        self.toggle = np.zeros((n, words), np.int64)
        for c, cut in enumerate(cuts):
            self.toggle[list(cut.customers), c // WORD] |= 1 << (c % WORD)
        for end, mask in zip(self.ends, (usable, usable.T), strict=True):
            tails, heads = np.nonzero(mask)
            end.arcs = np.searchsorted(tails, np.arange(n + 1)).astype(np.int32)
            end.tails, end.heads = tails, heads.astype(np.int32)
            end.arc_weight = np.ascontiguousarray(end.weight[:, tails, heads].T)
            end.place = self.position[tails, heads]
            end.keep = np.zeros((len(tails), words), np.int64)
            for c, cut in enumerate(cuts):
                end.keep[cut.memory[tails] & cut.memory[heads], c // WORD] |= 1 << (c % WORD)
            end.latest = self._latest(end, mask)
        self.words = words
        width = self.levels + 3 + words
        for end in self.ends:
            if end.rows.shape[1] != width:
                end.rows = np.empty((self.room + 1, width), np.int64)
            if not hasattr(end, "node"):
                end.node, end.parent, end.after, end.waiting = (np.empty(self.room, np.int32) for _ in range(4))
                end.gone = np.empty(self.room, np.bool_)
                end.queue = np.empty(QUEUE, np.int32)
                end.chains, end.cheapest = np.empty((n, BUCKETS), np.int32), np.empty((n, BUCKETS), np.int64)

    def _latest(self, end: _End, usable: Flags) -> NDArray[np.int64]:
        """Levels at each node above which those whom it remembers are out of reach."""
        latest = np.full((*self.members.shape, self.levels), 1 << 60, np.int64)
        far = np.int64(1 << 50)
        for r in range(self.levels):
            way = np.where(usable, end.weight[r], far)
            for k in range(1, self.nodes):
                np.minimum(way, way[:, k, None] + way[None, k], out=way)
            for p in range(1, self.members.shape[1]):
                who = self.members[:, p]
                latest[:, p, r] = np.where(who >= 0, end.upper[who, r] - way[np.arange(self.nodes), who], 1 << 60)
        return latest

    # -- one search ----------------------------------------------------------------------------------------------------------

    def search(
        self, stop: Stop, reduced: Floats, duals: Floats, how: int, most: int, below: float
    ) -> tuple[int, float, Floats, list[Longs]]:
        """Routes of a reduced cost ``below`` a number, the ``most`` cheapest, and the least reduced cost of all; ``reduced`` (nodes, nodes)
        are the reduced costs of moves, ``duals`` those of the cuts, 0 or less."""
        from .label_kernels import DONE, NONE, STOPPED, join

        fines = self._fines(duals)
        least_bar = NONE if below == np.inf else int(np.floor(below * self.unit))
        halves = (self.halfway, int(self.top[0]) - self.halfway - 1) if self.bidirectional else (int(self.top[0]), -1)
        status = self._grow(stop, reduced, fines, how, halves)
        if status != DONE:
            return status, -np.inf, np.zeros(0), []
        ahead, back = self.ends
        pairs, totals = np.empty((ahead.count, 2), np.int32), np.empty(ahead.count, np.int64)
        least, number = join(
            stop.flag, ahead.arcs, ahead.heads, ahead.cost, ahead.arc_weight, ahead.keep, ahead.place, fines, self.members, self.position,
            ahead.rows, ahead.node, ahead.gone, ahead.count, back.rows, back.after, back.chains, back.cheapest, back.lower, back.upper,
            self.top, least_bar, pairs, totals,
        )  # fmt: skip
        if number < 0:
            return STOPPED, -np.inf, np.zeros(0), []
        if self.bidirectional:
            self._balance()
        order = np.argsort(totals[:number], kind="stable")[:most]
        routes = [self._route(int(f), int(b)) for f, b in pairs[order].tolist()]
        return DONE, least / self.unit if least < NONE else np.inf, totals[order] / self.unit, routes

    def arc_costs(self, stop: Stop, reduced: Floats, duals: Floats, below: float) -> Floats | None:
        """The least reduced cost of all routes that make each move, as far as it is below a number, which stands for all others; None
        where there was no time or no room."""
        from .label_kernels import DONE, EXACT, arc_costs

        fines, full = self._fines(duals), int(self.top[0])
        if self._grow(stop, reduced, fines, EXACT, (full, full)) != DONE:
            return None
        ahead, back = self.ends
        least = np.full(len(ahead.heads), int(np.floor(below * self.unit)), np.int64)
        status = arc_costs(
            stop.flag, ahead.arcs, ahead.heads, ahead.cost, ahead.arc_weight, ahead.keep, ahead.place, fines, self.members, self.position,
            ahead.rows, ahead.node, ahead.gone, ahead.count, back.rows, back.after, back.chains, back.cheapest, back.lower, back.upper,
            self.top, least,
        )  # fmt: skip
        if status != DONE:
            return None
        costs = np.full(reduced.shape, np.inf)
        costs[ahead.tails, ahead.heads] = least / self.unit
        return costs

    def _grow(self, stop: Stop, reduced: Floats, fines: Longs, how: int, halves: tuple[int, int]) -> int:
        """Labels from both ends, each up to its halfway point."""
        from .label_kernels import DONE, grow

        for end, grid, half in zip(self.ends, (reduced, reduced.T), halves, strict=True):
            end.cost = np.floor(grid[end.tails, end.heads] * self.unit).astype(np.int64)
            end.rows[0] = 0
            end.rows[0, 1 : 1 + self.levels] = end.start
            status, end.count = grow(
                stop.flag, end.arcs, end.heads, end.cost, end.arc_weight, end.keep, end.place, self.toggle, fines, end.lower, end.upper,
                self.members, self.position, end.latest, end.rows, end.node, end.parent, end.after, end.gone, end.queue, end.waiting,
                end.chains, end.cheapest, max(half, int(end.start[0])), how,
            )  # fmt: skip
            self.labels += end.count
            if status != DONE:
                return int(status)
            end.chains[0, 0], end.cheapest[0, 0], end.after[0] = 0, 0, -1  # the label of the depot stands in its bucket too
        return DONE

    def _balance(self) -> None:
        ahead, back = (end.count for end in self.ends)
        step = int(SHIFT * (int(self.top[0]) - int(self.ends[0].start[0])))
        if ahead > UNEVEN * back:
            self.halfway -= step
        elif back > UNEVEN * ahead:
            self.halfway += step
        self.halfway = min(max(self.halfway, int(self.ends[0].start[0])), int(self.top[0]) - 1)

    def _route(self, label: int, partner: int) -> Longs:
        ahead, back = self.ends
        visits = []
        while label > 0:
            visits.append(int(ahead.node[label]))
            label = int(ahead.parent[label])
        visits.reverse()
        while partner > 0:
            visits.append(int(back.node[partner]))
            partner = int(back.parent[partner])
        return np.array(visits, dtype=np.int64)

    def _fines(self, duals: Floats) -> NDArray[np.int64]:
        """What open bits of each byte cost together, rounded down."""
        from .label_kernels import WORD

        owed = np.zeros((self.words, WORD // 8, 8), np.int64)
        for c, dual in enumerate(duals.tolist()):
            owed[c // WORD, c % WORD // 8, c % 8] = max(0, int(np.floor(-dual * self.unit)))
        bits = (np.arange(256)[:, None] >> np.arange(8)) & 1
        return np.ascontiguousarray(owed @ bits.T)
