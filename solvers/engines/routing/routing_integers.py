"""Routing data as integers, for engines that count in integers: one place, one rule of rounding.

Data of extraordinary size are first brought to an ordinary one by a power of two. Data that at most three decimals hold are scaled exactly;
all others by 1e6, consumption up and limits down, so that whatever is feasible for the integers is feasible for the data.
"""

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from ....formulations.programs.exactness import Exactness, Link
from ....formulations.routing.problem import RoutingProblem
from ....instances.errors import InputError
from ....instances.routing.travel import Travel
from .extents import distances_of
from .integer_scales import FINE, UNLIMITED, Floats, Integers, Scale, Strips, plain, scale_of, whole
from .routing_objective import Scalar, scalarised, stops_between

_PRECISE = 10_000
"""Least price of a unit of time that no power of ten makes whole."""

MOST_PRIZES = 1 << 58
"""Sum of all prizes up to which they can be added to other costs."""

SLOPE = 1 << 20
"""Length of the longest move, where lengths only tell which of two equal answers is shorter."""


@dataclass(frozen=True, eq=False)
class Moves:
    """Moves of vehicles of one kind, int arrays of shape (sites, sites).

    They are made when they are first asked for: a matrix of 5,000 sites is one of 200 MB, and few engines look at all of them.
    ``distance``, for costs, is rounded to the nearest; ``distance_up`` and ``duration``, for limits, up, as is ``charge``, the time charged
    for a move by ``energy:windows`` (None where nobody is charged so). ``closing`` is the latest time at which a move may begin (None where
    none closes).
    """

    lengths: Strips
    times: Strips
    length: Scale
    clock: Scale
    charge: Integers | None
    closing: Integers | None

    @cached_property
    def distance(self) -> Integers:
        return _matrix(self.lengths, self.length.nearest)

    @cached_property
    def distance_up(self) -> Integers:
        return self.distance if self.length.exact else _matrix(self.lengths, self.length.up)

    @cached_property
    def duration(self) -> Integers:
        if self.times is self.lengths and self.length.exact and self.clock == self.length:
            return self.distance
        return _matrix(self.times, self.clock.up)

    def forget(self) -> None:
        """Free the memory of the matrices; they are made again where they are asked for again."""
        for name in ("distance", "distance_up", "duration"):
            self.__dict__.pop(name, None)

    @property
    def longest(self) -> int:
        """The largest of ``distance_up``, which is not made for it."""
        return int(self.length.up([self.lengths.largest])[0])

    @property
    def slowest(self) -> int:
        """The largest of ``duration``, which is not made for it."""
        return int(self.clock.up([self.times.largest])[0])


@dataclass(frozen=True, eq=False)
class IntegerRouting:
    """A routing problem in integers; ``UNLIMITED`` where there is no limit.

    ``moves`` has an entry for each travel, speed and, where it is charged for, opening of a vehicle; ``profile`` is that of each vehicle
    type. Times count from the earliest ready time if that is negative, else from 0. ``windows`` has one or several pairs (ready, due) a
    site. Loads have one column a dimension.

    Of the arrays with an entry a vehicle type, ``unit``, ``fixed``, ``time`` and ``overtime`` are costs of a unit of distance, of a route,
    of a unit of duration and of one beyond the regular duration; ``counted`` is the part of ``fixed`` that counts routes. No vehicle can be
    used where ``closes`` is before ``opens``; ``leaves`` is the latest departure. Energy becomes limits on time: ``travel_limit`` on the
    move (``travel_reach`` as a distance, where moves take as long as they are), ``charge_limit`` by windows, and ``latest_return`` of a
    route that starts when its depot opens; ``store`` is the time on the move that a store lasts which is filled up on the way,
    ``store_lacking`` what it lacks of that at departure.

    ``prize`` is the value of a visit in units of cost; ``maxima`` are costs of a unit of the largest duration, distance and return, in the
    order of ``routing_objective.MAXIMA``; ``cost_factor`` is the number of integers in one unit of the objective; ``scales`` are for the
    report.
    """

    moves: tuple[Moves, ...]
    profile: Integers
    service: Integers
    ready: Integers
    due: Integers
    windows: tuple[tuple[tuple[int, int], ...], ...]
    demand: Integers
    pickup: Integers
    shipped: Integers
    prize: Integers
    capacity: Integers
    max_duration: Integers
    max_distance: Integers
    regular_duration: Integers
    unit: Integers
    fixed: Integers
    counted: Integers
    time: Integers
    overtime: Integers
    opens: Integers
    leaves: Integers
    closes: Integers
    travel_limit: Integers
    travel_reach: Integers
    charge_limit: Integers
    latest_return: Integers
    store: Integers
    store_lacking: Integers
    maxima: Integers
    cost_factor: float
    scales: dict[str, Any]

    @property
    def limited(self) -> list[int]:
        """Load dimensions in which some capacity may be exceeded."""
        carried = self.demand.any(axis=0) | self.pickup.any(axis=0) | self.shipped.any(axis=0)
        return [int(k) for k in np.nonzero(carried & (self.capacity != UNLIMITED).any(axis=0))[0]]

    def fewest(self) -> int:
        """Least number of vehicles for the loads, were all of the roomiest type; 0 where loads limit nothing."""
        needs = [0]
        for k in self.limited:
            roomiest = int(self.capacity[:, k].max())
            if roomiest not in (0, UNLIMITED):
                needs.append(-(-int(max(self.demand[:, k].sum(), self.pickup[:, k].sum())) // roomiest))
        return max(needs)

    def moves_of(self, kind: int) -> Moves:
        """Moves of a vehicle type."""
        return self.moves[int(self.profile[kind])]

    @property
    def holds(self) -> Exactness:
        """Exactness of claims for these integers: limits are rounded to the safe side where they are rounded at all."""
        return Exactness.EXACT if self.scales["exact"] else Exactness.RESTRICTION

    @property
    def link(self) -> Link:
        """The scaling of the data, for the chain that a solution shows."""
        units = ", ".join(f"{name} times {factor:g}" for name, factor in self.scales.items() if name != "exact")
        return Link("whole-numbers", self.holds, units)


def integer_routing(problem: RoutingProblem, *, largest: int = 2**44, total: int = 2**60, fine: int = FINE) -> IntegerRouting:
    """The data of ``problem``, whose objective is one sum (``scalarised``), in integers.

    Raises InputError, which names the largest value, where a single value is beyond ``largest``, or a sum along a whole answer may be
    beyond ``total``. ``fine`` is the scale of data that three decimals cannot hold, for engines with little room.
    """
    sites, fleet = problem.sites, problem.fleet
    scaled = partial(scale_of, fine=fine, room=_room(largest, total, len(sites)))
    goal = scalarised(problem)
    travels, profile = _profiles(problem)
    strips = [distances_of(travel) for travel, _ in travels]
    served = sites.service if any(v.reloads or v.stations for v in fleet) else np.where(sites.depot, 0.0, sites.service)
    opening = np.array([max(float(sites.ready[v.start]), v.shift[0]) for v in fleet])
    closing = np.array([min(float(sites.due[v.end]), v.shift[1]) for v in fleet])
    regular = np.where(goal.overtime > 0, [v.regular_duration for v in fleet], math.inf)
    moments = [moment for windows in sites.windows for window in windows for moment in window]
    closings = [travel.closing for travel, _ in travels if travel.closing is not None]
    # Deviations of uncertain durations, roots of sums, lie on no grid.
    roots = [[math.sqrt(0.5)]] if problem.features() & {"route-risk", "team-risk"} else []
    clock = scaled(*(times for _, times in strips), *closings, served, sites.ready, sites.due, opening, regular, moments, *roots)
    length, per_unit, cost, per_time = _prices(goal, [lengths for lengths, _ in strips], clock, scaled)

    origin = min(0.0, float(sites.ready.min()))
    service, windows = _windows(problem, served, clock, origin)
    due = np.array([listed[-1][1] for listed in windows], dtype=np.int64)
    budgets, store, at_departure = _energy(problem)
    opens = clock.up(opening - origin)
    latest_return = clock.down(opening - origin + budgets["elapsed-fixed-start"])
    closes = np.minimum(clock.down(closing - origin), latest_return)
    loads, capacity, load = _loads(problem, scaled)
    integers = IntegerRouting(
        moves=tuple(
            _moves(problem, t, each, at, length, clock, served, origin) for (t, at), each in zip(travels, strips, strict=True)
        ),
        profile=np.array(profile, dtype=np.int64),
        service=service,
        ready=np.array([listed[0][0] for listed in windows], dtype=np.int64),
        due=due,
        windows=tuple(tuple(listed) for listed in windows),
        demand=loads[0], pickup=loads[1], shipped=loads[2],
        prize=cost.nearest(goal.prize),
        capacity=capacity,
        max_duration=np.minimum(clock.down([v.max_duration for v in fleet]), clock.down(budgets["elapsed"])),
        max_distance=length.down([v.max_distance for v in fleet]),
        regular_duration=clock.down(regular),
        unit=per_unit.nearest(goal.unit),
        fixed=cost.nearest(goal.fixed), counted=cost.nearest(goal.counted),
        time=per_time.nearest(goal.time),
        overtime=per_time.nearest(goal.overtime),
        opens=opens, leaves=np.minimum(np.maximum(opens, due[[v.start for v in fleet]]), closes), closes=closes,
        travel_limit=clock.down(budgets["travel"]),
        travel_reach=length.down(budgets["travel"]),
        charge_limit=clock.down(budgets["windows"]),
        latest_return=latest_return,
        store=clock.down(store), store_lacking=clock.down(store) - clock.down(at_departure),
        maxima=np.concatenate([p.nearest([m]) for p, m in zip((per_time, per_unit, per_time), goal.maxima, strict=True)]),
        cost_factor=cost.factor,
        scales={
            "cost": cost.factor, "distance": length.factor, "time": clock.factor, "load": load.factor,
            "exact": cost.exact and clock.exact and load.exact and per_time.exact,
        },
    )  # fmt: skip
    _check_headroom(integers, len(sites), largest, total)
    return integers


def fitting_integers(problem: RoutingProblem, *, largest: int, total: int, scales: Sequence[int]) -> IntegerRouting:
    """The integers with the first of ``scales``, for data that three decimals cannot hold, that leaves an engine room for its sums."""
    for fine in scales[:-1]:
        with suppress(InputError):
            return integer_routing(problem, largest=largest, total=total, fine=fine)
    return integer_routing(problem, largest=largest, total=total, fine=scales[-1])


def with_slope(problem: RoutingProblem, data: IntegerRouting, *, maxima: bool = False) -> IntegerRouting:
    """The data with a price of distance where no move has a price, but sites are rewarded, vehicles counted, or stops made on the way.

    Of answers that are equal the shorter one is better then, and no other order changes: a step of what counts outweighs all the distance
    that the limits of routes leave. Without a price a local search has no direction, and ends with the first routes that are full. With
    ``maxima`` also beside the largest of all routes, which is a slope only for the largest one.
    """
    priced, stops = bool(data.time.any() or data.overtime.any()), stops_between(problem)
    timed = priced or bool(data.maxima.any())
    if data.unit.any() or ((priced or (timed and not maxima)) and not stops):
        return data
    fine, data = data, _coarse(data)
    costs = {name: getattr(data, name) for name in ("fixed", "counted", "time", "overtime", "maxima", "prize")}
    step = max(1, int(np.gcd.reduce(np.concatenate([*costs.values()]))))
    outweighed, moves = 1 + _farthest(problem, data), 2 * len(problem.customers) * (1 + stops)
    most = 1 + sum(int((v // step).sum()) for v in costs.values())
    if timed:
        slowest = moves * max(m.slowest for m in data.moves)
        most *= outweighed + slowest + moves * int(data.service.max()) + int(max(data.opens.max(), data.ready.max()))
    if outweighed * most > UNLIMITED // 4:
        return fine
    dearer = {name: v // step * outweighed for name, v in costs.items()}
    return replace(data, **dearer, unit=np.ones_like(data.unit), cost_factor=data.cost_factor * outweighed / step)


def searched_integers(problem: RoutingProblem) -> tuple[IntegerRouting, bool]:
    """The integers of a problem for searches that add prizes to other costs, and whether a slope was added (``with_slope``)."""
    data = integer_routing(problem)
    sloped = with_slope(problem, data, maxima=True)
    sloped = sloped if int(sloped.prize.sum()) < MOST_PRIZES else data
    return sloped, sloped is not data


def _coarse(data: IntegerRouting) -> IntegerRouting:
    """The data with lengths of some six digits where these limit nothing: no larger prices are needed to outweigh them then, beside which
    limits of times and loads would count for little."""
    longest = max(m.longest for m in data.moves)
    if longest <= SLOPE or (data.max_distance != UNLIMITED).any() or (data.travel_reach != UNLIMITED).any():
        return data
    coarser = 1 << math.ceil(math.log2(longest / SLOPE))
    factor = data.moves[0].length.factor / coarser
    moves = tuple(replace(m, length=Scale(factor, False)) for m in data.moves)
    return replace(data, moves=moves, scales={**data.scales, "distance": factor}, maxima=data.maxima * np.array([1, coarser, 1]))


def _farthest(problem: RoutingProblem, data: IntegerRouting) -> int:
    """No feasible answer is longer than this, all routes together."""
    most, stops = len(problem.customers), stops_between(problem)
    limits = data.max_distance.tolist()
    if data.scales["distance"] == data.scales["time"]:  # then a limit on time is one on distance where moves take as long as they are
        for k, limit in enumerate(limits):
            if not problem.travel_of(k).own_durations:
                hours = int(data.closes[k]) - int(data.opens[k])
                limits[k] = min(limit, int(data.max_duration[k]), int(data.travel_reach[k]), max(0, hours))
    counts = [most if v.count is None else min(v.count, most) for v in problem.fleet]
    limited: int = sum(count * limit for count, limit in zip(counts, limits, strict=True))
    return min(limited, 2 * most * (1 + stops) * max(m.longest for m in data.moves))


def _prices(goal: Scalar, lengths: list[Strips], clock: Scale, scaled: Callable[..., Scale]) -> tuple[Scale, Scale, Scale, Scale]:
    """Scales of distances, of prices of a unit of distance, of costs, and of prices of a unit of time."""
    per_unit = scaled(np.concatenate([goal.unit, goal.maxima[1:2]]))
    length = scaled(*lengths, goal.fixed * per_unit.factor, goal.prize * per_unit.factor)
    priced = np.concatenate([goal.time, goal.overtime, goal.maxima[[0, 2]]])
    finer = _finer(priced * (per_unit.factor * length.factor / clock.factor))
    per_unit = Scale(plain(per_unit.factor * finer), per_unit.exact)
    cost = Scale(plain(length.factor * per_unit.factor), length.exact and per_unit.exact)
    return length, per_unit, cost, Scale(cost.factor / clock.factor, bool(whole(priced * (cost.factor / clock.factor)).all()))


def _windows(problem: RoutingProblem, served: Floats, clock: Scale, origin: float) -> tuple[Integers, list[list[tuple[int, int]]]]:
    """Service times and windows of all sites, rounded inwards."""
    sites = problem.sites
    opens, closes, service = clock.up(sites.ready - origin), clock.down(sites.due - origin), clock.up(served)
    windows = [[pair] for pair in zip(opens.tolist(), closes.tolist(), strict=True)]
    for site, listed in enumerate(sites.windows):
        if listed:
            windows[site] = [(int(clock.up(r - origin)), int(clock.down(d - origin))) for r, d in listed]
    for site in problem.customers.tolist():
        # A window without an integer in it: begin at the integer below, and count the difference as service.
        service[site] += any(r > d for r, d in windows[site])
        windows[site] = [(min(r, d), d) for r, d in windows[site]]
    return service, windows


def _energy(problem: RoutingProblem) -> tuple[dict[str, Floats], Floats, Floats]:
    """Energy as time, one entry a vehicle type: limits by charge; what a store holds that is filled up on the way, and at departure."""
    limits = {kind: np.full(len(problem.fleet), math.inf) for kind in ("travel", "elapsed", "elapsed-fixed-start", "windows")}
    store, at_departure = np.full((2, len(problem.fleet)), math.inf)
    for k, vehicle in enumerate(problem.fleet):
        if vehicle.energy is None:
            continue
        if vehicle.stations:
            store[k], at_departure[k] = (held / vehicle.energy.rate for held in (vehicle.energy.capacity, vehicle.energy.at_departure))
        else:
            limits[vehicle.energy.charge][k] = vehicle.energy.at_departure / vehicle.energy.rate
    return limits, store, at_departure


def _profiles(problem: RoutingProblem) -> tuple[list[tuple[Travel, tuple[int, float] | None]], list[int]]:
    """Different travels, each with the depot and the opening of vehicles that are charged from it, and the entry of each vehicle type."""
    travels: list[tuple[Travel, tuple[int, float] | None]] = []
    keys: dict[Any, int] = {}
    profile = []
    for k, vehicle in enumerate(problem.fleet):
        charged = vehicle.energy is not None and vehicle.energy.charge == "windows"
        at = (vehicle.start, max(float(problem.sites.ready[vehicle.start]), vehicle.shift[0])) if charged else None
        key = (id(vehicle.travel), vehicle.speed, at)
        if key not in keys:
            keys[key] = len(travels)
            travels.append((problem.travel_of(k), at))
        profile.append(keys[key])
    return travels, profile


def _moves(
    problem: RoutingProblem, travel: Travel, strips: tuple[Strips, Strips], at: tuple[int, float] | None, length: Scale, clock: Scale,
    served: Floats, origin: float,
) -> Moves:  # fmt: skip
    charge = None
    if at is not None:
        sites = problem.sites
        ready = sites.ready.copy()
        ready[at[0]] = at[1]
        waited = np.where(sites.depot[None, :], -math.inf, sites.ready[None, :] - ready[:, None])
        charge = clock.up(np.maximum(served[:, None] + travel.durations, waited))
        np.fill_diagonal(charge, 0)
    closing = None if travel.closing is None else clock.down(travel.closing - origin)
    return Moves(*strips, length, clock, charge, closing)


def _matrix(values: Strips, rounded: Callable[[Floats], Integers]) -> Integers:
    strips = iter(values.strips())
    head = rounded(next(strips))
    matrix, first = np.empty((head.shape[1],) * 2, dtype=np.int64), len(head)
    matrix[:first] = head
    for strip in strips:
        matrix[first : first + len(strip)] = rounded(strip)
        first += len(strip)
    return matrix


def _loads(problem: RoutingProblem, scaled: Callable[..., Scale]) -> tuple[list[Integers], Integers, Scale]:
    """Demands, pickups and shipments, capacities, and the scale of them all."""
    sites, dimensions = problem.sites, problem.sites.dimensions
    carried = [np.column_stack([sites.demand, sites.further_demand]), np.column_stack([sites.pickup, sites.further_pickup])]
    for values in carried:
        values[sites.depot] = 0.0
    shipped = np.zeros((len(sites.shipments), dimensions))
    for k, shipment in enumerate(sites.shipments):
        shipped[k, : len(shipment.load)] = shipment.load
    room = np.full((len(problem.fleet), dimensions), math.inf)
    for k, vehicle in enumerate(problem.fleet):
        held = vehicle.capacities[:dimensions]
        room[k, : len(held)] = held
    load = scaled(*carried, shipped)
    whole, capacity = [load.up(values) for values in (*carried, shipped)], load.down(room)
    common = max(1, int(np.gcd.reduce(np.concatenate([values.ravel() for values in whole]))))
    capacity = np.where(capacity == UNLIMITED, UNLIMITED, capacity // common)
    return [values // common for values in whole], capacity, Scale(plain(load.factor / common), load.exact)


def _finer(prices: Floats) -> int:
    """Power of ten that makes prices of time whole, or precise where none does."""
    power = next((10**k for k in range(13) if whole(prices * 10**k).all()), None)
    if power is not None or not prices.any():
        return power or 1
    return int(10 ** max(0, math.ceil(math.log10(_PRECISE / float(prices[prices > 0].min())))))


def _room(largest: int, total: int, sites: int) -> int:
    """Largest single value such that a sum along an answer, of two moves a site at most, fits too."""
    return min(largest, total // max(1, 2 * sites))


def _check_headroom(integers: IntegerRouting, sites: int, largest: int, total: int) -> None:
    """Refuse data whose sums could overflow."""
    singles = {
        "distance": (np.array([m.longest for m in integers.moves]), integers.scales["distance"]),
        "duration": (np.array([m.slowest for m in integers.moves]), integers.scales["time"]),
        "service time": (integers.service, integers.scales["time"]),
        "ready time": (integers.ready, integers.scales["time"]),
        "demand": (integers.demand, integers.scales["load"]),
        "pickup": (integers.pickup, integers.scales["load"]),
        "shipment": (integers.shipped, integers.scales["load"]),
        "fixed cost": (integers.fixed, integers.scales["cost"]),
        "reward": (integers.prize, integers.scales["cost"]),
    }
    dearest = int(max(integers.time.max() + integers.overtime.max(), *integers.maxima[[0, 2]]))
    prices = dict.fromkeys(("duration", "service time", "ready time"), dearest)
    prices["distance"] = int(max(integers.unit.max(), integers.maxima[1]))
    for what, (values, factor) in singles.items():
        top = int(values.max(initial=0))
        limit = _room(largest, total, sites) // max(1, prices.get(what, 1))
        if top > limit:
            raise InputError(
                f"the largest {what} is too large for an engine that counts in integers (scaled by {factor})", "out-of-range",
                expected=f"at most {limit / factor:g}", found=f"{top / factor:g}",
            )  # fmt: skip


def entangled(problem: RoutingProblem) -> frozenset[str]:
    """Further uses of the ends of shipments, for engines to which these are stops for one shipment alone; empty where there are none."""
    sites = problem.sites
    ends = [site for shipment in sites.shipments for site in (shipment.pickup, shipment.delivery)]
    grouped = {site for group in sites.groups for site in group.sites}
    lacking = set()
    if len(set(ends)) < len(ends):
        lacking.add("several shipments of one site")
    if sites.demand[ends].any() or sites.pickup[ends].any() or sites.further_demand[ends].any() or sites.further_pickup[ends].any():
        lacking.add("shipments of sites with demands or pickups")
    if grouped.intersection(ends):
        lacking.add("shipments of groups")
    return frozenset(lacking)
