"""Groups, shipments, several windows and stops at depots, beside the arcs and times of the three-index form.

With v_i = sum over all k and j of x_ijk, whether node i is visited::

    group[g]         sum over the members of v_i = 1                      (<= 1 where the group is not required)
    together[p,d,k]  sum_j x_pjk = sum_j x_djk                            each shipment, from p to d; each k
    precedes[p,d]    u_p - u_d + n v_p <= n - 1                           u: visit numbers, which grow along every arc
    window[i]        sum_m w_im = 1,  w binary                            sites with windows [a_im, b_im], m = 1, 2, ...
    opens[i,k]       t_ik >= sum_m a_im w_im
    closes[i,k]      t_ik <= sum_m b_im w_im                              ends clipped to the range of t_ik
    outside[i,m,k]   w_im + sum_j x_ijk <= 1                              windows apart from that range
    copy[c]          v_c+1 <= v_c                                         copies of one depot are used in order
"""

import numpy as np

from ...programs.program import Floats
from ...programs.rows import Ints, Part, rows
from ..preparation import copies
from ..problem import RoutingProblem
from ._vehicles import Drive, VehicleBlocks, VehicleColumns


def add_groups(blocks: VehicleBlocks) -> None:
    """At most one of each group is visited."""
    groups = blocks.problem.sites.groups
    if not groups:
        return
    node = _nodes(blocks.problem)
    members = np.array([node[site] for g in groups for site in g.sites])
    of = np.repeat(np.arange(len(groups)), [len(g.sites) for g in groups])
    parts: list[Part] = []
    for number in range(len(groups)):
        parts += [(np.full(len(r), number), c, v) for r, c, v in blocks.visits(members[of == number])]
    blocks.add_groups(parts)


def add_shipments(blocks: VehicleBlocks, order: int) -> None:
    """One vehicle picks up and delivers, in this order; ``order`` is the column of the first node's visit number."""
    shipments = blocks.problem.sites.shipments
    if not shipments:
        return
    node, n = _nodes(blocks.problem), blocks.nodes
    first, last = (np.array([node[getattr(s, end)] for s in shipments]) for end in ("pickup", "delivery"))
    for kind in blocks.types:
        count = kind.count
        parts: list[Part] = []
        for number, (p, d) in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
            for at, sign in ((p, 1.0), (d, -1.0)):
                arcs = np.nonzero(kind.tail == at)[0]
                parts.append((np.tile(number * count + np.arange(count), len(arcs)), kind.together(arcs), sign))
        keys = (np.repeat(first, count), np.repeat(last, count), np.tile(kind.vehicles, len(shipments)))
        blocks.rows.append(rows("together", len(keys[0]), parts, 0.0, 0.0, keys, (blocks.names, blocks.names, kind.numbers)))
    row = np.arange(len(shipments))
    parts = [(row, order + first - 1, 1.0), (row, order + last - 1, -1.0)]
    for number, p in enumerate(first.tolist()):
        parts += [(np.full(len(r), number), c, float(n)) for r, c, _ in blocks.visits(np.array([p]))]
    blocks.rows.append(rows("precedes", len(shipments), parts, upper=n - 1.0, keys=(first, last), labels=(blocks.names, blocks.names)))


def add_windows(blocks: VehicleBlocks) -> None:
    """The window in which each site is served, of several."""
    windows = blocks.types[0].windows
    if not windows:
        return
    site = np.repeat(list(windows), [len(w) for w in windows.values()])
    number = np.concatenate([np.arange(len(w)) for w in windows.values()])
    ends = np.array([pair for w in windows.values() for pair in w])
    size = len(site)
    first = blocks.add_columns("w", (site, number + 1), (blocks.names, None), 0.0, 1.0, integer=True)
    nodes, row = np.unique(site, return_inverse=True)
    column = first + np.arange(size)
    blocks.rows.append(rows("window", len(nodes), [(row, column, 1.0)], 1.0, 1.0, (nodes,), (blocks.names,)))
    for kind in blocks.types:
        count = kind.count
        keys, labels = (np.repeat(nodes, count), np.tile(kind.vehicles, len(nodes))), (blocks.names, kind.numbers)
        every = np.arange(len(nodes) * count)
        times = (kind.clock + nodes[:, None] * count + np.arange(count)).ravel()
        entry = (row[:, None] * count + np.arange(count)).ravel()
        low, high = kind.lower[site], kind.upper[site]
        for name, end, side in (("opens", ends[:, 0], "lower"), ("closes", ends[:, 1], "upper")):
            value = np.repeat(-np.clip(end, low, high), count)
            blocks.rows.append(
                rows(name, len(every), [(every, times, 1.0), (entry, np.repeat(column, count), value)], **{side: 0.0}, keys=keys,
                     labels=labels)
            )  # fmt: skip
        slack = kind.prep.time.tolerance
        _outside(blocks, kind, site, number, column, (ends[:, 0] > high + slack) | (ends[:, 1] < low - slack))

    def encode(x: Floats, drives: list[Drive]) -> None:
        x[first : first + size] = number == 0
        visiting = {}
        for d in drives:
            for node, at in zip(d.nodes.tolist(), d.clock.tolist(), strict=True):
                if node in windows:
                    visiting[node] = d.kind, d.number
                    mine = np.nonzero(site == node)[0]
                    x[first + mine] = 0.0
                    x[first + mine[int(np.argmin(np.maximum(ends[mine, 0] - at, at - ends[mine, 1])))]] = 1.0
        chosen = x[column] == 1.0
        for node, opens in zip(site[chosen].tolist(), ends[chosen, 0].tolist(), strict=True):
            for kind in blocks.types:
                for k in range(kind.count):
                    if visiting.get(node) != (kind, k):
                        x[kind.clock + node * kind.count + k] = np.clip(opens, kind.lower[node], kind.upper[node])

    blocks.encoders.append(encode)


def _outside(blocks: VehicleBlocks, kind: VehicleColumns, site: Ints, number: Ints, column: Ints, apart: Ints) -> None:
    at = np.nonzero(apart)[0]
    if not len(at):
        return
    count = kind.count
    parts: list[Part] = []
    for row, k in enumerate(at.tolist()):
        arcs = np.nonzero(kind.tail == site[k])[0]
        here = row * count + np.arange(count)
        parts += [(here, np.full(count, column[k]), 1.0), (np.tile(here, len(arcs)), kind.together(arcs), 1.0)]
    keys = (np.repeat(site[at], count), np.repeat(number[at] + 1, count), np.tile(kind.vehicles, len(at)))
    blocks.rows.append(rows("outside", len(at) * count, parts, upper=1.0, keys=keys, labels=(blocks.names, None, kind.numbers)))


def add_copies(blocks: VehicleBlocks) -> None:
    """Copies of one depot are used in order."""
    stops = copies(blocks.problem)
    node = np.nonzero(stops[1:] == stops[:-1])[0] + 1 + len(blocks.problem.customers)
    if len(node):
        parts: list[Part] = [*((r, c, -1.0) for r, c, _ in blocks.visits(node)), *blocks.visits(node + 1)]
        blocks.rows.append(rows("copy", len(node), parts, upper=0.0, keys=(np.arange(1, len(node) + 1),)))


def _nodes(problem: RoutingProblem) -> dict[int, int]:
    """Node of each customer."""
    return {site: k for k, site in enumerate(problem.customers.tolist(), start=1)}
