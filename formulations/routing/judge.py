"""Evaluation of routes from the data alone: the independent judge of every routing answer.

It knows no program and no solver, and shares no code with the forms.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...instances.clock import moment_told
from ..evaluation import Checklist, Evaluation
from ..tolerance import EQUAL, ROUNDING, allowance, widening
from .overrun import joint_overrun, route_overrun, uncertain
from .routes import Floats, Integers, Route, Routes
from .schedule import Schedule as Schedule, closing, opening, schedule as schedule

if TYPE_CHECKING:
    from ...instances.routing.vehicle_type import VehicleType
    from .problem import RoutingProblem


CHECKS = ("visits", "fleet", "load", "time-windows", "duration", "distance", "energy")
"""Checks that every answer goes through."""

FURTHER_CHECKS = {
    "forbidden-moves": "moves",
    "skills": "skills",
    "shipments": "shipments",
    "groups": "groups",
    "reloads": "reloads",
    "closing-moves": "closing-moves",
    "route-risk": "route-risk",
    "team-risk": "team-risk",
}
"""Further checks, by the feature of the data that asks for each."""


def evaluate_routes(problem: RoutingProblem, answer: Routes) -> Evaluation:
    """Objective and violations of ``answer``; see ``RoutingProblem.evaluate``."""
    sites, fleet, judge = problem.sites, problem.fleet, Checklist()
    features = problem.features()
    count, used = np.zeros(len(sites), dtype=np.int64), np.zeros(len(fleet), dtype=np.int64)
    cost, durations, distance, overtime, overruns, waiting = [], [], [], [], [], 0.0
    rewards = sites.reward[sites.depots].tolist()  # collected by staying at home
    returns = min(opening(problem, v) for v in fleet)

    for name, route in _driven(problem, answer):
        if not 0 <= route.vehicle < len(fleet) or any(not 0 <= i < len(sites) for i in route.visits):
            judge.test("visits", 1.0, f"{name} has a vehicle type or a site that does not exist", vehicle=name)
            continue
        vehicle, plan = fleet[route.vehicle], check_route(problem, name, route, judge)
        if route.visits:  # else a committed vehicle on its way home, which counts for nothing but its cost
            used[route.vehicle] += 1
            np.add.at(count, np.array(route.visits, dtype=np.int64), 1)
        cost.append(plan.cost(vehicle))
        distance.append(plan.total_distance)
        durations.append(plan.duration)
        overtime.append(max(0.0, plan.duration - vehicle.regular_duration))
        if vehicle.risk is not None or problem.team_risk is not None:
            overruns.append(route_overrun(vehicle, plan))
        returns = max(returns, plan.finish)
        waiting += plan.waiting
        rewards.extend(sites.reward[[i for i in route.visits if not sites.depot[i]]].tolist())

    total = int(used.sum())
    _check_counts(problem, count, used, judge)
    _check_shipments(problem, answer, judge)
    unvisited = _check_groups(problem, count, judge)
    joint = joint_overrun(overruns)
    if problem.team_risk is not None:
        words = f"some route overruns a limit with probability {joint:.6g}, {problem.team_risk:g} at most"
        judge.test("team-risk", joint - problem.team_risk, words, allowed=EQUAL * problem.team_risk)

    terms = {
        "total-cost": math.fsum(cost), "reward": math.fsum(rewards), "vehicles": float(total),
        "longest-route": max(distance, default=0.0), "makespan": max(durations, default=0.0), "total-duration": math.fsum(durations),
        "latest-return": returns, "penalties": math.fsum(sites.penalty[unvisited]),
    }  # fmt: skip
    values = tuple(math.fsum(w * terms[t.name] for w, t in level.terms) for level in problem.objective.levels())
    # Programs add up all penalties, and take away those of the sites that are visited.
    added = {**terms, "penalties": math.fsum(sites.penalty)}
    sizes = tuple(math.fsum(abs(w * added[t.name]) for w, t in level.terms) for level in problem.objective.levels())
    if 0.0 in sizes:
        sizes = tuple(size or least for size, least in zip(sizes, _least_sizes(problem), strict=True))
    quantities = {"distance": math.fsum(distance), "vehicles": float(total), "waiting": waiting, "reward": terms["reward"]}
    if features & {"duration-cost", "overtime", "objective:total-duration"}:
        quantities |= {"duration": terms["total-duration"], "overtime": math.fsum(overtime)}
    if features & {"route-risk", "team-risk"}:
        quantities |= {"largest-route-overrun": max(overruns, default=0.0), "team-overrun": joint, "expected-overruns": math.fsum(overruns)}
    if sites.penalty.any():
        quantities["penalties"] = terms["penalties"]
    names = (*CHECKS, *(check for feature, check in FURTHER_CHECKS.items() if feature in features))
    names += ("timetable",) if any(route.timetable is not None for route in answer) else ()
    return Evaluation(values, judge.checks(names), tuple(judge.violations), quantities, sizes)


def _least_sizes(problem: RoutingProblem) -> tuple[float, ...]:
    """The scale of each level of the objective for an answer that adds up nothing: the least amount that one visit would add."""
    sites, customers = problem.sites, problem.customers
    lengths, times, costs = [], [], []
    for kind, vehicle in enumerate(problem.fleet):
        travel = problem.travel_of(kind)
        lengths.append(_least(travel.distance(vehicle.start, customers)))
        times.append(_least(travel.duration(vehicle.start, customers)))
        costs.append(vehicle.fixed_cost + vehicle.unit_cost * lengths[-1] + vehicle.unit_duration_cost * times[-1])
    length, time, cost = (_least(np.array(amounts)) for amounts in (lengths, times, costs))
    amounts = {
        "total-cost": cost, "reward": _least(sites.reward), "vehicles": 1.0, "longest-route": length, "makespan": time,
        "total-duration": time, "latest-return": time, "penalties": _least(sites.penalty),
    }  # fmt: skip
    return tuple(_least(np.array([abs(w * amounts[t.name]) for w, t in level.terms])) for level in problem.objective.levels())


def _least(amounts: Floats) -> float:
    """The least finite amount above 0, 0 without any."""
    above = amounts[(amounts > 0.0) & np.isfinite(amounts)]
    return float(above.min()) if len(above) else 0.0


def check_route(problem: RoutingProblem, name: str, route: Route, judge: Checklist) -> Schedule:
    """Put on the list what one route breaks by itself; returns its schedule."""
    plan = schedule(problem, route)
    if route.visits:
        _check_stops(problem, name, route, judge)
    _check_moves(problem, name, route, judge)
    _check_times(problem, name, route, plan, judge)
    _check_limits(name, problem.fleet[route.vehicle], plan, judge)
    return plan


def _driven(problem: RoutingProblem, answer: Routes) -> Iterator[tuple[str, Route]]:
    """All routes that are driven, with the names of their vehicles: those with stops, and those of committed vehicles without.

    Any other vehicle that stays at home drives no route, costs nothing and does not count.
    """
    used = [0] * len(problem.fleet)
    for name, route in zip(problem.vehicle_names(answer), answer, strict=True):
        if route.visits:
            yield name, route
            if 0 <= route.vehicle < len(used):
                used[route.vehicle] += 1
    for kind, vehicle in enumerate(problem.fleet):
        for number in range(used[kind], vehicle.count or 0) if vehicle.committed else ():
            yield f"{vehicle.name} {number + 1}", Route((), kind)


def _check_stops(problem: RoutingProblem, name: str, route: Route, judge: Checklist) -> None:
    """Stops that this vehicle may not make at all."""
    sites, vehicle = problem.sites, problem.fleet[route.vehicle]
    pauses = {*vehicle.reloads, *vehicle.stations}
    for site in route.visits:
        if sites.depot[site] and site not in pauses:
            judge.test("visits", 1.0, f"{name} visits the depot {sites.ids[site]} on its way", vehicle=name, site=sites.ids[site])
        if sites.skills:
            lacking = sorted(sites.skills[site] - vehicle.skills)
            words = f"{name} lacks {', '.join(lacking)}, which {sites.ids[site]} asks for"
            judge.test("skills", float(len(lacking)), words, vehicle=name, site=sites.ids[site])
    if pauses and all(sites.depot[site] for site in route.visits):
        judge.test("visits", 1.0, f"{name} serves no site", vehicle=name)
    if vehicle.reloads:
        often = sum(site in vehicle.reloads for site in route.visits)
        most = math.inf if vehicle.max_reloads is None else vehicle.max_reloads
        judge.test("reloads", often - most, f"{name} reloads {often} times, {most:g} at most", vehicle=name)


def _check_moves(problem: RoutingProblem, name: str, route: Route, judge: Checklist) -> None:
    if problem.forbidden is None:
        return
    sites, vehicle = problem.sites, problem.fleet[route.vehicle]
    for tail, head in itertools.pairwise([vehicle.start, *route.visits, vehicle.end]):
        words = f"{name} goes from {sites.ids[tail]} to {sites.ids[head]}, which is forbidden"
        judge.test("moves", float(problem.forbidden[tail, head]), words, vehicle=name, site=sites.ids[head])


def _check_times(problem: RoutingProblem, name: str, route: Route, plan: Schedule, judge: Checklist) -> None:
    sites, vehicle = problem.sites, problem.fleet[route.vehicle]
    opens = abs(opening(problem, vehicle))
    places = [*route.visits, vehicle.end]
    # Who is late begins on arrival; only a stated timetable has a vehicle wait beyond the end of a window.
    reached, due = np.append(plan.begin, plan.finish), sites.due[places]
    due[-1] = closing(problem, vehicle)
    allowed = allowance(due, reached, opens)
    for site, at, end, slack in zip(places, reached.tolist(), due.tolist(), allowed.tolist(), strict=True):
        when, last = moment_told(problem.clock, at, 10), moment_told(problem.clock, end, 10)
        late = f"{name} reaches {sites.ids[site]} at {when}, due {last}"
        judge.test("time-windows", at - end, late, allowed=slack, vehicle=name, site=sites.ids[site])
    if route.timetable is not None:
        _check_timetable(problem, name, route, plan, judge)
    if not np.isfinite(plan.closing).any():
        return
    allowed = allowance(plan.closing, plan.leaves, opens)
    tails = [vehicle.start, *route.visits]
    for i, j, at, end, slack in zip(tails, places, plan.leaves.tolist(), plan.closing.tolist(), allowed.tolist(), strict=True):
        when, last = moment_told(problem.clock, at, 10), moment_told(problem.clock, end, 10)
        late = f"{name} leaves {sites.ids[i]} for {sites.ids[j]} at {when}, the move closes at {last}"
        judge.test("closing-moves", at - end, late, allowed=slack, vehicle=name, site=sites.ids[i])


def _check_timetable(problem: RoutingProblem, name: str, route: Route, plan: Schedule, judge: Checklist) -> None:
    """Stated times at which the vehicle may not depart, or that do not come of the ones before."""
    sites, vehicle = problem.sites, problem.fleet[route.vehicle]
    ids, opens = [sites.ids[k] for k in (vehicle.start, *route.visits, vehicle.end)], opening(problem, vehicle)
    latest = max(opens, float(sites.due[vehicle.start]))
    for over, words in ((opens - plan.departure, f"opens at {opens:.10g}"), (plan.departure - latest, f"closes at {latest:.10g}")):
        slack = float(widening(opens, abs(plan.departure)))
        words = f"{name} leaves {ids[0]} at {plan.departure:.10g}, which {words}"
        judge.test("timetable", over, words, allowed=slack, vehicle=name, site=ids[0])
    for one in plan.astray:
        words = f"{name} {one.what} {ids[one.stop]} at {one.found:.10g}, its timetable says {one.stated:.10g}"
        judge.test("timetable", abs(one.stated - one.found), words, vehicle=name, site=ids[one.stop])


def _check_limits(name: str, vehicle: VehicleType, plan: Schedule, judge: Checklist) -> None:
    """Load, duration, distance and energy of one route."""
    carries = "carries {:.10g}, capacity {:.10g}"
    limits = [("load", plan.peak[0], vehicle.capacity, carries)]
    for k, capacity in enumerate(vehicle.further_capacity, start=1):
        limits.append(("load", plan.peak[k], capacity, f"{carries} of load {k + 1}"))
    limits += [
        ("duration", plan.duration, vehicle.max_duration, "has duration {:.10g}, limit {:.10g}"),
        ("distance", plan.total_distance, vehicle.max_distance, "has distance {:.10g}, limit {:.10g}"),
    ]
    energy = vehicle.energy
    if energy is not None:
        if energy.stations:
            stores = [energy.at_departure, *(energy.capacity for _ in plan.stretches[1:])]
            drawn = list(plan.stretches)
        else:
            stores, drawn = [energy.at_departure], [plan.charged[energy.charge]]
        for part, store in zip(drawn, stores, strict=True):
            limits.append(("energy", energy.rate * part, store, f"draws {{:.10g}} ({energy.charge}), capacity {{:.10g}}"))
    reached = np.append(plan.arrival, plan.finish)
    rounding = ROUNDING * (len(reached) + 2) * float(np.abs(reached).max())
    for check, value, limit, words in limits:
        slack = float(allowance(limit, value))
        if slack > 0 and check in ("duration", "energy"):  # differences of times
            slack += rounding * (energy.rate if energy is not None and check == "energy" else 1.0)
        judge.test(check, value - limit, f"{name} {words.format(value, limit)}", allowed=slack, vehicle=name)
    if vehicle.risk is not None:
        for one in uncertain(vehicle, plan):
            value, of = one.needed(vehicle.risk), 1.0 if one.name == "duration" or energy is None else energy.rate
            slack = float(widening(one.limit, value)) + rounding * of
            words = f"{name} exceeds its limit of {one.name} of {one.limit:.10g} with probability {one.overrun():.6g}"
            judge.test("route-risk", value - one.limit, f"{words}, {vehicle.risk:g} at most", allowed=slack, vehicle=name)


def _check_counts(problem: RoutingProblem, count: Integers, used: Integers, judge: Checklist) -> None:
    """Visits of each site, and routes of each type of vehicle."""
    sites, total = problem.sites, int(used.sum())
    for site in problem.customers.tolist():
        times = int(count[site])
        lacking = 1 - times if sites.required[site] and times == 0 else times - 1
        judge.test("visits", float(lacking), f"{sites.ids[site]} is visited {times} times", site=sites.ids[site])
    for kind, vehicle in enumerate(problem.fleet):
        limit = math.inf if vehicle.count is None else vehicle.count
        judge.test("fleet", float(used[kind] - limit), f"{used[kind]} routes use {vehicle.name}, of which there are {limit:g}")
    judge.test("fleet", float(problem.min_vehicles - total), f"{total} routes, at least {problem.min_vehicles} are asked for")


def _check_shipments(problem: RoutingProblem, answer: Routes, judge: Checklist) -> None:
    if not problem.sites.shipments:
        return
    place = {site: (k, at) for k, route in enumerate(answer) for at, site in enumerate(route.visits)}
    for shipment in problem.sites.shipments:
        first, last = (problem.sites.ids[k] for k in (shipment.pickup, shipment.delivery))
        begun, ended = place.get(shipment.pickup), place.get(shipment.delivery)
        wrong = ""
        if begun is None or ended is None:
            wrong = "" if begun == ended else f"{first if ended is None else last} is visited without {last if ended is None else first}"
        elif begun[0] != ended[0]:
            wrong = f"{first} and {last} are on two routes"
        elif begun[1] > ended[1]:
            wrong = f"{last} is visited before {first}"
        judge.test("shipments", float(bool(wrong)), f"the shipment from {first} to {last}: {wrong}", site=first)


def _check_groups(problem: RoutingProblem, count: Integers, judge: Checklist) -> Integers:
    """Checks groups; returns the sites whose penalty is due."""
    sites = problem.sites
    for group in sites.groups:
        times = int((count[list(group.sites)] > 0).sum())
        names = ", ".join(sites.ids[k] for k in group.sites)
        lacking = float(times - 1 if times or not group.required else 1)
        judge.test("groups", lacking, f"{times} of these alternatives are visited: {names}", site=sites.ids[group.sites[0]])
    unvisited: Integers = problem.customers[count[problem.customers] == 0]
    return unvisited
