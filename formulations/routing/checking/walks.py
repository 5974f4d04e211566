"""The least reduced cost of a walk from the depot and back that keeps its levels, for any multipliers.

Costs are whole multiples of a power of two, rounded down, and multipliers are such multiples: what is found for these numbers is exact.
docs/proofs.md#labels-in-whole-numbers.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...stop import Stop
from .known_features import Flags, Floats, Integers
from .relaxation import Resource
from .walk_networks import BITS, DONE, FAR, FULL, STOPPED, Ints, Levels, Network, Row, network_of, whole_levels, with_needed

QUICK = 30_000_000
"""Moves and comparisons after which walks are gone through backwards, too, before anything else is tried; some 0.3 s."""

QUICK_ROOM = 1_000_000
"""Labels at a time there."""

FEW = 6
"""Customers who are remembered at each one on walks that go backwards."""

WORDS = 40_000_000
"""Whole numbers in all labels together, of 8 bytes each; those that are kept take as much again."""

_NOTHING = np.zeros((0, 0, 0), np.int64)


@dataclass(frozen=True, eq=False)
class Load:
    """A rounded capacity row: its customers, the moves that enter it at least, and its price, at least 0."""

    sites: Integers
    least: int
    price: float


@dataclass(frozen=True, eq=False)
class Multipliers:
    """Multipliers of all rows; customers are nodes here.

    ``visits`` has one price per customer; ``listed``, shape (nodes, positions), who is remembered at each node, without himself, -1 behind;
    ``moves`` are sets, shape (nodes, nodes), of each of which one is made at least, with a price of at least 0.
    """

    visits: Floats
    loads: Sequence[Load]
    rows: Sequence[Row]
    listed: Ints
    moves: Sequence[tuple[Flags, float]] = ()


class Walks:
    """All walks of a relaxation at some multipliers, in whole multiples of ``2^-exponent``.

    ``cost`` (nodes, nodes) is infinite where there is no move, ``needed`` holds sets of moves, as flags (nodes, nodes). ``room`` and
    ``work`` are the most labels at a time, and the most comparisons; the exponent is ``finest`` at most.

    Raises OverflowError if numbers are too large to be added up.
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
        finest: int = 1000,
    ) -> None:
        self.multipliers, self.needed, self.stop, self.room, self.work = multipliers, needed, stop, room, work
        self.cost, self.usable, self.resources = cost, np.isfinite(cost), resources
        levels, many = whole_levels(resources, self.usable, counted=False), multipliers
        sizes = [np.abs(cost[self.usable]).max(initial=0.0), np.abs(many.visits).max(initial=0.0)]
        prices = [*(load.price for load in many.loads), *(price for _, price in many.moves), *(-row.price for row in many.rows)]
        size = math.fsum([*sizes, *prices])
        if not math.isfinite(64.0 * size * len(cost) ** 2):
            raise OverflowError
        self.exponent = min(59 - math.frexp(size * (levels.most + 2))[1] if size > 0 else finest, finest)
        self.visits = self._whole(many.visits)
        self.constant = sum(self.visits.tolist())
        reduced = np.floor(np.ldexp(np.where(self.usable, cost, 0.0), self.exponent)).astype(np.int64)
        reduced[:, 1:] -= self.visits
        for load in many.loads:
            self.work -= len(load.sites) * len(cost)
            if self.work < 0:
                break
            price = int(self._whole(load.price))
            reduced[:, load.sites] -= price
            reduced[np.ix_(load.sites, load.sites)] += price
            self.constant += load.least * price
        for among, each in many.moves:
            reduced[among] -= self._whole(each)
            self.constant += int(self._whole(each))
        # Rows of no price are of no use.
        self.rows = [(row, price) for row in many.rows if (price := -int(self._whole(row.price))) > 0]
        self.constant -= sum(row.most * price for row, price in self.rows)
        self.reduced = reduced
        self._levels = {False: levels}
        self._networks: dict[bool, Network] = {}
        self._rest: dict[tuple[bool, int | None], Integers] = {}

    def _whole(self, values: Floats | float) -> Integers:
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

    def bounded(self, limit: int) -> tuple[Network, Integers]:
        """The network of all walks, and at most what is left to pay on those that cost less than ``limit``, as of ``completions``."""
        network, rest = self._begun(counted=False, marked=None)
        return network, self._sharpened(network, rest, limit, wanted=False, levels=self._levels[False])

    def _begun(self, *, counted: bool, marked: int | None) -> tuple[Network, Integers]:
        """The network, with the moves that set ``marked`` needs, and what is left to pay at most."""
        from .walk_kernels import completions

        if counted not in self._networks:
            levels = self._levels.setdefault(counted, whole_levels(self.resources, self.usable, counted=counted))
            self._networks[counted] = network_of(self.reduced, self.usable, levels, self.multipliers.listed, self.rows)
        network = self._networks[counted]
        if marked is not None:
            network = with_needed(network, self.needed[marked][self.usable].astype(np.int64))
        if (counted, marked) not in self._rest:
            self._rest[counted, marked] = completions(self.stop.flag, network, 1 if marked is None else 2)
            self.work -= int(network.grid[2]) * len(network.moves)
        return network, self._rest[counted, marked]

    def _searched(self, which: int | None, limit: int, *, counted: bool) -> tuple[int | None, int]:
        """The least cost that was found, and the visits of the walk that has it, 0 without."""
        marked = which if which is not None or not self.needed else 0
        network, rest = self._begun(counted=counted, marked=marked)
        wanted, visits = which is not None, 0

        status, found, length = self._run(network, rest, limit, wanted, QUICK, careful=False)
        if status == DONE and found < limit:
            limit, visits = found, length
        if status != STOPPED:
            status, found, length = self._run(network, rest, limit, wanted, QUICK)
        if status == FULL and self.work > 0:
            rest = self._sharpened(network, rest, limit, wanted, self._levels[counted])
            status, found, length = self._run(network, rest, limit, wanted, self.work)
        if status != DONE:
            return None, 0
        return (found, length) if found < limit else (limit, visits)

    def _run(
        self, network: Network, rest: Integers, limit: int, wanted: bool, work: int, seen: Integers = _NOTHING, *, careful: bool = True
    ) -> tuple[int, int, int]:
        """Status, least cost and visits, as of ``least_walk``."""
        from .walk_kernels import least_walk

        most = self.room if work > QUICK else min(self.room, QUICK_ROOM)
        room = min(most, WORDS // (1 + len(network.start) + network.listed.shape[1] // BITS + network.turned.shape[1]))
        work = min(work, self.work)
        status, found, length, looked = least_walk(self.stop.flag, network, rest, limit, wanted, careful, seen, room, work)
        self.work -= looked
        return status, found, length

    def _sharpened(self, network: Network, rest: Integers, limit: int, wanted: bool, levels: Levels) -> Integers:
        """``rest``, or more by what walks cost that go backwards from the depot, on which fewer are remembered."""
        from .walk_kernels import completions

        turned = network_of(self.reduced.T.copy(), self.usable.T, levels.backwards(), self._fewer_listed(), self.rows)
        if wanted:
            marks = np.zeros(self.usable.shape, np.int64)
            marks[self.usable] = network.moves[:, 1]
            turned = with_needed(turned, marks.T[self.usable.T])
        seen = np.full((1 + wanted, len(self.usable), int(turned.grid[2])), FAR)
        if self._run(turned, completions(self.stop.flag, turned, 1 + wanted), limit, wanted, self.work // 2, seen)[0] != DONE:
            return rest
        # Whoever stands at a level can still be met by those who come backwards to no more than it, negated.
        begins = network.grid[0] + (np.arange(network.grid[2]) << network.grid[1])
        last = (-begins - turned.grid[0]) >> turned.grid[1]
        least = np.minimum.accumulate(seen, axis=2)[:, :, np.clip(last, 0, None)]
        least[:, :, last < 0] = FAR
        sharper = rest.copy()
        sharper[: 1 + wanted, 1:, :, :2] = np.maximum(sharper[: 1 + wanted, 1:, :, :2], least[:, 1:, :, None])
        return sharper

    def _fewer_listed(self) -> Ints:
        """The few nearest of those who are remembered at each customer, by what it costs to go there or to come back."""
        listed = self.multipliers.listed
        near = np.minimum(self.cost, self.cost.T)[np.arange(len(listed))[:, None], listed]
        order = np.argsort(np.where(listed < 0, math.inf, near), axis=1, kind="stable")
        return np.take_along_axis(listed, order[:, :FEW], axis=1)
