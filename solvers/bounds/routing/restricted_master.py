"""The restricted master program of column generation: routes at hand, cuts, and the linear program that chooses among them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ....formulations.programs.program import Program, Variables
from ....formulations.programs.rows import Part, rows
from ....formulations.stop import Stop
from ...linear_session import LinearResult, LinearSession
from .arcs import Flags, Floats, Integers
from .memory_shares import ROUTE, VISIT

Drive = tuple[int, Integers]
"""The number of a type of vehicle, and the nodes that one of them visits."""


class Cut(Protocol):
    """A row over routes: its coefficients add up to ``right`` at most (``sign`` -1) or at least (1)."""

    @property
    def sign(self) -> int: ...

    @property
    def right(self) -> float: ...

    def missing(self, nodes: int) -> Floats:
        """Coefficients of visits that no route makes, shape (nodes - 1,)."""

    @staticmethod
    def coefficients(cuts: Sequence[Any], pool: Pool, first: int) -> Floats:
        """Coefficients of routes in some cuts of this kind, shape (routes, cuts); routes before number ``first`` are left out."""


def coefficients(cuts: Sequence[Cut], pool: Pool, first: int) -> Floats:
    """Coefficients of the routes from number ``first`` on in cuts of any kinds, shape (routes, cuts)."""
    table = np.zeros((len(pool) - first, len(cuts)))
    for kind in {type(cut) for cut in cuts}:
        at = [c for c, cut in enumerate(cuts) if type(cut) is kind]
        table[:, at] = kind.coefficients([cuts[c] for c in at], pool, first)
    return table


class Pool:
    """Routes as walks over nodes, the depot being node 0 at both ends, each of the vehicles of one ``kind``, a number of a type."""

    def __init__(self) -> None:
        self.routes: list[Integers] = []
        self.known: set[bytes] = set()
        self.tail, self.head, self.owner, self.kind = (np.zeros(0, np.int64) for _ in range(4))
        self.begin = np.zeros(1, np.int64)
        self.twice = np.zeros(0, bool)

    def __len__(self) -> int:
        return len(self.routes)

    @property
    def bytes(self) -> int:
        """Memory that the routes take, with their columns, at most."""
        return ROUTE * len(self.routes) + VISIT * len(self.tail)

    def new(self, drives: Sequence[Drive]) -> list[Drive]:
        """The routes that are not in the pool, each once."""
        fresh: dict[bytes, Drive] = {}
        for drive in drives:
            key = _key(*drive)
            if key not in self.known:
                fresh.setdefault(key, drive)
        return list(fresh.values())

    def add(self, drives: Sequence[Drive]) -> None:
        if not drives:
            return
        kinds, routes = zip(*drives, strict=True)
        sizes = np.array([len(route) + 1 for route in routes])
        ends = np.cumsum(sizes)
        visits = np.concatenate(routes)
        tails, heads = np.zeros(ends[-1], np.int64), np.zeros(ends[-1], np.int64)
        inner = np.ones(ends[-1], bool)
        inner[ends - 1] = False
        heads[inner] = visits
        tails[1:][inner[:-1]] = visits
        self.known.update(_key(*drive) for drive in drives)
        self.begin = np.concatenate([self.begin, self.begin[-1] + ends])
        self.tail, self.head = np.concatenate([self.tail, tails]), np.concatenate([self.head, heads])
        self.owner = np.concatenate([self.owner, np.repeat(np.arange(len(self.routes), len(self.routes) + len(routes)), sizes)])
        self.kind = np.concatenate([self.kind, np.array(kinds, np.int64)])
        self.twice = np.concatenate([self.twice, [len(set(route.tolist())) < len(route) for route in routes]])
        self.routes.extend(routes)

    def drives(self, chosen: Integers) -> list[Drive]:
        """Some of the routes, by their numbers."""
        return [(int(self.kind[k]), self.routes[k]) for k in chosen.tolist()]

    def keep(self, kept: Flags) -> None:
        """Drop all other routes."""
        drives = self.drives(np.nonzero(kept)[0])
        Pool.__init__(self)
        self.add(drives)

    def sums(self, matrix: NDArray[np.generic], first: int = 0) -> Floats:
        """Sum of a matrix, of shape (nodes, nodes) or (types, nodes, nodes), over the moves of each route from number ``first`` on."""
        at = self.begin[first]
        moves = self.tail[at:], self.head[at:]
        values = matrix[moves] if matrix.ndim == 2 else matrix[self.kind[self.owner[at:]], *moves]
        return np.bincount(self.owner[at:] - first, values, minlength=len(self.routes) - first).astype(np.float64)

    def flow(self, values: Floats, shape: tuple[int, ...]) -> Floats:
        """How often vehicles of each type make each move where each route has a value, of ``shape`` (types, nodes, nodes); later routes
        have none."""
        flow, values = np.zeros(shape), np.append(values, np.zeros(len(self.routes) - len(values)))
        np.add.at(flow, (self.kind[self.owner], self.tail, self.head), values[self.owner])
        return flow


def _key(kind: int, route: Integers) -> bytes:
    return kind.to_bytes(4, "little") + route.tobytes()


@dataclass(eq=False)
class Prices:
    """Dual values: of the number of ``routes`` of each type, of ``visits`` (nodes,), entry 0 for the depot being 0, and of cuts, where they
    are not 0."""

    routes: Floats
    visits: Floats
    cuts: dict[Cut, float]

    def mixed(self, other: Prices, share: float, cuts: Sequence[Cut]) -> Prices:
        """A convex combination of these prices and ``share`` of others, for the given ``cuts`` alone."""
        both = {cut: (1 - share) * self.cuts.get(cut, 0.0) + share * other.cuts.get(cut, 0.0) for cut in cuts}
        routes, visits = (1 - share) * self.routes + share * other.routes, (1 - share) * self.visits + share * other.visits
        return Prices(routes, visits, {cut: price for cut, price in both.items() if price})

    def of(self, cuts: Sequence[Cut]) -> Floats:
        """The prices of the given cuts; 0 for a cut that has none."""
        return np.array([self.cuts.get(cut, 0.0) for cut in cuts])


@dataclass(eq=False)
class Point:
    """The end of a linear program: ``values`` and ``reduced`` costs of the routes, ``lacking``, how much of the visits no route makes up
    for, and ``held``, how much of them the box around the prices does."""

    status: str
    value: float = math.nan
    values: Floats = field(default_factory=lambda: np.zeros(0))
    reduced: Floats = field(default_factory=lambda: np.zeros(0))
    lacking: float = 0.0
    held: float = 0.0
    prices: Prices | None = None


class Master:
    """The linear program over the routes of a pool: visits, the number of routes, cuts, and columns for what no route makes up for.

    ``cost``, shape (types, nodes, nodes), is that of moves, finite, and ``row``, shape (nodes,), has the row of each node's visits;
    ``lacking``, shape (1 + rows,), is the price of a visit that no route makes, in entry 0 that of a route too few or too many; ``most``
    has the largest number of routes of each type. ``boxed``: the prices of visits can be kept within a box.
    """

    def __init__(
        self, pool: Pool, cost: Floats, row: Integers, lacking: Floats, most: Sequence[int], seed: int, cuts: Sequence[Cut] = (), *,
        boxed: bool = False,
    ) -> None:  # fmt: skip
        self.pool, self.cost, self.row, self.lacking, self.seed, self.known = pool, cost, row, lacking, seed, 0
        visits, self.types = len(lacking) - 1, len(most) if len(most) > 1 else 0
        # Columns: missing visits, routes too few, too many, their number, visits that need not be made, visits more and less at the prices
        # of the box, and the number of each type.
        self.number, self.box_at, self.boxes = visits + 2, 2 * visits + 3, visits if boxed else 0
        self.own = self.box_at + 2 * self.boxes + self.types
        self.own_rows = 1 + visits + self.types
        upper = np.full(self.own, math.inf)
        upper[self.number], upper[self.number + 1 : self.box_at + 2 * self.boxes] = len(row), 0.0
        price = np.zeros(self.own)
        price[:visits], price[visits : visits + 2] = lacking[1:], lacking[0]
        v, box, t = np.arange(visits), np.arange(self.boxes), np.arange(self.types)
        of_type = self.own - self.types + t
        upper[of_type] = most[: self.types]
        parts: list[Part] = [
            (np.zeros(3, np.int64), np.array([visits, visits + 1, self.number]), [1.0, -1.0, -1.0]), (1 + v, v, 1.0),
            (1 + v, self.number + 1 + v, 1.0), (1 + box, self.box_at + box, 1.0), (1 + box, self.box_at + visits + box, -1.0),
            (0 * t, of_type, 1.0), (1 + visits + t, of_type, -1.0),
        ]  # fmt: skip
        right = np.repeat([0.0, 1.0, 0.0], [1, visits, self.types])
        columns = Variables("columns", lower=np.zeros(self.own), upper=upper, cost=price)
        self.session = LinearSession(Program("routes", "min", (columns,), (rows("rows", self.own_rows, parts, right, right),)), seed)
        self.cuts: list[Cut] = []
        self.branched: list[Cut] = []
        self.held: list[Cut] = []
        self.refresh()
        self.cut(cuts)

    def refresh(self) -> None:
        """Add the routes that are new in the pool."""
        first, pool = self.known, self.pool
        size = len(pool) - first
        if not size:
            return
        at = pool.begin[first]
        owner, width = pool.owner[at:] - first, self.own_rows
        entries = np.zeros((size, width + len(self.cuts)))
        entries[:, :width] = np.bincount(owner * width + self.row[pool.head[at:]], minlength=size * width).reshape(size, width)
        entries[:, 0] = 0.0
        entries[np.arange(size), width - self.types + pool.kind[first:] if self.types else 0] = 1.0
        entries[:, width:] = coefficients(self.cuts, pool, first) * [cut.sign for cut in self.cuts]
        columns, rows = np.nonzero(entries)
        starts = np.searchsorted(columns, np.arange(size))
        self.session.primal(True)
        self.session.add(pool.sums(self.cost, first), starts, rows, entries[columns, rows])
        self.known = len(pool)

    def cut(self, cuts: Sequence[Cut]) -> None:
        """Add rows."""
        if not cuts:
            return
        signs = np.array([cut.sign for cut in cuts])
        entries = np.zeros((len(cuts), self.own + self.known))
        entries[:, self.row[1:] - 1] = [cut.missing(len(self.row)) for cut in cuts]
        entries[:, self.own :] = coefficients(cuts, self.pool, 0)[: self.known].T
        rows, columns = np.nonzero(entries)
        starts = np.searchsorted(rows, np.arange(len(cuts)))
        self.session.primal(False)
        lower = np.array([cut.right for cut in cuts]) * signs
        self.session.add_rows(lower, starts, columns, entries[rows, columns] * signs[rows])
        self.cuts.extend(cuts)

    def drop(self, dropped: Sequence[Cut]) -> None:
        """Remove rows."""
        gone = {id(cut) for cut in dropped}
        at = [c for c, cut in enumerate(self.cuts) if id(cut) in gone]
        self.session.remove_rows(np.array(at, dtype=np.int64) + self.own_rows)
        self.cuts = [cut for cut in self.cuts if id(cut) not in gone]

    def keep(self, kept: Flags) -> None:
        """Drop all other routes, in the pool too."""
        self.session.remove_columns(self.own + np.nonzero(~kept[: self.known])[0])
        self.known = int(kept[: self.known].sum())
        self.pool.keep(kept)

    def hold(self, wanted: Sequence[Cut]) -> None:
        """Have those of ``branched``, rows that hold in some nodes of a tree, hold that are ``wanted``, and no others."""
        new = [row for row in wanted if row not in self.branched]
        self.cut(new)
        self.branched.extend(new)
        self.held.extend(new)
        for c, row in enumerate(self.cuts):
            if row in self.branched and (row in wanted) != (row in self.held):
                self.session.bound_row(self.own_rows + c, row.right if row in wanted else -math.inf)
        self.held = list(wanted)

    def forget(self, kept: Sequence[Cut]) -> None:
        """Remove the rows of branchings but those that are ``kept``."""
        self.hold([])
        self.drop([row for row in self.branched if row not in kept])
        self.branched = [row for row in self.branched if row in kept]

    def restrict(self, shut: Flags, fewest: int, most: int, left_out: Flags) -> None:
        """Shut some routes, limit their number, have the visits ``left_out``, shape (1 + rows,), be left out at no cost, and take the box
        away."""
        lower, upper = self.session.lower.copy(), self.session.upper.copy()
        lower[self.number], upper[self.number] = fewest, most
        upper[self.number + 1 : self.box_at] = np.where(left_out[1:], 1.0, 0.0)
        upper[self.number - 1], upper[self.box_at : self.box_at + 2 * self.boxes] = math.inf, 0.0
        upper[self.own :] = np.where(shut, 0.0, math.inf)
        self.session.primal(False)
        self.session.bound(lower, upper)

    def box(self, centre: Prices, radius: float) -> None:
        """Keep the prices of visits within ``radius`` of a centre until the next ``restrict``."""
        at = np.arange(self.box_at, self.box_at + 2 * self.boxes)
        middle = np.zeros(self.boxes)
        middle[self.row[1:] - 1] = centre.visits[1:]
        upper = self.session.upper.copy()
        upper[at], upper[self.number - 1] = math.inf, 0.0  # else, with a route too many at a price, the box may hold no prices at all
        self.session.primal(True)
        self.session.price(at, np.concatenate([middle + radius, radius - middle]))
        self.session.bound(self.session.lower, upper)

    def solve(self, stop: Stop) -> Point:
        result: LinearResult = self.session.solve(stop)
        if result.status != "optimal":
            return Point(result.status)
        duals = zip(self.cuts, result.duals[self.own_rows :].tolist(), strict=True)
        routes = result.duals[self.own_rows - self.types : self.own_rows] if self.types else result.duals[:1]
        visits = result.duals[self.row]
        visits[0] = 0.0
        prices = Prices(routes.copy(), visits, {cut: max(0.0, dual) * cut.sign for cut, dual in duals if dual > 0.0})
        lacking, held = (float(part.sum()) for part in (result.x[: self.number], result.x[self.box_at : self.box_at + 2 * self.boxes]))
        return Point("optimal", result.value, result.x[self.own :], result.reduced[self.own :], lacking, held, prices)
