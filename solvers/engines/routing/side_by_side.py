"""One search on several threads: routes near to each other are a thread's own for a moment, then all are shared out anew.

What is known of sites, moves and neighbours is common to all threads. Rows of routes and of visits are copied, those of a part for each
thread, so that nobody waits for another one; a customer of another part is like one that is on no route.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from copy import copy
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ....formulations.stop import Stop
from ...backend import Control
from .ruin_recreate_steps import columns as k
from .ruin_recreate_steps.dividing import divided

if TYPE_CHECKING:
    from .integer_scales import Floats, Integers
    from .ruin_recreate_steps.arrays import Arrays
    from .ruin_recreate_steps.partition import Pool

LEAST = 4
"""Routes of a thread at least: what one of them loses must find room on others."""

MOMENT = 0.03
"""Seconds for which routes are a thread's own."""

LINKS = [k.FOLLOWING, k.PREVIOUS]


@dataclass(frozen=True, eq=False)
class Share:
    """A part of the routes: arrays of its own, which routes and nodes of the whole their rows are, and its best answer, value first."""

    held: Arrays
    slots: Integers
    nodes: Integers
    best: Integers

    @property
    def own(self) -> Integers:
        """Its nodes: customers, then ends of routes."""
        return np.concatenate([self.held.customers, np.arange(len(self.held.site), len(self.nodes))])


def following(held: Arrays) -> Integers:
    """Value and successor of each node of the routes at hand."""
    return np.append(held.sums[k.OBJECTIVE], np.where(held.node[:, k.ROUTE] >= 0, held.node[:, k.FOLLOWING], -1))


def part(held: Arrays, slots: Integers, absent: Integers, seed: int) -> Share:
    """The part of these routes, ascending, and of these customers on no route."""
    sites = len(held.site)
    nodes = np.concatenate([np.arange(sites), (sites + 2 * slots[:, None] + [0, 1]).ravel()])
    place, number = np.full(len(held.node), -1), np.full(len(held.route) + 1, -1)
    place[nodes], number[slots] = np.arange(len(nodes)), np.arange(len(slots))
    node, route, types, sums = held.node[nodes], held.route[slots], held.types.copy(), held.sums.copy()
    node[:, k.ROUTE] = number[node[:, k.ROUTE]]
    node[:, LINKS] = place[node[:, LINKS]]
    node[absent, k.PLACE] = np.arange(len(absent))
    counts = np.bincount(route[:, k.KIND], minlength=len(types))
    types[:, k.FIRST], types[:, k.SLOTS] = np.cumsum(counts) - counts, counts
    types[:, k.USED] = np.bincount(route[route[:, k.IN_USE] > 0, k.KIND], minlength=len(types))
    sums[[k.SEARCHED, k.OBJECTIVE]] = route[:, k.COST].sum() + held.site[absent][:, [k.MISSED, k.LOST]].sum(axis=0)
    sums[k.ABSENT] = len(absent)
    left_out, ours = np.zeros(sites, dtype=np.int64), node[:sites, k.ROUTE] >= 0
    left_out[: len(absent)], ours[absent] = absent, True
    own = replace(
        held, customers=held.customers[ours[held.customers]], types=types, route=route, node=node, absent=left_out, sums=sums,
        random=np.array([seed], dtype=np.uint64), log=np.zeros_like(held.log), lists=held.lists.copy(), keys=held.keys.copy(),
    )  # fmt: skip
    return Share(own, slots, nodes, following(own))


def shares(held: Arrays, places: Floats, many: int, random: np.random.Generator) -> list[Share]:
    """The routes at hand, divided among so many threads, with as many of the vehicles that nobody uses for each.

    ``places`` has a point for each site.
    """
    absent, used = held.absent[: held.sums[k.ABSENT]], np.nonzero(held.route[:, k.VISITS])[0]
    visited = held.customers[held.node[held.customers, k.ROUTE] >= 0]
    visits, middles = held.route[used, k.VISITS], np.zeros((len(held.route), places.shape[1]))
    np.add.at(middles, held.node[visited, k.ROUTE], places[visited])
    points = np.concatenate([middles[used] / visits[:, None], places[absent]])
    free = random.permutation(np.nonzero(held.route[:, k.VISITS] == 0)[0])
    made = []
    for at, near in enumerate(divided(points, np.append(visits, np.ones(len(absent), dtype=np.int64)), many, random)):
        slots = np.sort(np.append(used[near[near < len(used)]], free[at::many]))
        made.append(part(held, slots, absent[near[near >= len(used)] - len(used)], int(random.integers(2**63))))
    return made


def join(held: Arrays, parts: Iterable[Share]) -> Integers:
    """Put the routes of all parts back; returns value and successors of their best ones together."""
    sums, best, absent, before = held.sums, np.full(1 + len(held.node), -1), [], held.sums.copy()
    sums[[k.SEARCHED, k.OBJECTIVE]] = held.types[:, k.USED] = best[0] = 0
    for one in parts:
        own, inner = one.own, one.held
        node, after = inner.node[own], one.best[1:][own]
        node[:, LINKS] = one.nodes[node[:, LINKS]]
        node[:, k.ROUTE] = np.append(one.slots, -1)[node[:, k.ROUTE]]
        held.node[one.nodes[own]], held.route[one.slots] = node, inner.route
        held.types[:, k.USED] += inner.types[:, k.USED]
        absent.append(inner.absent[: inner.sums[k.ABSENT]])
        sums[[k.SEARCHED, k.OBJECTIVE]] += inner.sums[[k.SEARCHED, k.OBJECTIVE]]
        sums[[k.STEPS, k.BETTER]] += inner.sums[[k.STEPS, k.BETTER]] - before[[k.STEPS, k.BETTER]]
        best[0] += one.best[0]
        best[1 + one.nodes[own]] = np.where(after < 0, -1, one.nodes[after])
    left_out = np.concatenate(absent)
    sums[k.ABSENT], held.absent[: len(left_out)], held.node[left_out, k.PLACE] = len(left_out), left_out, np.arange(len(left_out))
    return best


def collect(pool: Pool | None, lock: threading.Lock) -> None:
    """Keep the routes at hand, now and then."""
    if pool and pool.held.sums[k.STEPS] - pool.looked >= 2 * pool.held.most_visits:
        with lock:
            pool.collect()


class SideBySide:
    """The threads of one search.

    Parameters
    ----------
    held, sizes
        What is searched, and how: as ``search_kernels.anneal`` takes it.
    places : array, shape (sites, dimensions)
        Where sites lie.
    pool, lock
        The routes that are kept, if any, and who may change them.
    stop, seed
        When the search ends, and how routes are shared out.
    """

    def __init__(self, held: Arrays, places: Floats, sizes: Floats, pool: Pool | None, lock: threading.Lock, stop: Stop, seed: int) -> None:
        self.held, self.places, self.sizes, self.pool, self.lock, self.stop = held, places, sizes, pool, lock, stop
        self.random = np.random.default_rng(seed % 2**64)

    def most(self, threads: int) -> int:
        """Among how many threads the routes at hand can be shared out."""
        return max(1, min(threads, int(self.held.types[:, k.USED].sum()) // LEAST))

    def anneal(self, many: int, steps: int, warmth: float) -> Integers:
        """Anneal for a moment, ``steps`` ruins or fewer at a time; returns value and successors of the best routes met."""
        from .ruin_recreate_steps.search_kernels import anneal

        moment = self.stop.within(MOMENT)
        flag = moment.flag

        def work(share: Share, pool: Pool | None) -> None:
            while not moment.reached():
                anneal(flag, *share.held.parts, share.best, self.sizes, steps, warmth, share.held.flags)
                collect(pool, self.lock)

        return self._on_parts(many, work)

    def combine(self, many: int, seconds: float, control: Control) -> None:
        """Put routes of the pool in place of some of those at hand, where that makes them cheaper."""

        def work(share: Share, pool: Pool | None) -> None:
            assert pool is not None
            pool.routes = dict(pool.routes)  # each keeps those that it has in hand
            better = pool.better(seconds, control)
            if better is None:
                return
            if share.held.put(better) and share.held.sums[k.OBJECTIVE] < share.best[0]:
                share.best[:] = following(share.held)
            else:
                share.held.put(share.held.routes(share.best[1:]))

        self._on_parts(many, work)

    def _on_parts(self, many: int, work: Callable[[Share, Pool | None], None]) -> Integers:
        """Share the routes at hand out, and put together what each thread makes of its own; returns the best ones of all."""

        def on(share: Share) -> None:
            pool = copy(self.pool)
            if pool is not None:
                pool.held = share.held
            work(share, pool)

        parts = shares(self.held, self.places, many, self.random)
        with ThreadPoolExecutor(many) as threads:
            list(threads.map(on, parts))
        best = join(self.held, parts)
        if self.pool is not None:
            self.pool.looked = int(self.held.sums[k.STEPS])
        return best
