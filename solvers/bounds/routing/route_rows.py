"""Rows over whole routes, of which only the customers count: of weights that are rounded down, and of sets that several routes visit."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from .arcs import Flags, Floats
from .restricted_master import Pool

LEAST = 0.02
"""Least violation."""

ROOM = 20_000
"""Most violated sets of three that are looked at."""

MOST, EACH = 80, 6
"""Most rows that are added at once, and those of one customer among them."""

KINDS = (((2, 1, 1, 1), 3), ((1,) * 5, 3), ((2, 2, 1, 1, 1), 4), ((3, 1, 1, 1, 1), 4), ((3, 2, 2, 1, 1), 5), ((1,) * 5, 2),
         ((2, 2, 1, 1, 1), 3), ((3, 3, 2, 2, 1), 4))  # fmt: skip
"""Weights and parts that no others of four or five customers surpass (Pecin, Pessoa, Poggi, Uchoa, Santos 2017)."""


def visited(pool: Pool, first: int, nodes: int) -> Flags:
    """Which customers each route from number ``first`` on visits, shape (routes, nodes)."""
    at = pool.begin[first]
    visits = np.zeros((len(pool) - first, nodes), bool)
    visits[pool.owner[at:] - first, pool.head[at:]] = True
    visits[:, 0] = False
    return visits


@dataclass(frozen=True, eq=False)
class RouteRow:
    """Routes have ``parts`` of the ``weights`` of those whom they visit only so often, rounded down (Chvátal 1973); halves by default."""

    customers: tuple[int, ...]
    weights: tuple[int, ...] = ()
    parts: int = 2
    sign: int = field(default=-1, init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "weights", self.weights or (1,) * len(self.customers))

    @property
    def key(self) -> tuple[object, ...]:
        """The same for the same row."""
        return (*sorted(zip(self.customers, self.weights, strict=True)), self.parts)

    @property
    def right(self) -> float:
        return float(sum(self.weights) // self.parts)

    def missing(self, nodes: int) -> Floats:
        return np.zeros(nodes - 1)

    def counted(self, visits: Flags) -> Floats:
        """Coefficients of routes, given as whom they visit, shape (routes, nodes)."""
        total = visits[:, self.customers].astype(np.int64) @ np.array(self.weights)
        counted: Floats = (total // self.parts).astype(np.float64)
        return counted

    @staticmethod
    def coefficients(rows: "Sequence[RouteRow | RouteLoad]", pool: Pool, first: int) -> Floats:
        nodes = 1 + max(int(pool.head.max(initial=0)), max(max(row.customers) for row in rows))
        visits = visited(pool, first, nodes)
        return np.array([row.counted(visits) for row in rows]).T


@dataclass(frozen=True, eq=False)
class RouteLoad:
    """At least ``right`` routes visit some of the customers."""

    customers: tuple[int, ...]
    right: float
    sign: int = field(default=1, init=False)

    def missing(self, nodes: int) -> Floats:
        return np.isin(np.arange(1, nodes), self.customers).astype(np.float64)

    def counted(self, visits: Flags) -> Floats:
        """Coefficients of routes, given as whom they visit, shape (routes, nodes)."""
        return np.asarray(visits[:, self.customers].any(axis=1), dtype=np.float64)

    @staticmethod
    def coefficients(rows: "Sequence[RouteLoad]", pool: Pool, first: int) -> Floats:
        return RouteRow.coefficients(rows, pool, first)


def violated_rows(visits: Flags, values: Floats, known: set[tuple[object, ...]]) -> list[RouteRow]:
    """Rows of three to five customers that a point violates most and that are not ``known``; ``visits``, shape (nodes, routes)."""
    from .route_row_kernels import violated_weights
    from .subset_row_kernels import violated_triples

    visits, values = np.ascontiguousarray(visits), np.ascontiguousarray(values)
    whom = visits.astype(np.float64)
    triples, excess = np.zeros((ROOM, 3), np.int64), np.zeros(ROOM)
    number = violated_triples((whom * values) @ whom.T, whom, values, LEAST, triples, excess)
    seen = list(zip(excess[:number].tolist(), map(RouteRow, map(tuple, triples[:number].tolist())), strict=True))
    for weights, parts in KINDS:
        members, excess = np.zeros((len(visits), len(weights)), np.int64), np.zeros(len(visits))
        number = violated_weights(visits, values, np.array(weights), parts, LEAST, members, excess)
        seen += [(excess[k], RouteRow(tuple(members[k].tolist()), weights, parts)) for k in range(number)]
    counts, rows, known = np.zeros(len(visits), np.int64), list[RouteRow](), set(known)
    for _, row in sorted(seen, key=lambda pair: -pair[0]):
        at = list(row.customers)
        if counts[at].max() < EACH and row.key not in known:
            counts[at] += 1
            known.add(row.key)
            rows.append(row)
        if len(rows) == MOST:
            break
    return rows
