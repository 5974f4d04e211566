"""Subset-row cuts: of a few customers, routes visit two only so often (Jepsen, Petersen, Spoorendonk, Pisinger 2008)."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .arcs import Flags, Floats, Integers
from .restricted_master import Pool

LEAST = 0.02
"""Least violation."""

ROOM = 20_000
"""Most violated sets that are looked at."""

MOST, EACH = 60, 6
"""Most cuts that are added at once, and those of one customer among them."""


@dataclass(frozen=True, eq=False)
class SubsetRow:
    """A cut for an odd number of customers: all routes together make at most half as many pairs of visits to them, rounded down.

    The first visit of a pair is remembered while the route stays at nodes of ``memory`` (nodes,) (Pecin, Pessoa, Poggi, Uchoa 2017).
    """

    customers: tuple[int, ...]
    memory: Flags
    sign: int = -1

    @property
    def right(self) -> float:
        return float(len(self.customers) // 2)

    def missing(self, nodes: int) -> Floats:
        return np.zeros(nodes - 1)

    @staticmethod
    def coefficients(cuts: "Sequence[SubsetRow]", pool: Pool, first: int) -> Floats:
        from .subset_row_kernels import count_pairs

        inside, pairs = np.zeros((len(cuts), len(cuts[0].memory)), bool), np.zeros((len(pool) - first, len(cuts)))
        for row, cut in zip(inside, cuts, strict=True):
            row[list(cut.customers)] = True
        count_pairs(pool.begin, pool.head, inside, np.array([cut.memory for cut in cuts]), first, pairs)
        return pairs


def violated(pool: Pool, values: Floats, nodes: int, known: dict[tuple[int, ...], SubsetRow]) -> list[SubsetRow]:
    """The most violated cuts of a point of the linear program, with memories that just do for its routes.

    A cut of ``known`` customers is one whose memory grows.
    """
    from .subset_row_kernels import violated_triples

    used = np.nonzero(values > 1e-6)[0]
    visits = np.zeros((nodes, len(used)))
    for column, k in enumerate(used.tolist()):
        visits[pool.routes[k], column] = 1.0
    at = np.ascontiguousarray(values[used])
    triples, excess = np.zeros((ROOM, 3), np.int64), np.zeros(ROOM)
    number = violated_triples((visits * at) @ visits.T, visits, at, LEAST, triples, excess)
    order = np.argsort(-excess[:number], kind="stable")
    counts, rows = np.zeros(nodes, np.int64), []
    for row in triples[order].tolist():
        if counts[row].max() >= EACH:
            continue
        counts[row] += 1
        memory = _memory(pool, used, row, nodes)
        before = known.get(tuple(row))
        rows.append(SubsetRow(tuple(row), memory if before is None else memory | before.memory))
        if len(rows) == MOST:
            break
    return rows


def _memory(pool: Pool, used: Integers, row: list[int], nodes: int) -> Flags:
    """The fewest nodes that must be remembered for all routes that visit two or three of the customers to count."""
    memory = np.zeros(nodes, bool)
    memory[row] = True
    inside = set(row)
    for k in used.tolist():
        route = pool.routes[k]
        places = [p for p, node in enumerate(route.tolist()) if node in inside]
        if len(places) < 2:
            continue
        spans = [route[a + 1 : b] for a, b in pairwise(places)]
        if len(places) % 2:
            least = min(spans, key=lambda span: int((~memory[span]).sum()))
            spans = [least] if len(places) == 3 else spans
        else:
            spans = spans[::2]
        for span in spans:
            memory[span] = True
    return memory
