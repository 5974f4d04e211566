"""The best answer that routes of many answers make up: a set-partitioning program over some neighbouring routes and all that fit there."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .....formulations.programs.program import Program, Rows, Variables
from .....formulations.routing.routes import Route, Routes
from ....backend import Control, Options
from ....backends.highs import Highs
from . import columns as k

if TYPE_CHECKING:
    from ..integer_scales import Floats, Integers
    from .arrays import Arrays

VISITS = 100
"""Visits on the routes that one program replaces."""

KEPT = 30_000
"""Routes that are kept at most; the oldest ones make room."""

NODES = 20
"""Nodes of a program's search at most."""

UNITS = 1e6
"""Value of the answer at hand in a program's own units."""

CHOSEN = 400
"""Routes of least reduced cost among which a program chooses at most."""

Key = tuple[int, frozenset[int]]


class Pool:
    """Routes of the answers that a search comes through: of each vehicle type and set of visits the cheapest order. Of the sites of a group
    one is visited, so that these count as one visit, and their choice is part of the order.

    Source: the set-partitioning step of Rochat and Taillard (1995), Probabilistic diversification and intensification in local search for
    vehicle routing, Journal of Heuristics 1, here of a part of the best answer at a time. ``whole`` tells whether the last one was all.
    """

    def __init__(self, held: Arrays, seed: int) -> None:
        self.held, self.random = held, random.Random(seed)
        self.grouped, self.stands_for = bool(held.flags & k.GROUPED), held.stands_for
        self.lost = np.zeros(len(held.site), dtype=np.int64)
        np.maximum.at(self.lost, self.stands_for, held.site[:, k.LOST])
        self.forgone = self.lost[self.stands_for] - held.site[:, k.LOST]
        self.routes: dict[Key, tuple[int, tuple[int, ...]]] = {}
        self.looked = 0
        self.whole = False

    def collect(self) -> None:
        """Keep the routes at hand that have changed since the last time."""
        rows = self.held.route
        changed = (rows[:, k.VISITS] > 0) & (rows[:, k.SOUND] > 0) & (rows[:, k.STAMP] > self.looked)
        following = self.held.node[:, k.FOLLOWING].tolist()
        for r in np.nonzero(changed)[0].tolist():
            self.add(Route(self.held.visits(r, following), int(rows[r, k.KIND])), int(rows[r, k.COST]))
        self.looked = int(self.held.sums[k.STEPS])
        while len(self.routes) > KEPT:
            del self.routes[next(iter(self.routes))]

    def key(self, route: Route) -> Key:
        """The vehicle type of a route and the set of customers it serves, a group being named by its first site: of routes with the same
        key only the cheapest is of use."""
        return route.vehicle, frozenset(self.stands_for[list(route.visits)].tolist() if self.grouped else route.visits)

    def add(self, route: Route, cost: int) -> int:
        """Keep a route, unless one with the same key is known that costs no more. Returns how much cheaper the route kept is."""
        key = self.key(route)
        if self.grouped:
            cost += int(self.forgone[list(route.visits)].sum())
        known = self.routes.pop(key, None)
        self.routes[key] = (cost, route.visits) if known is None or cost < known[0] else known
        return cost - self.routes[key][0]

    def region(self, routes: list[Route]) -> list[Route]:
        """Routes that lie next to each other: as many as have ``VISITS`` visits, and one at least."""
        route_of = {c: at for at, one in enumerate(routes) for c in one.visits}
        others = self.random.sample(list(route_of), len(route_of))
        near = self.held.near[others[0]].tolist() if others else []
        nearest = dict.fromkeys(route_of[c] for c in (*others[:1], *near, *others) if c in route_of)
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
        rows = self.held.route
        used = np.nonzero(rows[:, k.VISITS] > 0)[0].tolist()
        following = self.held.node[:, k.FOLLOWING].tolist()
        at_hand = [Route(self.held.visits(r, following), int(rows[r, k.KIND])) for r in used]
        gained = sum(self.add(route, int(rows[r, k.COST])) for route, r in zip(at_hand, used, strict=True))
        kept = {key: Route(self.routes[key][1], key[0]) for key in map(self.key, at_hand)}
        same = Routes.of(kept.values()) if gained else None
        region = self.region(at_hand)
        self.whole = len(region) == len(at_hand)
        served = {c for _, visits in kept for c in visits}
        missing = [c for c in np.unique(self.stands_for[self.held.customers]).tolist() if c not in served]
        own = [self.key(route) for route in region]
        places = self.stands_for[[c for route in region for c in route.visits]].tolist() + missing
        inside = frozenset(places)
        keys = list(dict.fromkeys([*own, *(key for key in self.routes if key[1] <= inside)]))
        loose = [c for c in places if c not in served or not self.held.site[c, k.REQUIRED]]
        start = np.array([1.0] * len(own) + [0.0] * (len(keys) - len(own)) + [float(c not in served) for c in loose])
        costs = np.append([self.routes[key][0] for key in keys], self.lost[loose])
        costs = costs / max(1.0, costs @ start) * UNITS
        most = (
            self.held.types[:, k.SLOTS]
            - self.held.types[:, k.USED]
            + np.bincount([kind for kind, _ in own], minlength=len(self.held.types))
        )
        options = replace(Options(), time_limit=seconds, gap=0.0)
        relaxation = _program(keys, costs, places, loose, most, integer=False)
        relaxed = Highs().search(relaxation, options, control)
        if len(keys) == len(own) or relaxed.row_duals is None or relaxed.answer is None:
            return same
        reduced, gap = costs - relaxation.matrix.T @ relaxed.row_duals, costs @ (start - relaxed.answer)
        cheapest = np.argsort(reduced[: len(keys)], kind="stable")[:CHOSEN]
        taken = sorted({*range(len(own)), *cheapest[reduced[cheapest] < gap].tolist(), *range(len(keys), len(costs))})
        keys, costs, start = [keys[at] for at in taken if at < len(keys)], costs[taken], start[taken]
        program = _program(keys, costs, places, loose, most, integer=True)
        found = Highs().search(program, replace(options, iterations=NODES, start=start), control).answer
        if found is None or costs @ (start - found) < 1.0:  # a millionth
            return same
        chosen = [keys[at] for at in np.nonzero(found[: len(keys)] > 0.5)[0].tolist()]
        outside = [route for key, route in kept.items() if key not in own]
        return Routes.of([*outside, *(Route(self.routes[key][1], key[0]) for key in chosen)])


def _program(keys: list[Key], costs: Floats, places: list[int], loose: list[int], most: Integers, *, integer: bool) -> Program:
    """Each of ``places`` is on one route, or, of those that are ``loose``, left out, at the costs behind those of the routes; and no more
    vehicles of a type drive than ``most``."""
    row_of = {c: at for at, c in enumerate(places)}
    kinds = [len(places) + kind for kind, _ in keys]
    rows = np.array([*(row_of[c] for _, visits in keys for c in visits), *(row_of[c] for c in loose), *kinds])
    lengths = [len(visits) for _, visits in keys]
    columns = np.concatenate([np.repeat(np.arange(len(keys)), lengths), len(keys) + np.arange(len(loose)), np.arange(len(keys))])
    order = np.argsort(rows, kind="stable")
    starts = np.append(0, np.cumsum(np.bincount(rows, minlength=len(places) + len(most)))).astype(np.int32)
    ones = np.ones(len(places))
    limits = Rows(
        "visits and vehicles", indptr=starts, indices=columns[order].astype(np.int32), data=np.ones(len(rows)),
        lower=np.append(ones, np.zeros(len(most))), upper=np.append(ones, most),
    )  # fmt: skip
    chosen = Variables("chosen", lower=np.zeros(len(costs)), upper=np.ones(len(costs)), cost=costs, integer=integer)
    return Program("set-partitioning", "min", (chosen,), (limits,))
