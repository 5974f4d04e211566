"""The problem of the next horizon, from a plan in progress: vehicles under way start where they will be, with what they have left.

The virtual nodes of Mitchell (2020), sections 3.2 and 5: each vehicle under way gets a start of its own, the next stop of its route, and
must drive home from there whether it serves anybody else or not.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...instances.clock import moment_told
from ...instances.errors import UsageError
from ...instances.routing.instance import placed
from ...instances.routing.sites import COLUMNS
from .routes import Routes
from .schedule import opening, schedule

if TYPE_CHECKING:
    from ...instances.routing.vehicle_type import Energy, VehicleType
    from .problem import RoutingProblem

REFUSED = ("pickups", "shipments", "reloads", "several-loads", "team-risk")
"""Features for which a place, a time and the remaining resources do not describe a vehicle that is already on its route."""


class UnderWay(NamedTuple):
    """A vehicle that is on its route: its type, the stop it is committed to, and what it has left there."""

    kind: int
    stop: int
    leaves: float
    elapsed: float
    since_opening: float
    distance: float
    on_the_move: float
    load: float


def continued(problem: RoutingProblem, plan: Routes, time: float) -> RoutingProblem:
    """The rest of ``problem`` at ``time``, if ``plan`` has been driven until then; see ``RoutingProblem.continue_from``."""
    if not math.isfinite(time):
        raise UsageError(f"a horizon begins at a moment, not at {time}", "out-of-range")
    _refuse(problem, plan)
    done, under_way, gone = _at(problem, plan, time)
    sites, starts = problem.sites, {v.stop for v in under_way}
    fleet = [*_fresh(problem, gone, time), *_committed(problem, under_way)]
    if not fleet:
        raise UsageError(f"no vehicle is left at {moment_told(problem.clock, time)}", "missing")
    columns: dict[str, Any] = {name: np.array(getattr(sites, name)) for name in COLUMNS}
    for v in under_way:
        if not sites.depot[v.stop]:
            for values in columns.values():
                values[v.stop] = 0
            columns["depot"][v.stop] = True
            columns["ready"][v.stop] = columns["due"][v.stop] = v.leaves
    columns["ready"][sites.depot] = np.maximum(sites.ready[sites.depot], time)
    columns["due"] = np.maximum(columns["due"], columns["ready"])
    taken = done | starts  # of a group that is decided no other member is visited any more
    decided = {k for g in sites.groups if taken & set(g.sites) for k in g.sites}
    used = {k for v in fleet for k in (v.start, v.end, *v.reloads, *v.stations)}
    unplanned = set(problem.customers.tolist()) - taken - decided
    if not unplanned:
        raise UsageError(
            f"nothing is left to plan at {moment_told(problem.clock, time)}: every site is served or next on its route", "missing"
        )
    keep = np.array(sorted(unplanned | used), dtype=np.int64)
    changed = replace(
        sites, windows=tuple(() if k in starts else w for k, w in enumerate(sites.windows)),
        groups=tuple(g for g in sites.groups if not taken & set(g.sites)), **columns,
    )  # fmt: skip
    forbidden = None if problem.forbidden is None else problem.forbidden[np.ix_(keep, keep)]
    return replace(
        problem, forbidden=forbidden, needed=(), exceeded={}, sites=changed.subset(keep), travel=problem.travel.subset(keep),
        fleet=tuple(placed(v, keep) for v in fleet), min_vehicles=0, name=f"{problem.name} from {time:g}",
    )  # fmt: skip


def _refuse(problem: RoutingProblem, plan: Routes) -> None:
    """Raise UsageError for a plan that breaks a constraint, but for the visits of sites that it does not know: those are new orders."""
    refused = problem.features() & set(REFUSED)
    if refused:
        raise UsageError(f"a plan in progress cannot be continued with {', '.join(sorted(refused))}", "unsupported")
    problem.check_start(plan)
    visited = np.zeros(len(problem.sites), dtype=bool)
    visited[[site for route in plan for site in route.visits]] = True
    groups = tuple(replace(g, required=g.required and bool(visited[list(g.sites)].any())) for g in problem.sites.groups)
    known = replace(problem.sites, required=problem.sites.required & visited, groups=groups)
    verdict = problem.altered(sites=known).evaluate(plan)
    if not verdict.feasible:
        raise UsageError(f"the plan that is to be continued breaks a constraint: {verdict.violations[0].message}")


def _at(problem: RoutingProblem, plan: Routes, time: float) -> tuple[set[int], list[UnderWay], list[int]]:
    """Sites begun before ``time``, vehicles under way then, and how many of each type are not at home."""
    done: set[int] = set()
    under_way: list[UnderWay] = []
    gone = [0] * len(problem.fleet)
    for route in plan:
        vehicle = problem.fleet[route.vehicle]
        run = schedule(problem, route)
        if run.departure >= time:
            continue  # it has not left: the vehicle is free, its sites are still to be planned
        stops = [k for k, begin in enumerate(run.begin.tolist()) if begin >= time]
        done.update(route.visits if not stops else route.visits[: stops[0]])
        if not stops:
            gone[route.vehicle] += run.finish > time  # on its way home
            continue
        gone[route.vehicle] += 1
        k = stops[0]
        travel = problem.travel_of(route.vehicle)
        at = [vehicle.start, *route.visits[: k + 1]]
        refilled = max([0, *(n for n, site in enumerate(at) if n and site in vehicle.stations)])
        moved = travel.duration(np.array(at[refilled:-1]), np.array(at[refilled + 1 :]))
        off = float(run.ends[k])
        under_way.append(
            UnderWay(
                route.vehicle,
                route.visits[k],
                off,
                off - run.departure,
                off - opening(problem, vehicle),
                float(run.distance[k]),
                math.fsum(moved),
                float(run.total_load - run.load[k]),
            )
        )
    return done - set(problem.sites.depots.tolist()), under_way, gone


def _fresh(problem: RoutingProblem, gone: list[int], time: float) -> list[VehicleType]:
    """Vehicles at home: those that have not left, and those that are back, with full stores; committed ones if they leave later."""
    kinds = []
    for vehicle, away in zip(problem.fleet, gone, strict=True):
        count = None if vehicle.count is None else vehicle.count - away
        late = opening(problem, vehicle) if vehicle.committed else min(vehicle.shift[1], float(problem.sites.due[vehicle.start]))
        if count != 0 and late >= time:
            kinds.append(replace(vehicle, count=count))
    return kinds


def _committed(problem: RoutingProblem, under_way: list[UnderWay]) -> list[VehicleType]:
    """One type for each vehicle under way."""
    kinds = []
    for number, v in enumerate(under_way, start=1):
        old = problem.fleet[v.kind]
        kinds.append(
            replace(
                old, count=1, start=v.stop, capacity=old.capacity if math.isinf(old.capacity) else v.load, fixed_cost=0.0, committed=True,
                max_duration=max(0.0, old.max_duration - v.elapsed), regular_duration=max(0.0, old.regular_duration - v.elapsed),
                max_distance=max(0.0, old.max_distance - v.distance), shift=(v.leaves, max(v.leaves, old.shift[1])),
                energy=None if old.energy is None else _left(old.energy, v), name=f"{old.name} under way {number}",
            )
        )  # fmt: skip
    return kinds


def _left(energy: Energy, v: UnderWay) -> Energy:
    """The store on leaving the next stop. The departure of a vehicle under way is fixed, whatever it was charged for."""
    if energy.charge == "travel":
        drawn = energy.rate * v.on_the_move
        filled = v.on_the_move == 0.0 and v.stop in energy.stations
        level = energy.capacity if filled else max(0.0, energy.at_departure - drawn)
        return replace(energy, initial=level) if energy.stations else replace(energy, capacity=level, initial=None)
    drawn = energy.rate * (v.elapsed if energy.charge == "elapsed" else v.since_opening)
    charge = "elapsed-fixed-start" if energy.charge == "elapsed" else energy.charge
    return replace(energy, capacity=max(0.0, energy.at_departure - drawn), initial=None, charge=charge)
