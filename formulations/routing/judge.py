"""Evaluation of routes from the data alone: the independent judge of every routing answer.

It walks each route visit by visit, knows no program and no solver, and shares no code with the forms.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..evaluation import Checklist, Evaluation
from ..tolerance import ROUNDING, allowance
from .routes import Route, Routes

if TYPE_CHECKING:
    from .problem import RoutingProblem

Floats = NDArray[np.float64]

CHECKS = ("visits", "fleet", "load", "time-windows", "duration", "distance", "energy")


@dataclass(frozen=True)
class Schedule:
    """Earliest schedule of one route; arrays have one entry a visit.

    ``duration`` is the shortest possible: from the latest departure that delays nothing, to the return (Savelsbergh 1992).
    ``charged`` holds the energy drawn under each of the four ways of charging.
    """

    arrival: Floats
    begin: Floats
    load: Floats
    distance: Floats
    departure: float
    finish: float
    total_distance: float
    total_load: float
    duration: float
    waiting: float
    charged: dict[str, float]


def schedule(problem: RoutingProblem, route: Route) -> Schedule:
    """Earliest schedule of ``route``; late visits begin on arrival, so that lateness is not forgiven further on."""
    sites, travel, vehicle = problem.sites, problem.travel, problem.fleet[route.vehicle]
    visits = np.array(route.visits, dtype=np.int64)
    stops = np.concatenate([[vehicle.start], visits, [vehicle.end]])
    leg = travel.distance(stops[:-1], stops[1:])
    time = travel.duration(stops[:-1], stops[1:])
    # A depot's window bounds departure and return; it asks for no service.
    service = np.concatenate([[0.0], sites.service[visits], [0.0]])
    ready, due = sites.ready[stops], sites.due[stops]

    arrival, begin = np.empty(len(stops)), np.empty(len(stops))
    arrival[0] = begin[0] = ready[0]
    waiting, slack = 0.0, due[0] - ready[0]
    for k in range(1, len(stops)):
        arrival[k] = begin[k - 1] + service[k - 1] + time[k - 1]
        # The return to a depot is the end of the route: nobody waits for the depot to open.
        begin[k] = max(arrival[k], ready[k]) if k < len(stops) - 1 else arrival[k]
        waiting += begin[k] - arrival[k]
        slack = min(slack, waiting + max(0.0, due[k] - begin[k]))
    finish = float(arrival[-1])
    elapsed = finish - float(begin[0])
    duration = elapsed - min(waiting, slack)
    charge = np.maximum(service[:-1] + time, np.append(ready[1:-1], -math.inf) - ready[:-1])
    load = np.cumsum(sites.demand[visits])
    return Schedule(
        arrival=arrival[1:-1],
        begin=begin[1:-1],
        load=load,
        distance=np.cumsum(leg)[:-1],
        departure=float(begin[0]),
        finish=finish,
        total_distance=float(math.fsum(leg)),
        total_load=float(math.fsum(sites.demand[visits])),
        duration=float(duration),
        waiting=float(waiting),
        charged={
            "travel": float(math.fsum(time)),
            "elapsed": float(duration),
            "elapsed-fixed-start": float(elapsed),
            "windows": float(math.fsum(charge)),
        },
    )


def evaluate_routes(problem: RoutingProblem, answer: Routes) -> Evaluation:
    """Objective and violations of ``answer``; see ``RoutingProblem.evaluate``."""
    sites, fleet = problem.sites, problem.fleet
    judge = Checklist()
    count = np.zeros(len(sites), dtype=np.int64)
    used = np.zeros(len(fleet), dtype=np.int64)
    cost, longest, makespan, distance, waiting = [], 0.0, 0.0, [], 0.0
    rewards = sites.reward[sites.depots].tolist()  # collected by staying at home

    for name, route in zip(problem.vehicle_names(answer), answer, strict=True):
        if not route.visits:
            continue  # a vehicle that stays at home drives no route, costs nothing and does not count
        if not 0 <= route.vehicle < len(fleet) or any(not 0 <= i < len(sites) for i in route.visits):
            judge.test("visits", 1.0, f"{name} has a vehicle type or a site that does not exist", vehicle=name)
            continue
        vehicle = fleet[route.vehicle]
        used[route.vehicle] += 1
        np.add.at(count, np.array(route.visits, dtype=np.int64), 1)
        for site in route.visits:
            if sites.depot[site]:
                judge.test("visits", 1.0, f"{name} visits the depot {sites.ids[site]} on its way", vehicle=name, site=sites.ids[site])
        if problem.forbidden is not None:
            stops = [vehicle.start, *route.visits, vehicle.end]
            for tail, head in itertools.pairwise(stops):
                words = f"{name} goes from {sites.ids[tail]} to {sites.ids[head]}, which is forbidden"
                judge.test("moves", float(problem.forbidden[tail, head]), words, vehicle=name, site=sites.ids[head])
        plan = schedule(problem, route)

        places = [*route.visits, vehicle.end]
        reached, due = np.append(plan.arrival, plan.finish), sites.due[places]
        allowed = allowance(due, reached, abs(float(sites.ready[vehicle.start])))
        for site, at, end, slack in zip(places, reached.tolist(), due.tolist(), allowed.tolist(), strict=True):
            late = f"{name} reaches {sites.ids[site]} at {at:.10g}, due {end:.10g}"
            judge.test("time-windows", at - end, late, allowed=slack, vehicle=name, site=sites.ids[site])
        limits = [
            ("load", plan.total_load, vehicle.capacity, "carries {:.10g}, capacity {:.10g}"),
            ("duration", plan.duration, vehicle.max_duration, "has duration {:.10g}, limit {:.10g}"),
            ("distance", plan.total_distance, vehicle.max_distance, "has distance {:.10g}, limit {:.10g}"),
        ]
        if vehicle.energy is not None:
            charge = vehicle.energy.charge
            drawn = vehicle.energy.rate * plan.charged[charge]
            limits.append(("energy", drawn, vehicle.energy.capacity, f"draws {{:.10g}} ({charge}), capacity {{:.10g}}"))
        rounding = ROUNDING * (len(places) + 2) * float(np.abs(reached).max())
        for check, value, limit, words in limits:
            slack = float(allowance(limit, value))
            if slack > 0 and check in ("duration", "energy"):  # differences of times
                slack += rounding * (vehicle.energy.rate if vehicle.energy is not None and check == "energy" else 1.0)
            judge.test(check, value - limit, f"{name} {words.format(value, limit)}", allowed=slack, vehicle=name)

        cost.append(vehicle.fixed_cost + vehicle.unit_cost * plan.total_distance)
        distance.append(plan.total_distance)
        longest, makespan = max(longest, plan.total_distance), max(makespan, plan.duration)
        waiting += plan.waiting
        rewards.extend(sites.reward[list(route.visits)].tolist())

    for site in problem.customers.tolist():
        times = int(count[site])
        lacking = 1 - times if sites.required[site] and times == 0 else times - 1
        judge.test("visits", float(lacking), f"{sites.ids[site]} is visited {times} times", site=sites.ids[site])
    for kind, vehicle in enumerate(fleet):
        limit = math.inf if vehicle.count is None else vehicle.count
        judge.test("fleet", float(used[kind] - limit), f"{used[kind]} routes use {vehicle.name}, of which there are {limit:g}")
    total = int(used.sum())
    judge.test("fleet", float(problem.min_vehicles - total), f"{total} routes, at least {problem.min_vehicles} are asked for")

    terms = {
        "total-cost": math.fsum(cost), "reward": math.fsum(rewards), "vehicles": float(total),
        "longest-route": longest, "makespan": makespan,
    }  # fmt: skip
    values = tuple(math.fsum(w * terms[t.name] for w, t in level.terms) for level in problem.objective.levels())
    sizes = tuple(math.fsum(abs(w * terms[t.name]) for w, t in level.terms) for level in problem.objective.levels())
    quantities = {"distance": math.fsum(distance), "vehicles": float(total), "waiting": waiting, "reward": terms["reward"]}
    return Evaluation(
        values, judge.checks(CHECKS if problem.forbidden is None else (*CHECKS, "moves")), tuple(judge.violations), quantities, sizes
    )
