"""Nodes, tightened windows, arcs that some route can use, and their costs: what every arc-based form needs first.

Nodes are the depot where routes start (0), the customers in site order (1 to n), copies of the depots where vehicles reload or
recharge on their way, each for one stop (``copies``), and the depot where routes end. Resources and how their ranges are tightened:
docs/formulations/routing.md#preparation. Source: Desrosiers, Dumas, Solomon, Soumis (1995), section 4.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...instances.routing.instance import VehicleType
from ...instances.routing.reach import least_levels
from ..tolerance import LIMIT, widened
from .problem import RoutingProblem
from .routes import Flags, Floats

Nodes = NDArray[np.int32]

SHORT = 1e-5
"""Moves of at most this part of a resource's range may close a cycle within a solver's tolerances (1e-6 a row), so they count as zero."""

_ROUNDS = 20


@dataclass(frozen=True, eq=False)
class Resource:
    """Something that grows along a route.

    ``weight`` is what a move adds, shape (nodes, nodes), in a ``Preparation`` (arcs,): to time, the service at its tail and the move; to
    load, the demand at its head. ``lower`` and ``upper`` are the range of the level at each node, all finite in a ``Preparation``. Where
    a level ``waits``, it may be raised at will; else it is the sum of the weights.
    """

    name: str
    weight: Floats
    lower: Floats
    upper: Floats
    waits: bool = False

    @property
    def tolerance(self) -> float:
        """Amount by which a level may exceed its range and still count as within it: a route of exactly its limit is feasible."""
        return LIMIT * self.size

    @property
    def size(self) -> float:
        """The largest level of the range."""
        finite = np.concatenate([self.lower, self.upper])
        return float(np.abs(finite[np.isfinite(finite)]).max(initial=0.0))


@dataclass(frozen=True, eq=False)
class Preparation:
    """Arrays of a routing problem for one vehicle type.

    Both ends of a route are nodes of their own. ``required`` and ``usable`` mark customers that must be visited and nodes that some route
    can visit; arcs are in order of ``tail`` and ``head``, without the idle move from start to end, ``cost`` being an arc's share in the
    first level of the objective. ``resources`` has ``time`` always, the others where they are limited; ``fleet`` is the largest number of
    routes. Programs are restrictions unless the moves are ``whole``.
    """

    vehicle: int
    sites: NDArray[np.int64]
    required: Flags
    usable: Flags
    tail: Nodes
    head: Nodes
    distance: Floats
    duration: Floats
    cost: Floats
    demand: Floats
    service: Floats
    resources: dict[str, Resource]
    fleet: int
    whole: bool = True

    @property
    def customers(self) -> int:
        """Number of customers and of copies of depots."""
        return len(self.sites) - 2

    @property
    def nodes(self) -> int:
        return len(self.sites)

    @property
    def end(self) -> int:
        """Node where routes end; they start at node 0."""
        return len(self.sites) - 1

    @property
    def time(self) -> Resource:
        return self.resources["time"]


def prepare(problem: RoutingProblem, vehicle: int = 0) -> Preparation:
    """Prepare a routing problem for the routes of one vehicle type.

    Customers that no route of this type can visit have no arcs, and ranges that are finite but mean nothing.
    """
    kind, sites, travel = problem.fleet[vehicle], problem.sites, problem.travel_of(vehicle)
    stops = copies(problem)
    at = np.concatenate([[kind.start], problem.customers, stops, [kind.end]]).astype(np.int64)
    n = len(problem.customers)
    grid = np.ix_(at, at)
    distance, duration = travel.distances[grid], travel.durations[grid]
    served = np.zeros(len(at))
    served[1 : n + 1] = 1.0
    stays = served.copy()
    stays[n + 1 : -1] = 1.0
    demand, service = sites.demand[at] * served, sites.service[at] * stays

    ready, due, latest = sites.ready[at], sites.due[at], sites.ready[at]
    ready[0], due[-1] = max(float(ready[0]), kind.shift[0]), min(float(due[-1]), kind.shift[1])
    if sites.windows:
        for node, site in enumerate(at.tolist()):
            latest[node] = sites.windows[site][-1][0] if sites.windows[site] else latest[node]
    closes = None if travel.closing is None else travel.closing[grid]
    allowed = _possible(problem, kind, at, n, duration)
    if closes is not None:
        allowed &= (ready + service)[:, None] <= widened(closes)
    resources = limited_resources(kind, ready, due, distance, duration, service, demand, latest)
    if not kind.reloads:
        resources |= _further_loads(problem, kind, at, served)
    resources = tightened(resources, allowed)
    if closes is not None:
        allowed &= (resources["time"].lower + service)[:, None] <= widened(closes)
    usable = np.ones(len(at), dtype=bool)
    for r in resources.values():
        usable &= np.isfinite(r.lower) & np.isfinite(r.upper)
    usable[[0, -1]] = True

    tail, head = np.nonzero(allowed)
    arcs = {name: _on_arcs(r, allowed, ready, usable) for name, r in resources.items()}
    most = n if kind.count is None else kind.count if kind.committed else min(kind.count, n)
    return Preparation(
        vehicle, at, sites.required[at] & (served > 0), usable, tail.astype(np.int32), head.astype(np.int32), distance[allowed],
        duration[allowed], _costs(problem, kind, at, tail, head, distance[allowed], (service[:, None] + duration)[allowed], served),
        demand, service, arcs, most,
    )  # fmt: skip


def copies(problem: RoutingProblem) -> NDArray[np.int64]:
    """Depots where vehicles stop on their way, each as often as an answer ever has to.

    A stop at the same depot twice between two sites, or before the first and after the last of a route, is of no use, so that each depot
    needs one copy for each site and each route; fewer where reloads are limited.
    """
    n, stops = len(problem.customers), []
    routes = min(n, sum(n if v.count is None else v.count for v in problem.fleet))
    for depot in sorted({site for v in problem.fleet for site in (*v.reloads, *v.stations)}):
        most = 0
        for v in problem.fleet:
            gaps = n + routes
            if depot in v.reloads and depot not in v.stations and v.max_reloads is not None:
                gaps = min(gaps, v.max_reloads * (n if v.count is None else v.count))
            most += gaps if depot in (*v.reloads, *v.stations) else 0
        stops += [depot] * min(most, n + routes)
    return np.array(stops, dtype=np.int64)


def _possible(problem: RoutingProblem, kind: VehicleType, at: NDArray[np.int64], customers: int, duration: Floats) -> Flags:
    """Moves between sites that the vehicle may serve and depots where it may stop."""
    allowed = every_move(len(at))
    pauses, skills = {*kind.reloads, *kind.stations}, problem.sites.skills
    for node in range(1, len(at) - 1):
        site = int(at[node])
        open_to = skills[site] <= kind.skills if skills and node <= customers else node <= customers or site in pauses
        if not open_to:
            allowed[node] = allowed[:, node] = False
    stop = np.arange(len(at)) > customers
    stop[-1] = False
    allowed &= ~(stop[:, None] & stop[None, :] & (at[:, None] == at[None, :]))
    if problem.forbidden is not None:
        allowed &= ~problem.forbidden[np.ix_(at, at)]
    if kind.energy is not None and kind.stations:
        allowed &= kind.energy.rate * duration <= widened(kind.energy.capacity)
    return allowed


def _further_loads(problem: RoutingProblem, kind: VehicleType, at: NDArray[np.int64], served: Floats) -> dict[str, Resource]:
    """The other load dimensions, and what is collected: all of it is on board in the end."""
    n, loads = len(at), {}
    for k, capacity in enumerate(kind.capacities):
        demand = problem.sites.demand[at] if k == 0 else problem.sites.further_demand[at, k - 1]
        pickup = problem.sites.pickup[at] if k == 0 else problem.sites.further_pickup[at, k - 1]
        number = "" if k == 0 else f"-{k + 1}"
        for name, amount in ((f"load{number}", demand * served), (f"pickup{number}", pickup * served)):
            if name != "load" and amount.any() and math.isfinite(capacity):
                loads[name] = Resource(name, np.broadcast_to(amount, (n, n)), np.zeros(n), np.full(n, float(capacity)))
    return loads


def offset(problem: RoutingProblem) -> float:
    """Value of the first level of the objective where no site is visited and no vehicle drives."""
    missed = math.fsum(problem.sites.penalty[problem.customers])
    return problem.constant + math.fsum(w * missed for w, t in problem.objective.levels()[0].terms if t.name == "penalties")


def waiting_is_possible(problem: RoutingProblem) -> bool:
    """Whether some customer, or depot on the way, opens only after a vehicle may depart, so that it may have to wait there."""
    sites = problem.sites
    opens = sites.ready[np.append(problem.customers, copies(problem))]
    return any(sites.windows) or any(bool((opens > max(float(sites.ready[v.start]), v.shift[0])).any()) for v in problem.fleet)


def leaves_cycles(prep: Preparation, resources: Iterable[Resource]) -> bool:
    """Whether some cycle of customers adds (almost) nothing to any resource, so that none of them forbids it."""
    short = (prep.tail != 0) & (prep.head != prep.end)
    for r in resources:
        short &= r.weight <= SHORT * r.size
    if not short.any():
        return False
    import scipy.sparse as sp
    from scipy.sparse.csgraph import connected_components

    graph = sp.csr_matrix((np.ones(int(short.sum())), (prep.tail[short], prep.head[short])), shape=(prep.nodes, prep.nodes))
    count, _ = connected_components(graph, directed=True, connection="strong")
    return bool(count < prep.nodes)


def every_move(nodes: int) -> Flags:
    """All moves but those into the start, out of the end, and from start to end; shape (nodes, nodes)."""
    allowed = ~np.eye(nodes, dtype=bool)
    allowed[:, 0] = allowed[-1, :] = allowed[0, -1] = False
    return allowed


def tightened(resources: dict[str, Resource], allowed: Flags) -> dict[str, Resource]:
    """Smallest ranges of all resources; clears from ``allowed`` the moves that no route can make.

    A range is left infinite where no route comes by. Every round is valid by itself.
    """
    for _ in range(_ROUNDS):
        before = int(allowed.sum())
        for name, r in resources.items():
            lower, upper = _ranges(r, allowed)
            narrowed = resources[name] = replace(r, lower=lower, upper=upper)
            allowed &= narrowed.lower[:, None] + r.weight <= narrowed.upper[None, :] + r.tolerance
        if int(allowed.sum()) == before:
            break
    return resources


def _ranges(r: Resource, allowed: Flags) -> tuple[Floats, Floats]:
    """Least and greatest levels at each node with which a route from start to end keeps all ranges; infinite where there is none."""
    steps, wide = np.where(allowed, r.weight, math.inf), r.tolerance
    first, last = np.full(len(steps), math.inf), np.full(len(steps), math.inf)
    first[0], last[-1] = r.lower[0], -r.upper[-1]
    # Backwards, less is more: the greatest level from which the end is reached is the least one of the negated levels.
    backwards = np.ascontiguousarray(steps.T)
    return (
        least_levels(first, steps.__getitem__, r.lower, r.upper + wide),
        0.0 - least_levels(last, backwards.__getitem__, -r.upper, wide - r.lower),
    )


def limited_resources(
    kind: VehicleType, ready: Floats, due: Floats, distance: Floats, duration: Floats, service: Floats, demand: Floats,
    latest: Floats | None = None,
) -> dict[str, Resource]:  # fmt: skip
    """All limited resources with the ranges that the data give, infinite limits of time made finite.

    The first node is where routes start, the last where they end; ``latest`` is when the last of several windows opens.
    """
    n, opening = len(ready), ready
    busy = service[:, None] + duration
    ready, due = ready.copy(), due.copy()
    ready[-1] = ready[0]  # the return ends a route: nobody waits for the depot to open
    energy = kind.energy
    if energy is not None and energy.charge == "elapsed-fixed-start":
        due[-1] = min(due[-1], ready[0] + energy.at_departure / energy.rate)
    # No earliest schedule runs longer than to the last opening, and then through the longest move out of every node.
    horizon = max(float(ready.max()), float(ready.max() if latest is None else latest[:-1].max())) + float(busy[:-1, 1:].max(axis=1).sum())
    resources = {"time": Resource("time", busy, ready, np.minimum(due, max(horizon, float(ready.max()))), waits=True)}

    def additive(name: str, weight: Floats, limit: float) -> None:
        if math.isfinite(limit):
            upper = np.full(n, float(limit))
            resources[name] = Resource(name, weight, np.zeros(n), upper)

    if demand.any() and not kind.reloads:
        additive("load", np.broadcast_to(demand, (n, n)), kind.capacity)
    additive("distance", distance, kind.max_distance)
    additive("duration", busy, kind.max_duration)
    if energy is not None and energy.charge != "elapsed-fixed-start" and not energy.stations:
        weight = {"travel": duration, "elapsed": busy}.get(energy.charge)
        if weight is None:
            weight = busy.copy()
            weight[:, :-1] = np.maximum(busy[:, :-1], opening[None, :-1] - opening[:, None])
        additive("energy", energy.rate * weight, energy.at_departure)
    return resources


def _on_arcs(r: Resource, allowed: Flags, ready: Floats, usable: Flags) -> Resource:
    """The resource with one weight per arc, and finite ranges everywhere."""
    idle = ready if r.name == "time" else np.zeros(len(ready))
    lower = np.where(usable & np.isfinite(r.lower), r.lower, idle)
    upper = np.where(usable & np.isfinite(r.upper), r.upper, idle)
    # Levels may differ by rounding where a range is a single point.
    return replace(r, weight=r.weight[allowed], lower=lower, upper=np.maximum(upper, lower))


def _costs(
    problem: RoutingProblem, kind: VehicleType, at: NDArray[np.int64], tail: NDArray[np.int64], head: NDArray[np.int64], distance: Floats,
    busy: Floats, served: Floats,
) -> Floats:  # fmt: skip
    """Share of each arc in the first level of the objective; durations are sums over arcs only where nobody waits."""
    leaves = tail == 0
    waits = waiting_is_possible(problem)
    share = {
        "total-cost": kind.unit_cost * distance + kind.fixed_cost * leaves + (0.0 if waits else kind.unit_duration_cost * busy),
        "vehicles": leaves.astype(np.float64),
        "reward": (problem.sites.reward[at] * served)[head],
        "penalties": -(problem.sites.penalty[at] * served)[head],
        "total-duration": np.zeros(len(tail)) if waits else busy,
    }
    costs = np.zeros(len(tail))
    for weight, term in problem.objective.levels()[0].terms:
        costs += weight * share.get(term.name, 0.0)
    return costs
