"""A routing problem, and an answer to it, as the arrays of ``route_kernels``."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .....formulations.routing.routes import Route, Routes
from ..integer_scales import Integers
from ..routing_integers import IntegerRouting
from . import columns as k
from .risks import Risks

if TYPE_CHECKING:
    from .....formulations.routing.problem import RoutingProblem

MOST = 1 << 50
"""Limits beyond it are none; moves as long as it are made by nobody."""

WAITING = 0.2
"""Weight of a minute of waiting against a minute of travel, when customers are ranked by how near they are to each other."""


@dataclass(frozen=True, eq=False)
class Arrays:
    """The arrays of ``route_kernels`` and ``search_kernels``, by the names that they have there."""

    ways: Integers
    at_way: Integers
    site: Integers
    types: Integers
    allowed: NDArray[np.bool_]
    alone: Integers
    customers: Integers
    near: Integers
    reach: Integers
    drive: Integers
    depots: Integers
    route: Integers
    node: Integers
    absent: Integers
    sums: Integers
    random: NDArray[np.uint64]
    log: Integers
    lists: Integers
    keys: NDArray[np.float64]
    flags: int

    @property
    def parts(self) -> tuple[NDArray[Any], ...]:
        """The arrays in the order in which ``search_kernels.anneal`` takes them."""
        return tuple(getattr(self, field.name) for field in fields(self) if field.name != "flags")

    @property
    def stands_for(self) -> Integers:
        """For each site itself, or, where one of a group is visited, the first of the group."""
        group = self.site[:, k.GROUP]
        return np.where(group < 0, np.arange(len(group)), group)

    @cached_property
    def most_visits(self) -> int:
        """How many customers can be visited, of each group one."""
        return len(np.unique(self.stands_for[self.customers]))

    def begin(self, answer: Routes) -> bool:
        """Put the visits of an answer in, but for routes that break a limit; whether it is one of these customers and vehicles."""
        from .search_kernels import settle

        sites, places = len(self.site), []
        free = {kind: list(range(int(row[k.FIRST]), int(row[k.FIRST] + row[k.SLOTS]))) for kind, row in enumerate(self.types)}
        reloads = set(self.depots[:, 0].tolist())
        visited = [c for one in answer for c in one.visits if c not in reloads]
        if len(set(visited)) < len(visited) or not set(visited) <= set(self.customers.tolist()):
            return False
        for one in answer:
            if not free.get(one.vehicle):
                return False
            places.append(free[one.vehicle].pop(0))
        stops = [c for one in answer for c in one.visits if c in reloads]
        if any(stops.count(depot) > many for depot, _, many in self.depots.tolist()):
            return False
        if self.flags & k.SHIPPED and not all(self.keeps_order(one.visits) for one in answer):
            return False
        free_nodes = {site: list(range(first, first + many)) for site, first, many in self.depots.tolist()}
        for r, one in zip(places, answer, strict=True):
            between = [free_nodes[site].pop(0) if site in free_nodes else site for site in one.visits]
            stops = [sites + 2 * r, *between, sites + 2 * r + 1]
            self.node[stops[:-1], k.FOLLOWING], self.node[stops[1:], k.PREVIOUS] = stops[1:], stops[:-1]
            self.node[between, k.ROUTE] = r
        settle(self.ways, self.at_way, self.site, self.types, self.route, self.node, self.absent, self.sums, self.flags)
        return True

    def put(self, answer: Routes) -> bool:
        """Begin anew with an answer, whatever was there."""
        sites, slots = len(self.site), 2 * np.arange(len(self.route))
        self.node[sites + slots, k.FOLLOWING], self.node[sites + slots + 1, k.PREVIOUS] = sites + slots + 1, sites + slots
        self.node[:sites, k.ROUTE], self.node[self.customers, k.PLACE] = -1, np.arange(len(self.customers))
        self.node[sites + 2 * len(self.route) :, k.ROUTE], self.node[:sites, k.CHOSEN] = -1, 0
        self.absent[: len(self.customers)] = self.customers
        home = self.types[self.route[:, k.KIND], k.HOME]
        self.types[:, k.USED], self.route[:, k.IN_USE], self.route[:, k.COST] = 0, 0, home
        running = home.sum() + self.sums[k.SHORT] * self.sums[k.FEWEST]
        left_out = (self.site[self.customers, column].sum() + running for column in (k.MISSED, k.LOST))
        self.sums[: k.STEPS] = *left_out, len(self.customers), 0
        self.types[:, k.HIGHEST : k.DEARER], self.route[:, k.HAZARD], self.sums[k.HAZARDS] = 0, 0, 0
        return self.begin(answer)

    def unserved(self, visited: NDArray[np.bool_]) -> Integers:
        """The required sites that are not visited, and of each required group that is not the first one."""
        group, wanted = self.site[:, k.GROUP], self.site[:, k.REQUIRED] > 0
        served = np.zeros(len(self.site), dtype=bool)
        served[group[visited & (group >= 0)]] = True
        return self.customers[(wanted & np.where(group < 0, ~visited, ~served & (group == np.arange(len(group)))))[self.customers]]

    def keeps_order(self, visits: tuple[int, ...]) -> bool:
        """Whether one route picks up all that it delivers, and before that."""
        place = {c: at for at, c in enumerate(visits)}
        partners = ((c, int(self.site[c, k.PARTNER])) for c in visits if self.site[c, k.PARTNER] >= 0)
        return all(p in place and (place[c] < place[p]) == (self.site[c, k.SECOND] == 0) for c, p in partners)

    def next_move(self) -> float:
        """Length of a move from a customer to the nearest other one on the mean, 0 where there is none."""
        nearest = self.near[self.customers, 0]
        lengths = self.ways[0, self.customers, nearest, self.at_way[1]]
        lengths = lengths[(nearest >= 0) & (lengths < MOST)]
        return float(lengths.mean()) if len(lengths) else 0.0

    def reward(self, share: float) -> None:
        """Have the search take all rewards on the routes together for ``share`` times the cost of the routes, no longer for what they count
        in the objective: beside rewards that outweigh all distance no detour is too long, and no room is made for others."""
        optional = self.customers[self.site[self.customers, k.REQUIRED] == 0]
        collected, cost = self.site[optional[self.node[optional, k.ROUTE] >= 0], k.LOST].sum(), self.route[:, k.COST].sum()
        if collected and cost:
            self.weigh(share * cost / collected)

    def weigh(self, worth: float) -> None:
        """Have the search take rewards for ``worth`` times what they count in the objective."""
        optional = self.customers[self.site[self.customers, k.REQUIRED] == 0]
        lost = self.site[optional, k.LOST]
        self.site[optional, k.MISSED] = np.maximum(lost > 0, np.rint(lost * worth)).astype(np.int64)
        left_out = self.absent[: int(self.sums[k.ABSENT])]
        short = self.sums[k.SHORT] * max(0, self.sums[k.FEWEST] - self.sums[k.DRIVEN])
        largest = self.types[0, k.HIGHEST : k.DEARER] @ self.types[0, k.DEARER : k.CAPACITY]
        self.sums[k.SEARCHED] = self.route[:, k.COST].sum() + self.site[left_out, k.MISSED].sum() + short + largest

    def routes(self, following: Integers) -> Routes:
        """The routes that ``following``, the successor of each node, makes up."""
        after = following.tolist()
        kept = ((self.visits(r, after), int(row[k.KIND])) for r, row in enumerate(self.route))
        return Routes.of(Route(visits, kind) for visits, kind in kept if visits)

    def visits(self, route: int, following: list[int]) -> tuple[int, ...]:
        """The stops of a route."""
        sites, end = len(self.site), len(self.site) + 2 * route + 1
        stops, at = [], following[end - 1]
        while at != end:
            stops.append(at if at < sites else int(self.node[at, k.SITE]))
            at = following[at]
        return tuple(stops)


def arrays(problem: RoutingProblem, data: IntegerRouting, neighbours: int, seed: int) -> Arrays:
    """The arrays of a problem, nobody being visited."""
    sites, customers, fleet = len(problem.sites), problem.customers, problem.fleet
    counts = np.array([len(customers) if v.count is None else min(v.count, len(customers)) for v in fleet])
    counts[data.closes < data.opens] = 0
    charged = [v.energy is not None and v.energy.charge == "travel" and not v.stations for v in fleet]
    risks = Risks(problem)
    apart = np.array([there and (risks.risky[kind] or problem.travel_of(kind).own_durations) for kind, there in enumerate(charged)])
    longest = np.minimum(np.minimum(data.max_distance, np.where(apart, MOST, data.travel_reach)), MOST - 1)
    store = _limited(data.store)
    filled = np.where(data.store > MOST, MOST, data.store - data.store_lacking)
    travel, charge = _limited(np.where(apart, data.travel_limit, MOST)), _limited(data.charge_limit)
    on = _stacked([_limited(m.distance_up if (longest < MOST - 1).any() else m.distance) for m in data.moves])
    if problem.forbidden is not None:
        on = np.where(problem.forbidden, MOST, on)
    elapsed = np.where(risks.risky, data.latest_return - data.opens, MOST)  # nobody waits where a limited duration is uncertain
    hours = _limited(np.minimum(data.max_duration, elapsed))
    spanned = bool((hours < MOST).any() or data.time.any() or data.overtime.any() or data.maxima[0])
    late = (data.due[customers] < MOST).any() or (data.closes < MOST).any()
    many = max(map(len, data.windows)) if any(len(listed) > 1 for listed in data.windows) else 0
    closes = any(moves.closing is not None for moves in data.moves)
    shipments = problem.sites.shipments
    stations = sorted({site for v in fleet for site in v.stations})
    reloads = stations or sorted({site for v in fleet for site in v.reloads})
    walked = bool(stations or closes or apart.any() or (charge < MOST).any() or (many and spanned) or (shipments and reloads))
    walked = walked or bool(risks.risky.any())
    timed = bool(spanned or late or data.ready.any() or walked or data.maxima[2])
    goes = _stacked([_limited(m.duration) for m in data.moves]) if timed else on
    for moves in data.moves:
        moves.forget()  # they are held here
    variances, fineness = risks.variances(problem, data) if risks.risky.any() else ([np.zeros_like(goes[0])] * len(goes), 0)
    further = (*_further(data, goes), np.stack(variances)) if walked else ()
    ways, at_way = _ways(on, goes, *further)
    near, reach, drive, least = _near(
        data, customers, on if len(on) == 1 else on.min(axis=0)[None], goes if len(goes) == 1 else goes.min(axis=0)[None], neighbours
    )
    required, group, alternative = problem.sites.required.astype(np.int64), *np.full((2, sites), -1)
    for one in problem.sites.groups:
        members = np.array(one.sites)
        required[members], group[members], alternative[members] = one.required, members[0], np.roll(members, -1)
    lost = np.where(required > 0, dear(problem, data), 0) + np.where(problem.sites.required, 0, data.prize)
    away = data.service + least
    loads = [data.demand[:, data.limited]]
    picked = bool(shipments) or bool(reloads and not stations) or bool(data.pickup[:, data.limited].any())
    partner, second = np.full(sites, -1), np.zeros(sites, dtype=np.int64)
    if picked:
        loads.append(data.pickup[:, data.limited])
    for shipment, load in zip(shipments, data.shipped[:, data.limited], strict=True):
        first, last = shipment.pickup, shipment.delivery
        partner[[first, last]], second[last] = (last, first), 1
        loads[1][first] += load
        loads[1][last] -= load
    windows = np.array([[*listed, *[listed[-1]] * (many - len(listed))][:many] for listed in data.windows], dtype=np.int64)
    windows = _limited(windows.reshape(sites, 2 * many))
    site = np.column_stack(
        [data.service, data.ready, _limited(data.due), required, lost, lost, away, partner, second, group, alternative, *loads, windows]
    )
    ends = np.array([(v.start, v.end) for v in fleet])
    most_reloads = [len(customers) * bool(v.reloads) if v.max_reloads is None else v.max_reloads for v in fleet]
    spare = int(min(len(customers), (counts * most_reloads).sum()))
    if stations:
        most_reloads, spare = [MOST] * len(fleet), 2 * len(customers) + 2
    direct, lasts = (moves[data.profile, ends[:, 0], ends[:, 1]] for moves in (on, goes))
    home = data.unit * direct + data.fixed - data.counted + data.time * lasts + data.overtime * np.maximum(lasts - data.regular_duration, 0)
    home = np.where([v.committed for v in fleet], home, 0)
    dearer = [np.full_like(counts, cost) for cost in data.maxima]
    types = np.column_stack([
        data.profile, ends, hours, longest, data.unit, data.fixed, data.time, _limited(data.regular_duration), data.overtime,
        data.opens, _limited(data.leaves), _limited(data.closes),
        np.cumsum(counts) - counts, counts, np.zeros_like(counts), most_reloads, home, travel, charge, store, filled,
        risks.caution, np.full_like(counts, fineness), [v.committed for v in fleet], *[np.zeros_like(counts)] * 3, *dearer,
        _limited(data.capacity[:, data.limited]),
    ])  # fmt: skip
    kind = np.repeat(np.arange(len(fleet)), counts)
    heads = sites + 2 * np.arange(len(kind))
    node = np.zeros(
        (sites + 2 * len(kind) + len(reloads) * spare + 4 * bool(stations), k.NODE_COLUMNS + 3 * picked * len(data.limited)), dtype=np.int64
    )
    node[:, [k.ROUTE, k.PLACE, k.LISTED]] = -1
    node[:sites, k.SITE] = np.arange(sites)
    node[heads, k.FOLLOWING], node[heads + 1, k.PREVIOUS] = heads + 1, heads
    for at, end in ((heads, k.START), (heads + 1, k.END)):
        node[at, k.ROUTE], node[at, k.SITE] = np.arange(len(kind)), types[kind, end]
    node[customers, k.PLACE] = np.arange(len(customers))
    node[heads, k.FREE], node[heads, k.LATE], node[heads + 1, k.LATEST] = (types[kind, at] for at in (k.OPENS, k.LEAVES, k.CLOSES))
    node[heads + 1, k.EARLY], node[heads, k.AHEAD] = types[kind, k.OPENS], on[data.profile[kind], ends[kind, 0], ends[kind, 1]]
    route = np.zeros((len(kind), k.ROOM + len(data.limited)), dtype=np.int64)
    route[:, k.ROOM :] = types[kind, k.CAPACITY :]
    route[:, k.KIND], route[:, k.STAMP], route[:, [k.SOUND, k.PUNCTUAL]] = kind, -1, 1
    route[:, k.LENGTH], route[:, k.COST] = node[heads, k.AHEAD], home[kind]
    depots = np.array([(site, sites + 2 * len(kind) + at * spare, spare) for at, site in enumerate(reloads)], dtype=np.int64).reshape(-1, 3)
    for depot, begin, nodes in depots.tolist():
        node[begin : begin + nodes, k.SITE] = depot
    absent = np.zeros(sites, dtype=np.int64)
    absent[: len(customers)] = customers
    fewest, price = min(problem.min_vehicles, len(customers)), dear(problem, data) if problem.min_vehicles else 0
    sums = np.array(
        [*[lost[customers].sum() + home[kind].sum() + fewest * price] * 2, len(customers), 0, 0, 0, fewest, price, 0, risks.most]
    )
    skilled = problem.sites.skills
    allowed = np.array([[not skilled or asked <= v.skills for asked in skilled or [frozenset()] * sites] for v in fleet])
    for number, vehicle in enumerate(fleet):
        allowed[number, reloads] = [site in (vehicle.stations if stations else vehicle.reloads) for site in reloads]
    features = {
        k.TIMED: timed, k.SPANNED: spanned, k.PICKED: picked, k.SHIPPED: shipments, k.GROUPED: problem.sites.groups,
        k.RELOADING: reloads and not stations, k.RECHARGING: stations,
        k.WINDOWED: many, k.COUNTED: fewest, k.WALKED: walked, k.CLOSING: closes,
        k.RISKY: risks.risky.any(), k.SHARED: risks.shared, k.TOPPED: data.maxima.any(),
    }  # fmt: skip
    differ = any(np.ptp(lost[list(one.sites)]) for one in problem.sites.groups)
    coupled = spanned or walked or shipments or differ or reloads or fewest or data.maxima.any() or risks.shared
    features[k.LENGTHENED] = not coupled and _metric(on, near, customers, np.unique(ends))
    flags = sum(flag for flag, there in features.items() if there) + (many << k.MANY)
    site, types, alone = _rows(site), _rows(types), _alone(site, types, allowed, on, goes, flags)
    if walked:
        from .walk_kernels import walk_alone

        walk_alone(ways, at_way, site, types, route, node, alone, flags)
    held = Arrays(
        ways, at_way, site, types, allowed, alone,
        customers.astype(np.int64), near, reach, drive, depots, route, node, absent, sums, np.array([seed], dtype=np.uint64),
        np.zeros(4 * len(node) + route.size + 2 * len(route) + 2, dtype=np.int64),
        np.zeros((3, max(16, sites)), dtype=np.int64), np.zeros(sites), flags,
    )  # fmt: skip
    if flags & (k.SHARED | k.TOPPED):
        held.begin(Routes(()))  # what committed vehicles add on their way home
    return held


def _alone(site: Integers, types: Integers, allowed: NDArray[np.bool_], on: Integers, goes: Integers, flags: int) -> Integers:
    """Cost of a route that visits one site alone, or carries one shipment, for each vehicle type; ``NONE`` if it breaks a limit."""
    costs = np.full(allowed.shape, k.NONE)
    unpaired, pickups = np.nonzero(site[:, k.PARTNER] < 0)[0], np.nonzero((site[:, k.PARTNER] >= 0) & (site[:, k.SECOND] == 0))[0]
    for kind, row in enumerate(types):
        for stops in ([unpaired], [pickups, site[pickups, k.PARTNER]]):
            costs[kind, stops[0]] = _cost_of(row, stops, site, allowed[kind], on[row[k.PROFILE]], goes[row[k.PROFILE]], flags)
    return costs


def _cost_of(
    row: Integers, stops: list[Integers], site: Integers, allowed: NDArray[np.bool_], on: Integers, goes: Integers, flags: int
) -> Integers:
    """Costs of routes of a vehicle type, each with one stop of each array of ``stops``, ``NONE`` for those that break a limit."""
    at: Any = row[k.START]
    length, spent = np.zeros((2, len(stops[0])), dtype=np.int64)
    fits, free, latest = np.ones(len(length), dtype=bool), np.full(len(length), row[k.OPENS]), np.full(len(length), row[k.LEAVES])
    dims = len(row) - k.CAPACITY
    room = np.resize(row[k.CAPACITY :], dims * (2 if flags & k.PICKED else 1))
    for stop in stops:
        fits &= allowed[stop] & (site[stop, k.DEMAND : k.DEMAND + len(room)] <= room).all(axis=1)
        length += on[at, stop]
        if flags & k.TIMED:
            ready, due, service, comes = *(site[stop, column] for column in (k.READY, k.DUE, k.SERVICE)), goes[at, stop]
            begins, on_way = _openings(site[stop], np.maximum(free + comes, ready), flags), spent + comes
            fits &= begins <= due
            free, spent = begins + service, on_way + np.maximum(ready - on_way - latest, 0) + service
            latest = np.minimum(due - on_way, latest)
        at = stop
    length += on[at, row[k.END]]
    if flags & k.TIMED:
        spent += goes[at, row[k.END]]
        fits &= (free + goes[at, row[k.END]] <= row[k.CLOSES]) & (spent <= row[k.MAX_DURATION])
    fits &= length <= row[k.MAX_DISTANCE]
    spent = np.where(fits, spent, 0)
    hours = row[k.TIME] * spent + row[k.OVERTIME] * np.maximum(spent - row[k.REGULAR], 0)
    cost = row[k.UNIT] * np.where(fits, length, 0) + row[k.FIXED] + hours - row[k.HOME]
    return np.where(fits, cost, k.NONE)


def _openings(site: Integers, times: Integers, flags: int) -> Integers:
    """``route_kernels.opening`` at one site of each row."""
    many = flags >> k.MANY
    if not many:
        return times
    windows = site[:, site.shape[1] - 2 * many :].reshape(len(site), many, 2)
    usable = times[:, None] <= windows[:, :, 1]
    first = windows[np.arange(len(site)), usable.argmax(axis=1), 0]
    return np.where(usable.any(axis=1), np.maximum(times, first), k.NONE)


def dear(problem: RoutingProblem, data: IntegerRouting) -> int:
    """Price of leaving a required site out: more than all rewards and all routes can cost, as far as such sums stay within 64 bits."""
    customers, moves = len(problem.customers), 2 * len(problem.customers) * (1 + 4 * any(v.stations for v in problem.fleet))
    routes = moves * max(m.longest for m in data.moves) * int(data.unit.max()) + customers * int(data.fixed.max())
    times = moves * max(m.slowest for m in data.moves) + int(data.service.sum()) + int(data.ready.max())
    worth = 1 + int(data.prize.sum()) + routes + customers * times * int((data.time + data.overtime).max())
    worth += int(data.maxima[[0, 2]].sum()) * times + int(data.maxima[1]) * moves * max(m.longest for m in data.moves)
    return min(worth, (1 << 59) // (customers + 1))


def _rows(values: Integers) -> Integers:
    return np.ascontiguousarray(values, dtype=np.int64)


def _limited(values: Integers) -> Integers:
    return np.minimum(values, MOST) if values.max(initial=0) > MOST else values


def _stacked(matrices: list[Integers]) -> Integers:
    """All in one array; a single one is not copied, for that of 5,000 sites takes 200 MB."""
    return np.ascontiguousarray(matrices[0])[None] if len(matrices) == 1 else np.stack(matrices)


def _further(data: IntegerRouting, goes: Integers) -> tuple[Integers, Integers]:
    """Energy that each move draws, in units of time: its duration, unless it is charged by windows; and the latest time at which it may
    begin."""
    charges, closings = goes.copy(), np.full_like(goes, MOST)
    for p, moves in enumerate(data.moves):
        if moves.charge is not None:
            charges[p] = _limited(moves.charge)
        if moves.closing is not None:
            closings[p] = _limited(moves.closing)
    return charges, closings


def _ways(on: Integers, goes: Integers, *further: Integers) -> tuple[Integers, Integers]:
    """Moves between two sites side by side, each kind once: to the second one's row from the first, and back, lengths and times, and what
    there is of ``_further``."""
    held: list[Integers] = []
    places = []
    for matrix in (on, on.transpose(0, 2, 1), goes, goes.transpose(0, 2, 1), *(further or (goes, goes, goes))):
        place = next((k for k, known in enumerate(held) if np.array_equal(known, matrix)), len(held))
        if place == len(held):
            held.append(matrix)
        places.append(place)
    ways = held[0][..., None] if len(held) == 1 else np.stack(held, axis=-1)
    return np.ascontiguousarray(ways), np.array(places)[[1, 0, 3, 2, 4, 5, 6]]


def _metric(on: Integers, near: Integers, customers: Integers, ends: Integers) -> bool:
    """Whether no way between two of ten near customers and ten depots is shorter by a customer, but for rounded lengths."""
    about = np.column_stack([near[customers, :10], np.tile(ends[:10], (len(customers), 1))])
    a, b, c = about[:, :, None], about[:, None, :], customers[:, None, None]
    shorter = (on[:, a, c] + on[:, c, b] - on[:, a, b] < -2) & (a != b) & (a >= 0) & (b >= 0) & (a != c) & (b != c)
    return not shorter.any()


def _near(
    data: IntegerRouting, customers: Integers, on: Integers, goes: Integers, many: int
) -> tuple[Integers, Integers, Integers, Integers]:
    """The customers next to each site, nearest first, the ``reach`` and ``drive`` of ``search_kernels.anneal``, and the least time from
    each site to any other, of moves of shape (1, sites, sites).

    Near is who can come right before or right after it, over a short way and without much waiting (the proximity of Vidal, Crainic,
    Gendreau and Prins 2013, Computers & Operations Research 40(1), with a weight of 0.2 for time that is lost).
    """
    from .near_kernels import nearest

    on, goes, sites = np.ascontiguousarray(on[0]), np.ascontiguousarray(goes[0]), on.shape[-1]
    weight, latest = WAITING * on.mean() / max(1.0, goes.mean()), np.minimum(data.due, MOST) + data.service
    visited = np.zeros(sites, dtype=bool)
    visited[customers] = True
    many = max(1, min(many, len(customers) - 1))
    near, reach, drive = (np.empty((sites, many), dtype=np.int64) for _ in range(3))
    quickest = np.empty(sites, dtype=np.int64)
    nearest(on, goes, data.ready, data.due, data.service, latest, visited, weight, MOST, near, reach, drive, quickest, np.empty(many))
    return near, reach, drive, quickest
