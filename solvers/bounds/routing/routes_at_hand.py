"""The best answer that routes at hand make up, by an integer program (restricted master heuristic)."""

from dataclasses import replace

import numpy as np

from ....formulations.programs.program import Program, Rows, Variables
from ....formulations.routing.routes import Routes
from ....formulations.stop import Stop
from ...backend import Control, Options
from .arcs import Flags, Floats
from .restricted_master import Pool
from .set_partition import SetPartition

MOST = 2000
"""Most routes that are looked at, the cheapest by reduced costs."""

NODES = 2000
"""Nodes of branch and bound at most, so that on any machine the same answer is found."""


def best_choice(pool: Pool, partition: SetPartition, reduced: Floats, gap: float, seconds: float, stop: Stop) -> Routes | None:
    """The cheapest choice of the routes whose ``reduced`` costs are below ``gap``; None where there is none, or not soon.

    ``reduced`` has one entry for each of the first routes of the pool.
    """
    from ...backends.highs import Highs

    good = np.nonzero((reduced < gap) & ~pool.twice[: len(reduced)])[0]
    good = np.sort(good[np.argsort(reduced[good], kind="stable")[:MOST]])
    some = Pool()
    some.add(pool.drives(good))
    if not len(some):
        return None
    cost = some.sums(partition.cost)
    program = _program(some, partition, cost / max(float(np.abs(cost).max()), 1e-300))
    control = Control()
    options = replace(Options(), time_limit=seconds, gap=0.0, iterations=NODES)
    with stop.telling(control.stop):
        vector = Highs().search(program, options, control).answer
    if vector is None:
        return None
    return partition.routes(some.drives(np.nonzero(vector[: len(some)] > 0.5)[0]))


def _program(pool: Pool, partition: SetPartition, cost: Floats) -> Program:
    """Each visit is made by one route, or need not be; numbers of routes are within their limits, of each type and of all."""
    from scipy import sparse

    size, visits, types = len(pool), len(partition.optional) - 1, len(partition.types)
    loose: Flags = partition.optional[1:]
    at = np.nonzero(pool.head)[0]
    free = np.nonzero(loose)[0]
    rows = np.concatenate([partition.row[pool.head[at]] - 1, free, visits + pool.kind, np.full(size, visits + types)])
    columns = np.concatenate([pool.owner[at], size + np.arange(len(free)), np.arange(size), np.arange(size)])
    table = sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=(visits + types + 1, size + len(free)))
    counts = np.array([one.most for one in partition.types], dtype=np.float64)
    limits = Rows(
        "visits and routes", indptr=table.indptr.astype(np.int32), indices=table.indices.astype(np.int32), data=table.data,
        lower=np.concatenate([np.ones(visits), np.zeros(types), [partition.fewest]]),
        upper=np.concatenate([np.ones(visits), counts, [partition.most]]),
    )  # fmt: skip
    every = size + len(free)
    chosen = Variables("chosen", lower=np.zeros(every), upper=np.ones(every), cost=np.append(cost, np.zeros(len(free))), integer=True)
    return Program("routes at hand", "min", (chosen,), (limits,))
