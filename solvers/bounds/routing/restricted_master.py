"""The restricted master program of column generation, and the pool of routes that it chooses from."""

from __future__ import annotations

import math

import numpy as np

from ....formulations.programs.program import Program, Rows, Variables
from ...linear_session import LinearSession
from .arcs import Flags, Floats, Longs


class Pool:
    """All routes so far, as walks over nodes."""

    def __init__(self) -> None:
        self.routes: list[Longs] = []
        self.twice: list[bool] = []
        self._known: set[bytes] = set()
        self._tail, self._head, self._owner = (np.zeros(0, np.int64) for _ in range(3))

    def new(self, routes: list[Longs]) -> list[Longs]:
        """The routes that are not in the pool."""
        return [route for route in routes if route.tobytes() not in self._known]

    def add(self, routes: list[Longs]) -> None:
        self._known.update(route.tobytes() for route in routes)
        stops = [np.concatenate([[0], route, [0]]) for route in routes]
        lengths = [len(s) - 1 for s in stops]
        self._tail = np.concatenate([self._tail, *(s[:-1] for s in stops)])
        self._head = np.concatenate([self._head, *(s[1:] for s in stops)])
        self._owner = np.concatenate([self._owner, np.repeat(np.arange(len(self.routes), len(self.routes) + len(routes)), lengths)])
        self.routes.extend(routes)
        self.twice.extend(len(set(route.tolist())) < len(route) for route in routes)

    def sums(self, matrix: Floats) -> Floats:
        """Sum of a matrix over the moves of each route."""
        sums: Floats = np.bincount(self._owner, matrix[self._tail, self._head], minlength=len(self.routes)).astype(np.float64)
        return sums

    def flow(self, values: Floats, nodes: int) -> Floats:
        """How often each move is made where each route has a value; later routes have none."""
        flow, values = np.zeros((nodes, nodes)), np.append(values, np.zeros(len(self.routes) - len(values)))
        np.add.at(flow, (self._tail, self._head), values[self._owner])
        return flow

    def forgetful(self, near: Flags) -> Flags:
        """Which routes come back to a customer who is still remembered."""
        return np.array([twice and _comes_back(route, near) for route, twice in zip(self.routes, self.twice, strict=True)], dtype=bool)


def _comes_back(route: Longs, near: Flags) -> bool:
    kept: set[int] = set()
    for node in route.tolist():
        if node in kept:
            return True
        kept = {other for other in kept if near[node, other]} | {node}
    return False


class Master:
    """The linear program over the routes of a pool: visits, the number of routes, and columns for what no route makes up for.

    ``cost``, shape (nodes, nodes), is that of moves, finite; ``lacking``, shape (nodes,), the price of a visit that no route makes, in
    entry 0 that of a route too few or too many.
    """

    def __init__(self, pool: Pool, cost: Floats, lacking: Floats, seed: int) -> None:
        n = len(lacking)
        self.pool, self.cost, self.known = pool, cost, 0
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

    def refresh(self) -> None:
        """Add the routes that are new in the pool."""
        fresh = self.pool.routes[self.known :]
        if not fresh:
            return
        costs = self.pool.sums(self.cost)[self.known :]
        starts, rows, values = [], [], []
        size = 0
        for route in fresh:
            visits, times = np.unique(route, return_counts=True)
            starts.append(size)
            rows.append(np.append(0, visits))
            values.append(np.append(1.0, times))
            size += len(visits) + 1
        self.session.add(costs, np.array(starts), np.concatenate(rows), np.concatenate(values).astype(np.float64))
        self.known = len(self.pool.routes)

    def restrict(self, shut: Flags, fewest: int, most: int) -> None:
        """Shut some routes, and limit their number."""
        lower, upper = self.session.lower.copy(), self.session.upper.copy()
        lower[self.own - 1], upper[self.own - 1] = fewest, most
        upper[self.own :] = np.where(shut, 0.0, math.inf)
        self.session.bound(lower, upper)
