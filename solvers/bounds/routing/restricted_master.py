"""The restricted master program of column generation: routes at hand, cuts, and the linear program that chooses among them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ....formulations.programs.program import Program, Rows, Variables
from ....formulations.stop import Stop
from ...linear_session import LinearResult, LinearSession
from .arcs import Flags, Floats, Longs


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
    """Routes as walks over nodes, the depot being node 0 at both ends."""

    def __init__(self) -> None:
        self.routes: list[Longs] = []
        self.known: dict[bytes, int] = {}
        self.tail, self.head, self.owner = (np.zeros(0, np.int64) for _ in range(3))
        self.begin = np.zeros(1, np.int64)
        self.twice = np.zeros(0, bool)

    def __len__(self) -> int:
        return len(self.routes)

    def new(self, routes: Sequence[Longs]) -> list[Longs]:
        """The routes that are not in the pool, each once."""
        fresh: dict[bytes, Longs] = {}
        for route in routes:
            key = route.tobytes()
            if key not in self.known:
                fresh.setdefault(key, route)
        return list(fresh.values())

    def add(self, routes: Sequence[Longs]) -> None:
        if not routes:
            return
        sizes = np.array([len(route) + 1 for route in routes])
        ends = np.cumsum(sizes)
        visits = np.concatenate(routes)
        tails, heads = np.zeros(ends[-1], np.int64), np.zeros(ends[-1], np.int64)
        inner = np.ones(ends[-1], bool)
        inner[ends - 1] = False
        heads[inner] = visits
        tails[1:][inner[:-1]] = visits
        for k, route in enumerate(routes, start=len(self.routes)):
            self.known[route.tobytes()] = k
        self.begin = np.concatenate([self.begin, self.begin[-1] + ends])
        self.tail, self.head = np.concatenate([self.tail, tails]), np.concatenate([self.head, heads])
        self.owner = np.concatenate([self.owner, np.repeat(np.arange(len(self.routes), len(self.routes) + len(routes)), sizes)])
        self.twice = np.concatenate([self.twice, [len(set(route.tolist())) < len(route) for route in routes]])
        self.routes.extend(routes)

    def keep(self, kept: Flags) -> None:
        """Drop all other routes."""
        routes = [route for route, flag in zip(self.routes, kept.tolist(), strict=True) if flag]
        Pool.__init__(self)
        self.add(routes)

    def sums(self, matrix: NDArray[np.generic], first: int = 0) -> Floats:
        """Sum of a matrix (nodes, nodes) over the moves of each route from number ``first`` on."""
        at = self.begin[first]
        values = matrix[self.tail[at:], self.head[at:]]
        return np.bincount(self.owner[at:] - first, values, minlength=len(self.routes) - first).astype(np.float64)

    def flow(self, values: Floats, nodes: int) -> Floats:
        """How often each move is made where each route has a value; later routes have none."""
        flow, values = np.zeros((nodes, nodes)), np.append(values, np.zeros(len(self.routes) - len(values)))
        np.add.at(flow, (self.tail, self.head), values[self.owner])
        return flow


@dataclass(eq=False)
class Prices:
    """Dual values: of the number of routes, of ``visits`` (nodes,), entry 0 for the depot being 0, and of cuts, where they are not 0."""

    routes: float
    visits: Floats
    cuts: dict[Cut, float]

    def mixed(self, other: Prices, share: float, cuts: Sequence[Cut]) -> Prices:
        """These prices and ``share`` of others, those of no other ``cuts``."""
        both = {cut: (1 - share) * self.cuts.get(cut, 0.0) + share * other.cuts.get(cut, 0.0) for cut in cuts}
        routes, visits = (1 - share) * self.routes + share * other.routes, (1 - share) * self.visits + share * other.visits
        return Prices(routes, visits, {cut: price for cut, price in both.items() if price})

    def of(self, cuts: Sequence[Cut]) -> Floats:
        """Prices of some cuts."""
        return np.array([self.cuts.get(cut, 0.0) for cut in cuts])


@dataclass(eq=False)
class Point:
    """The end of a linear program: ``values`` and ``reduced`` costs of the routes, ``lacking``, how much of the visits no route makes up
    for."""

    status: str
    value: float = math.nan
    values: Floats = field(default_factory=lambda: np.zeros(0))
    reduced: Floats = field(default_factory=lambda: np.zeros(0))
    lacking: float = 0.0
    prices: Prices | None = None


class Master:
    """The linear program over the routes of a pool: visits, the number of routes, cuts, and columns for what no route makes up for.

    ``cost``, shape (nodes, nodes), is that of moves, finite; ``lacking``, shape (nodes,), the price of a visit that no route makes, in
    entry 0 that of a route too few or too many.
    """

    def __init__(self, pool: Pool, cost: Floats, lacking: Floats, seed: int, cuts: Sequence[Cut] = ()) -> None:
        n = len(lacking)
        self.pool, self.cost, self.lacking, self.seed, self.known, self.nodes = pool, cost, lacking, seed, 0, n
        # Row 0 counts routes against the column before the last ones; columns: missing visits, routes too few, too many, their number.
        columns = Variables(
            "missing", lower=np.zeros(n + 2), upper=np.append(np.full(n + 1, math.inf), n), cost=np.append(lacking, [lacking[0], 0.0])
        )
        indptr = np.append([0, 3], np.arange(4, n + 3)).astype(np.int32)
        indices = np.concatenate([[0, n, n + 1], np.arange(1, n)]).astype(np.int32)
        right = np.append(0.0, np.ones(n - 1))
        rows = Rows("visits", indptr=indptr, indices=indices, data=np.append([1.0, -1.0, -1.0], np.ones(n - 1)), lower=right, upper=right)
        self.session = LinearSession(Program("routes", "min", (columns,), (rows,)), seed)
        self.own = n + 2
        self.cuts: list[Cut] = []
        self.refresh()
        self.cut(cuts)

    def refresh(self) -> None:
        """Add the routes that are new in the pool."""
        first, pool = self.known, self.pool
        size = len(pool) - first
        if not size:
            return
        at = pool.begin[first]
        owner, head = pool.owner[at:] - first, pool.head[at:]
        entries = np.zeros((size, self.nodes + len(self.cuts)))
        entries[:, : self.nodes] = np.bincount(owner * self.nodes + head, minlength=size * self.nodes).reshape(size, self.nodes)
        entries[:, 0] = 1.0
        entries[:, self.nodes :] = coefficients(self.cuts, pool, first) * [cut.sign for cut in self.cuts]
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
        entries[:, 1 : self.nodes] = [cut.missing(self.nodes) for cut in cuts]
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
        self.session.remove_rows(np.array(at, dtype=np.int64) + self.nodes)
        self.cuts = [cut for cut in self.cuts if id(cut) not in gone]

    def keep(self, kept: Flags) -> None:
        """Drop all other routes, in the pool too."""
        self.session.remove_columns(self.own + np.nonzero(~kept)[0])
        self.pool.keep(kept)
        self.known = len(self.pool)

    def restrict(self, shut: Flags, fewest: int, most: int) -> None:
        """Shut some routes, and limit their number."""
        lower, upper = self.session.lower.copy(), self.session.upper.copy()
        lower[self.own - 1], upper[self.own - 1] = fewest, most
        upper[self.own :] = np.where(shut, 0.0, math.inf)
        self.session.primal(False)
        self.session.bound(lower, upper)

    def solve(self, stop: Stop) -> Point:
        result: LinearResult = self.session.solve(stop)
        if result.status != "optimal":
            return Point(result.status)
        duals = zip(self.cuts, result.duals[self.nodes :].tolist(), strict=True)
        visits = result.duals[: self.nodes].copy()
        visits[0] = 0.0
        prices = Prices(float(result.duals[0]), visits, {cut: max(0.0, dual) * cut.sign for cut, dual in duals if dual > 0.0})
        return Point(
            "optimal", result.value, result.x[self.own :], result.reduced[self.own :], float(result.x[: self.own - 1].sum()), prices
        )
