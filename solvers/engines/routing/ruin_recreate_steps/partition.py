"""The best answer that routes of many answers make up: a set-partitioning program over some neighbouring routes and all that fit there."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .....formulations.programs.program import Program, Rows, Variables
from .....formulations.routing.routes import Route, Routes
from ....backend import Control, Options
from . import columns as k

if TYPE_CHECKING:
    from .arrays import Arrays, Floats, Integers

VISITS = 100
"""Visits on the routes that one program replaces."""

KEPT = 30_000
"""Routes that are kept at most; the oldest ones make room."""

NODES = 20
"""Nodes of a program's search at most."""

UNITS = 1e6
"""Value of the answer at hand in a program's own units."""

CHOSEN = 1_000
"""Routes of least reduced cost among which a program chooses at most."""

Key = tuple[int, frozenset[int]]


class Pool:
    """Routes of the answers that a search comes through: of each vehicle type and set of visits the cheapest order.

    Source: the set-partitioning step of Rochat and Taillard (1995), Probabilistic diversification and intensification in local search for
    vehicle routing, Journal of Heuristics 1, here of a part of the best answer at a time.
    """

    def __init__(self, held: Arrays, seed: int) -> None:
        self.held, self.random = held, random.Random(seed)
        self.routes: dict[Key, tuple[int, tuple[int, ...]]] = {}
        self.looked = 0

    def collect(self) -> None:
        """Keep the routes at hand that have changed since the last time."""
        rows = self.held.route
        changed = (rows[:, k.VISITS] > 0) & (rows[:, k.SOUND] > 0) & (rows[:, k.STAMP] > self.looked)
        for r in np.nonzero(changed)[0].tolist():
            self.add(Route(self.held.visits(r), int(rows[r, k.KIND])), int(rows[r, k.COST]))
        self.looked = int(self.held.sums[k.STEPS])
        while len(self.routes) > KEPT:
            del self.routes[next(iter(self.routes))]

    def add(self, route: Route, cost: int) -> None:
        """Keep a route, unless its visits are known to cost no more in another order."""
        key = route.vehicle, frozenset(route.visits)
        known = self.routes.pop(key, None)
        self.routes[key] = (cost, route.visits) if known is None or cost < known[0] else known

    def region(self, routes: list[Route]) -> list[Route]:
        """Routes that lie next to each other: as many as have ``VISITS`` visits, and one at least."""
        route_of = {c: at for at, one in enumerate(routes) for c in one.visits}
        seed = self.random.choice(list(route_of))
        others = self.random.sample(list(route_of), len(route_of))
        nearest = dict.fromkeys(route_of[c] for c in (seed, *self.held.near[seed].tolist(), *others) if c in route_of)
        chosen: list[Route] = []
        visits = 0
        for at in nearest:
            visits += len(routes[at].visits)
            if visits > VISITS and chosen:
                break
            chosen.append(routes[at])
        return chosen

    def better(self, seconds: float, control: Control) -> Routes | None:
        """A cheaper answer that routes of the pool make up together with those at hand outside of a region; None where none is found."""
        from ....backends.highs import Highs
        rows = self.held.route
        used = np.nonzero(rows[:, k.VISITS] > 0)[0].tolist()
        answer = [Route(self.held.visits(r), int(rows[r, k.KIND])) for r in used]
        for route, r in zip(answer, used, strict=True):
            self.add(route, int(rows[r, k.COST]))
        region = self.region(answer)
        served = {c for one in answer for c in one.visits}
        free = [c for one in region for c in one.visits] + [c for c in self.held.customers.tolist() if c not in served]
        own = [(one.vehicle, frozenset(one.visits)) for one in region]
        inside = frozenset(free)
        keys = list(dict.fromkeys([*own, *(key for key in self.routes if key[1] <= inside)]))
        if len(keys) == len(own):
            return None
        spare = self.held.types[:, k.SLOTS] - self.held.types[:, k.USED]
        start = np.array([1.0] * len(own) + [0.0] * (len(keys) - len(own)) + [float(c not in served) for c in free])
        costs = np.append([self.routes[key][0] for key in keys], self.held.site[free, k.LOST])
        costs = costs / max(1.0, costs @ start) * UNITS
        options = replace(Options(), time_limit=seconds, gap=0.0)
        program = _program(keys, costs, free, spare, own, integer=False)
        relaxed = Highs().search(program, options, control)
        if relaxed.row_duals is None or relaxed.answer is None:
            return None
        reduced, gap = costs - program.matrix.T @ relaxed.row_duals, costs @ (start - relaxed.answer)
        cheapest = np.argsort(reduced[: len(keys)], kind="stable")[:CHOSEN]
        taken = sorted({*range(len(own)), *cheapest[reduced[cheapest] < gap].tolist(), *range(len(keys), len(costs))})
        keys, costs, start = [keys[at] for at in taken if at < len(keys)], costs[taken], start[taken]
        if len(keys) == len(own):
            return None
        program = _program(keys, costs, free, spare, own, integer=True)
        found = Highs().search(program, replace(options, iterations=NODES, start=start), control).answer
        if found is None or costs @ (start - found) < 1e-6:
            return None
        chosen = [keys[at] for at in np.nonzero(found[: len(keys)] > 0.5)[0].tolist()]
        replaced = set(own)
        outside = [one for one in answer if (one.vehicle, frozenset(one.visits)) not in replaced]
        return Routes.of([*outside, *(Route(self.routes[key][1], key[0]) for key in chosen)])


def _program(keys: list[Key], costs: Floats, free: list[int], spare: Integers, own: list[Key], *, integer: bool) -> Program:
    """Each of ``free`` is on one route or left out, at the costs behind those of the routes, and no more vehicles of a type drive than
    there are."""
    row_of = {c: at for at, c in enumerate(free)}
    lengths = np.array([len(visits) for _, visits in keys])
    columns = np.append(np.repeat(np.arange(len(keys)), lengths), len(keys) + np.arange(len(free)))
    rows = np.append([row_of[c] for _, visits in keys for c in visits], np.arange(len(free)))
    order = np.argsort(rows, kind="stable")
    starts = np.append(0, np.cumsum(np.bincount(rows, minlength=len(free)))).astype(np.int32)
    ones = np.ones(len(free))
    visits = Rows("visits", indptr=starts, indices=columns[order].astype(np.int32), data=np.ones(len(rows)), lower=ones, upper=ones)
    kinds = np.array([kind for kind, _ in keys])
    used = np.array([kind for kind, _ in own])
    of_type = [np.nonzero(kinds == kind)[0] for kind in range(len(spare))]
    most = np.array([spare[kind] + (used == kind).sum() for kind in range(len(spare))], dtype=float)
    fleet = Rows(
        "vehicles", indptr=np.append(0, np.cumsum([len(one) for one in of_type])).astype(np.int32),
        indices=np.concatenate(of_type).astype(np.int32), data=np.ones(len(keys)), lower=np.zeros(len(spare)), upper=most,
    )  # fmt: skip
    size = len(costs)
    chosen = Variables("chosen", lower=np.zeros(size), upper=np.ones(size), cost=costs, integer=integer)
    return Program("set-partitioning", "min", (chosen,), (visits, fleet))
