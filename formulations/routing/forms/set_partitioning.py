"""The set-partitioning form: one variable for each route, priced beforehand, so that every limit of a single route is data.

For the routes P_t of each vehicle type t, with c_p the route's share in the objective, and a_ip whether it visits site i, beside the rows
of
docs/formulations/routing.md#set-partitioning::

    vehicles[t]   sum_{p in P_t} y_p <= K_t                   (+ z_t = K_t for committed types: z_t drive straight home, at C_t each)
    fleet         sum y_p >= K_min                            K_min from ``minimum_vehicles``
    group[g]      sum over the members i, and p, of a_ip y_p = 1   (<= 1 where the group is not required)
    risk          sum_p log(1 - r_p) y_p >= log(1 - Delta)   where the team has a risk Delta; r_p the probability that p overruns a limit
    home[t]       z_t <= K_t b_t,  b binary;   makespan >= d b_t           where a maximum counts a way straight home

A route that is no better in anything that a level of the objective counts than another one of the same type and sites is left out. Rows
of maxima by site are stronger than those by route, makespan >= d_p y_p.

Source: Balinski and Quandt (1964); Mitchell (2020), CMU-RI-TR-20-52, 3.2, prices its routes one by one; the bound of the relaxed form is
that of the Lagrangian which dualises the visits (Dantzig and Wolfe 1960).
"""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.routing.features import RISKS
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.exactness import Exactness
from ...programs.program import Floats, Program
from ...programs.rows import Part, rows
from ..preparation import offset
from ..problem import RoutingProblem
from ..reachability import minimum_vehicles
from ..routes import Route, Routes
from . import _sizes
from ._all_routes import MOST_ROUTES, Priced, Walk, orders_of_stops, way_home
from ._best_orders import adds_up, best_orders
from ._objective import Weights, weights_of_levels
from ._routes import Blocks, point_of, used, with_levels
from .three_index import FEATURES

MAXIMA = {"makespan": "duration", "longest-route": "distance", "latest-return": "finish"}
"""Terms that are a maximum over routes, and of what."""


def refuses(problem: RoutingProblem) -> frozenset[str]:
    """Problems with many routes, and maxima that should be large."""
    levels = zip(problem.senses, weights_of_levels(problem), strict=True)
    features = {
        f"objective:{name}"
        for sense, level in levels for name, weight in level.items() if name in MAXIMA and weight * (1.0 if sense == "min" else -1.0) < 0
    }  # fmt: skip
    if orders_of_stops(problem) > MOST_ROUTES and not adds_up(problem):
        features.add(f"more than {MOST_ROUTES} orders of stops")
    return frozenset(features)


def build(problem: RoutingProblem) -> Compiled:
    """The program over all routes."""
    walks = [Walk(problem, kind) for kind in range(len(problem.fleet))]
    if orders_of_stops(problem) > MOST_ROUTES:
        every = [route for walk in walks for visits in sorted(best_orders(walk)) if (route := walk.given(visits)) is not None]
    else:
        every = [route for walk in walks for route in walk.routes()]
    return with_levels(problem, lambda p: _RouteColumns(p, every).compiled(Exactness.EXACT))


def over(problem: RoutingProblem, routes: Iterable[Route]) -> Compiled:
    """The program over given routes, such as those of several answers; raises InputError for a route that breaks a limit."""
    walks = [Walk(problem, kind) for kind in range(len(problem.fleet))]
    priced_routes = []
    for route in dict.fromkeys(routes):
        if not 0 <= route.vehicle < len(walks):
            raise InputError(f"a route uses vehicle type {route.vehicle}, which does not exist", "unknown-name")
        priced = walks[route.vehicle].given(route.visits)
        if priced is None:
            raise InputError("a route breaks a limit", "contradiction", found=", ".join(map(str, route.visits)))
        priced_routes.append(priced)
    return with_levels(problem, lambda p: _RouteColumns(p, priced_routes).compiled(Exactness.RESTRICTION))


class _RouteColumns(Blocks):
    """Columns and rows of one program."""

    def __init__(self, problem: RoutingProblem, every: Iterable[Priced]) -> None:
        super().__init__(problem)
        self.levels = weights_of_levels(problem)
        self.weights = self.levels[0]
        self.maxima = {term: what for term, what in MAXIMA.items() if term in self.weights}
        self.opens = min(Walk(problem, kind).opens for kind in range(len(problem.fleet)))
        self.routes = self._best(every)
        self.share = np.array([_share(r, self.weights) for r in self.routes])
        self.homes = {kind: way_home(problem, kind) for kind, v in enumerate(problem.fleet) if v.committed}
        self.maximum: dict[int, tuple[str, float]] = {}

    def _best(self, every: Iterable[Priced]) -> list[Priced]:
        """Routes that no other route of the same type and sites is as good as in all that counts."""
        kept: dict[Any, list[tuple[tuple[float, ...], Priced]]] = {}
        depot = self.problem.sites.depot
        for r in every:
            worth = self._worth(r)
            same = kept.setdefault((r.kind, frozenset(k for k in r.visits if not depot[k])), [])
            if not any(all(a <= b for a, b in zip(other, worth, strict=True)) for other, _ in same):
                same[:] = [pair for pair in same if not all(a <= b for a, b in zip(worth, pair[0], strict=True))]
                same.append((worth, r))
        return [r for same in kept.values() for _, r in same]

    def compiled(self, exactness: Exactness) -> Compiled:
        problem, sites = self.problem, self.problem.sites
        ids, several = sites.ids, len(problem.fleet) > 1
        names = [
            (f"{problem.fleet[r.kind].name}:" if several else "") + "-".join(ids[k] for k in r.visits) for r in self.routes
        ]  # fmt: skip
        count, customers = len(self.routes), problem.customers
        self.add_columns("y", (np.arange(count),), (names,), 0.0, 1.0, self.share, integer=True)
        place = {site: k for k, site in enumerate(customers.tolist())}
        pairs = [(place[k], p) for p, r in enumerate(self.routes) for k in r.visits if k in place]
        self.site, self.of = (np.array([pair[k] for pair in pairs], dtype=np.int64) for k in (0, 1))
        least = np.where(sites.required[customers], 1.0, 0.0)
        keys, labels = (customers,), (ids,)
        self.rows.append(rows("visit", len(customers), [(self.site, self.of, 1.0)], least, 1.0, keys, labels))
        self._fleet()
        if sites.groups:
            self._groups(place)
        if problem.team_risk is not None:
            self._team_risk(problem.team_risk)
        for term, what in self.maxima.items():
            self._maximum(term, what)
        bare = Program(
            "set-partitioning", problem.sense, tuple(self.variables), tuple(b for b in self.rows if b.size), offset=offset(problem)
        )
        return Compiled(bare, problem, self._decode, lambda answer: self._encode(bare, answer), exactness=exactness)

    def _fleet(self) -> None:
        problem, kind_of = self.problem, np.array([r.kind for r in self.routes], dtype=np.int64)
        self.idle: dict[int, int] = {}
        self.away: dict[int, int] = {}
        for kind, vehicle in enumerate(problem.fleet):
            mine = np.nonzero(kind_of == kind)[0]
            parts: list[Part] = [(np.zeros(len(mine), dtype=np.int64), mine, 1.0)]
            key, label, most = (np.array([kind]),), ([v.name for v in problem.fleet],), vehicle.count
            if vehicle.committed and most is not None:
                home = self.homes[kind]
                upper, cost = (0.0, 0.0) if home is None else (float(most), _share(home, self.weights) - self.weights.get("vehicles", 0.0))
                self.idle[kind] = self.add_columns("z", key, label, 0.0, upper, cost, integer=True)
                parts.append((np.zeros(1, dtype=np.int64), np.array([self.idle[kind]]), 1.0))
                self.rows.append(rows("vehicles", 1, parts, float(most), float(most), key, label))
                if self.maxima:
                    self.away[kind] = self.add_columns("b", key, label, 0.0, 1.0, integer=True)
                    link: list[Part] = [
                        (np.zeros(2, dtype=np.int64), np.array([self.idle[kind], self.away[kind]]), np.array([1.0, -float(most)]))
                    ]
                    self.rows.append(rows("home", 1, link, upper=0.0, keys=key, labels=label))
            elif most is not None:
                self.rows.append(rows("vehicles", 1, parts, upper=float(most), keys=key, labels=label))
        fewest = minimum_vehicles(problem)
        if fewest:
            every = np.arange(len(self.routes))
            self.rows.append(rows("fleet", 1, [(np.zeros(len(every), dtype=np.int64), every, 1.0)], float(fewest)))

    def _groups(self, place: dict[int, int]) -> None:
        parts: list[Part] = []
        for number, group in enumerate(self.problem.sites.groups):
            members = np.isin(self.site, [place[k] for k in group.sites])
            chosen, times = np.unique(self.of[members], return_counts=True)
            parts.append((np.full(len(chosen), number), chosen, times.astype(np.float64)))
        self.add_groups(parts)

    def _team_risk(self, risk: float) -> None:
        """Routes overrun independently; in parts of the risk that there may be."""
        homes = [(column, home.overrun) for kind, column in self.idle.items() if (home := self.homes[kind]) is not None]
        columns = np.array([*range(len(self.routes)), *(column for column, _ in homes)], dtype=np.int64)
        overruns = np.array([*(r.overrun for r in self.routes), *(overrun for _, overrun in homes)])
        share = np.log1p(-overruns) / math.log1p(-risk)
        self.rows.append(rows("risk", 1, [(np.zeros(len(columns), dtype=np.int64), columns, share)], upper=1.0))

    def _maximum(self, term: str, what: str) -> None:
        """The greatest amount of the routes, a row per site."""
        name = {"longest-route": "longest", "latest-return": "latest"}.get(term, term)
        least = self.opens if term == "latest-return" else 0.0
        amount = np.array([float(getattr(r, what)) for r in self.routes])
        homes = {kind: float(getattr(home, what)) for kind, home in self.homes.items() if home is not None}
        most = max([least, *amount.tolist(), *homes.values()])
        column = self.add_columns(name, (), (), least, most, self.weights[term])
        n, customers = len(self.problem.customers), self.problem.customers
        # In excess of the least value, so that a site without a route asks for nothing.
        parts: list[Part] = [(np.arange(n), np.full(n, column), 1.0), (self.site, self.of, least - amount[self.of])]
        self.rows.append(rows(name, n, parts, least, keys=(customers,), labels=(self.problem.sites.ids,)))
        for kind, value in homes.items():
            entries: list[Part] = [(np.zeros(2, dtype=np.int64), np.array([column, self.away[kind]]), np.array([1.0, least - value]))]
            key, label = (np.array([kind]),), ([v.name for v in self.problem.fleet],)
            self.rows.append(rows(f"{name}-home", 1, entries, least, keys=key, labels=label))
        self.maximum[column] = (what, least)

    def _decode(self, x: Floats) -> Routes:
        chosen = np.nonzero(used(x[: len(self.routes)]))[0]
        return Routes(tuple(Route(self.routes[p].visits, self.routes[p].kind) for p in chosen.tolist()))

    def _encode(self, program: Program, answer: Routes) -> Floats:
        x, taken, driven = program.lower.copy(), [0] * len(self.problem.fleet), []
        for route in answer:
            p = self._position(route)
            x[p] += 1.0
            taken[route.vehicle] += 1
            driven.append(self.routes[p])
        for kind, column in self.idle.items():
            x[column] = (self.problem.fleet[kind].count or 0) - taken[kind]
            home = self.homes[kind]
            if x[column] > 0 and home is not None:
                driven.append(home)
                if kind in self.away:
                    x[self.away[kind]] = 1.0
        for column, (what, least) in self.maximum.items():
            x[column] = max([least, *(float(getattr(r, what)) for r in driven)])
        return point_of(program, x)

    def _position(self, route: Route) -> int:
        """Position of the route, or of one that is as good in all that counts and was kept in its place."""
        problem, stops = self.problem, ", ".join(map(str, route.visits))
        depot = problem.sites.depot
        priced = Walk(problem, route.vehicle).given(route.visits) if 0 <= route.vehicle < len(problem.fleet) else None
        if priced is None:
            raise InputError("a route breaks a limit", "contradiction", found=stops)
        served = frozenset(k for k in route.visits if not depot[k])
        alike = [
            p for p, r in enumerate(self.routes) if r.kind == route.vehicle and served == frozenset(k for k in r.visits if not depot[k])
        ]  # fmt: skip
        worth = self._worth(priced)
        good = [p for p in alike if all(a <= b for a, b in zip(self._worth(self.routes[p]), worth, strict=True))]
        exact = [p for p in good if self.routes[p].visits == route.visits]
        if not good:
            raise InputError("a route is none of those that the program holds", "unsupported", found=stops)
        return (exact or good)[0]

    def _worth(self, r: Priced) -> tuple[float, ...]:
        """All criteria of a route, each to be minimised."""
        signs = [1.0 if sense == "min" else -1.0 for sense in self.problem.senses]
        shares = [sign * _share(r, level) for sign, level in zip(signs, self.levels, strict=True)]
        risk = () if self.problem.team_risk is None else (r.overrun,)
        return (*shares, *(float(getattr(r, what)) for what in self.maxima.values()), *risk)


def _share(r: Priced, weight: Weights) -> float:
    amounts = {"total-cost": r.cost, "vehicles": 1.0, "reward": r.reward, "total-duration": r.duration, "penalties": -r.penalty}
    return math.fsum(each * amounts.get(name, 0.0) for name, each in weight.items())


FORMS.enter(
    Form(
        "set-partitioning",
        "routing",
        (FEATURES | RISKS) - {"forbidden-moves"},
        build,
        refuses=refuses,
        order=5,
        size=_sizes.set_partitioning,
    ),
)
