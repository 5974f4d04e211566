"""The least reduced cost of a walk from the depot and back that keeps its levels, for any multipliers.

Costs are whole multiples of a power of two, rounded down, and multipliers are such multiples: what is found for these numbers is exact.
docs/proofs.md#labels-in-whole-numbers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...stop import Stop
from .known_features import Flags, Floats, Longs
from .relaxation import Resource
from .walk_networks import BITS, FAR, Ints, Row, network_of, whole_levels, with_needed

WORDS = 40_000_000
"""Whole numbers in all labels together, of 8 bytes each; those that are kept take as much again."""


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
        levels, many = whole_levels(resources, self.usable, counted=False), multipliers
        sizes = [np.abs(cost[self.usable]).max(initial=0.0), np.abs(many.visits).max(initial=0.0)]
        size = math.fsum([*sizes, *(load.price for load in many.loads), *(-row.price for row in many.rows)])
        if not math.isfinite(64.0 * size * len(cost) ** 2):
            raise OverflowError
        self.exponent = min(59 - math.frexp(size * (levels.most + 2))[1], 1000) if size > 0 else 0
        self.constant = sum(self._whole(many.visits).tolist())
        reduced = np.floor(np.ldexp(np.where(self.usable, cost, 0.0), self.exponent)).astype(np.int64)
        reduced[:, 1:] -= self._whole(many.visits)
        for load in many.loads:
            self.work -= len(load.sites) * len(cost)
            if self.work < 0:
                break
            price = int(self._whole(load.price))
            reduced[:, load.sites] -= price
            reduced[np.ix_(load.sites, load.sites)] += price
            self.constant += load.least * price
        # Rows of no price are of no use.
        self.rows = [(row, price) for row in many.rows if (price := -int(self._whole(row.price))) > 0]
        self.constant -= sum(row.most * price for row, price in self.rows)
        self.reduced = reduced
        self._networks = {False: network_of(reduced, self.usable, levels, many.listed, self.rows)}
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
        """The least cost that was found, and the visits of the walk that has it, 0 without."""
        from .walk_kernels import DONE, completions, least_walk

        if counted not in self._networks:
            levels = whole_levels(self.resources, self.usable, counted=counted)
            self._networks[counted] = network_of(self.reduced, self.usable, levels, self.multipliers.listed, self.rows)
        network, flag, visits = self._networks[counted], self.stop.flag, 0
        marked = which if which is not None or not self.needed else 0
        if marked is not None:
            network = with_needed(network, self.needed[marked][self.usable].astype(np.int64))
        if (counted, marked) not in self._rest:
            self._rest[counted, marked] = completions(flag, network, 1 if marked is None else 2)
            self.work -= int(network.grid[2]) * len(network.moves)
        rest = self._rest[counted, marked]
        room = min(self.room, WORDS // (1 + len(network.start) + network.listed.shape[1] // BITS + network.turned.shape[1]))
        for careful in (False, True):
            arguments = limit, which is not None, careful, room, self.work
            status, found, length, looked = least_walk(flag, network, rest, *arguments)
            self.work -= looked
            if status != DONE:
                return None, 0
            limit, visits = (found, length) if found < limit else (limit, visits)
        return limit, visits
