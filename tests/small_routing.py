"""Small routing problems in which one feature matters."""

import functools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from truth.routing import best_values

from waybound import LatestReturn, LongestRoute
from waybound.formulations.routing.objective import Composable, Makespan, Penalties, Reward, TotalCost, TotalDuration, Vehicles
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import NEVER
from waybound.heuristics.heuristic import Context
from waybound.instances.routing.instance import ENERGY_CHARGES, Energy, Group, Shipment, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.linear_programs import LinearPrograms

CUSTOMERS = 5


def small(feature: str, seed: int, convention: str) -> RoutingProblem:
    """A problem of five customers in which ``feature`` matters."""
    rng = np.random.default_rng([seed, *feature.encode()])
    depots = 2 if feature in ("multiple-depots", "open-routes") else 1
    n = CUSTOMERS + depots
    xy = rng.integers(0, 60, (n, 2)).astype(float)
    travel = Travel("euclidean", xy, convention=convention)
    depot = np.arange(n) < depots
    demand = np.where(depot, 0.0, rng.integers(1, 9, n))
    ready, due, service = np.zeros(n), np.full(n, math.inf), np.zeros(n)
    reward, required = np.zeros(n), ~depot
    vehicle = VehicleType(capacity=15.0)
    fleet: tuple[VehicleType, ...] = (vehicle,)
    objective: Composable = TotalCost()
    around = float(travel.distances.max()) * 2.2
    if feature in ("time-windows", "depot-windows", "service-times", "max-duration", "elapsed", "elapsed-fixed-start", "windows"):
        opening = rng.integers(0, 60, n).astype(float)
        ready = np.where(depot, 0.0, opening)
        due = np.where(depot, math.inf, opening + rng.integers(40, 90, n))
    if feature in ("service-times", "max-duration", "elapsed", "elapsed-fixed-start", "windows"):
        service = np.where(depot, 0.0, rng.integers(1, 12, n))
    if feature == "depot-windows":
        ready, due = np.where(depot, 20.0, ready), np.where(depot, 190.0, due)
    if feature == "max-duration":
        fleet = (replace(vehicle, max_duration=around + 25.0),)
    if feature == "max-distance":
        fleet = (replace(vehicle, max_distance=around * 0.9, capacity=math.inf),)
    if feature in ("travel", "elapsed", "elapsed-fixed-start", "windows"):
        # Tight enough to bind, wide enough for a route to the farthest site and back.
        slack = 1.0 if feature == "travel" else 1.5
        fleet = (replace(vehicle, energy=Energy(around * slack * 2.0, 2.0, feature)),)
    if feature == "limited-fleet":
        fleet = (replace(vehicle, count=2, capacity=float(np.ceil(demand.sum() * 0.6))),)
    if feature == "heterogeneous-fleet":
        fleet = (
            VehicleType(2, 10.0, fixed_cost=5.0, unit_cost=1.0, name="small"),
            VehicleType(1, 30.0, fixed_cost=25.0, unit_cost=1.5, name="large"),
            VehicleType(None, 9.0, fixed_cost=60.0, unit_cost=0.5, name="hired"),
        )
    if feature == "fixed-cost":
        fleet = (replace(vehicle, fixed_cost=33.0, unit_cost=2.0),)
    if feature == "multiple-depots":
        fleet = (VehicleType(2, 15.0, 0, 0, name="north"), VehicleType(2, 15.0, 1, 1, name="south"))
    if feature == "open-routes":
        fleet = (VehicleType(None, 15.0, 0, 1),)
    if feature == "separate-durations":
        hours = travel.distances * rng.uniform(0.5, 2.0, (n, n)).round(2)
        travel = Travel(EXPLICIT, xy, travel.distances, np.round(hours, 2), convention="exact")
        fleet = (replace(vehicle, max_duration=float(np.round(hours, 2).max()) * 2.2),)
    if feature == "vehicles":
        objective = Vehicles().then(TotalCost())
    if feature in ("prizes", "reward", "reward-then-cost"):
        reward = np.where(depot, 0.0, rng.integers(5, 60, n))
        required = required & (rng.random(n) < 0.3)
    if feature == "prizes":
        objective = TotalCost() - 1.5 * Reward()
    if feature == "reward":
        objective, fleet = Reward(), (replace(vehicle, count=1, max_distance=around * 0.8),)
        required[:] = False
    if feature == "reward-then-cost":
        objective, fleet = Reward().then(TotalCost()), (replace(vehicle, count=1, max_distance=around * 0.8),)
        required[:] = False
    sites = Sites.of(
        range(n), depot=depot, demand=demand, ready=ready, due=due, service=service, reward=reward, required=required, coordinates=xy
    )
    return RoutingProblem(sites, travel, fleet, objective, name=f"{feature}-{seed}")


FEATURES = (
    "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "travel", "elapsed",
    "elapsed-fixed-start", "windows", "limited-fleet", "heterogeneous-fleet", "fixed-cost", "multiple-depots", "open-routes",
    "separate-durations", "vehicles", "prizes", "reward", "reward-then-cost",
)  # fmt: skip


def few(feature: str, most: int = 3) -> int:
    """Customers for enumeration: fewer where each may stop anywhere between two."""
    return min(most, {"recharging": 2, "initial-energy": 2, "reloads": 3}.get(feature, most))


def varied(feature: str, seed: int, customers: int = 4) -> RoutingProblem:
    """A problem of a few customers, whole numbers, in which a feature of the whole family matters, among others drawn at random."""
    rng = np.random.default_rng([seed, *feature.encode()])
    depots = 2 if feature in ("reloads", "recharging", "several-depots", "initial-energy") or rng.random() < 0.2 else 1
    n = customers + depots
    depot = np.arange(n) < depots
    xy = rng.integers(0, 20, (n, 2)).astype(float)
    matrix = np.abs(xy[:, None] - xy[None, :]).sum(axis=2)
    if rng.random() < 0.3:  # no metric
        matrix = matrix + rng.integers(0, 9, (n, n))
    around = float(matrix.max()) * 2.0
    risky = feature in ("route-risk", "team-risk")
    timed = feature in ("several-windows", "shifts", "closing-moves") or (rng.random() < 0.3 and not risky)
    held: dict[str, object] = {
        "demand": np.where(depot, 0, rng.integers(0, 6, n)), "service": rng.integers(0, 4, n), "reward": rng.integers(0, 9, n),
        "ready": np.where(depot, 0, rng.integers(0, 25, n)) if timed else 0.0, "depot": depot, "coordinates": xy,
    }  # fmt: skip
    held["due"] = np.where(depot, math.inf, np.asarray(held["ready"]) + rng.integers(15, 60, n)) if timed else math.inf
    limits: dict[str, object] = {"count": int(rng.integers(1, 3)), "capacity": float(rng.integers(8, 15)), "unit_cost": 1.0}
    closing, required = None, ~depot & (rng.random(n) < 0.7)
    where = (depots, depots + 1, depots + 2)
    if feature == "several-loads":
        held["demand"] = np.column_stack([np.asarray(held["demand"]), np.where(depot, 0, rng.integers(0, 4, n))])
        limits["further_capacity"] = (float(rng.integers(4, 7)),)
    if feature in ("pickups", "reloads") or rng.random() < 0.1:
        held["pickup"] = np.where(depot, 0, rng.integers(0, 6, n))
    if feature in ("shipments", "reloads") and (feature == "shipments" or rng.random() < 0.5):
        load = (float(rng.integers(1, 7)), 2.0) if np.ndim(held["demand"]) > 1 else (float(rng.integers(1, 7)),)
        held["shipments"] = [Shipment(where[0], where[1], load), *([Shipment(where[0], where[2], load)] if rng.random() < 0.3 else [])]
        required[list(where)] = bool(rng.random() < 0.5)
        served = np.asarray(held["ready"]) + np.asarray(held["service"])
        if timed and required[where[0]]:  # nothing is to be delivered before it can be picked up
            ends = [x.delivery for x in held["shipments"]]
            held["due"][ends] = np.maximum(held["due"][ends], served[where[0]])
    if feature == "groups":
        held["groups"] = [Group((where[0], where[1]), bool(rng.random() < 0.5))]
        required[[where[0], where[1]]] = False
    if feature == "several-windows":
        opens = rng.integers(0, 15, n)
        held["windows"] = {
            k: [(opens[k], opens[k] + 4), (opens[k] + 12, opens[k] + 18), (opens[k] + 30, opens[k] + 45)][: int(rng.integers(2, 4))]
            for k in range(depots, n) if rng.random() < 0.8
        }  # fmt: skip
        limits["max_duration"] = around * 1.5
    if feature == "skills":
        held["skills"] = {where[0]: ["cold"], where[1]: ["cold", "tall"]}
    if feature == "penalties":
        held["penalty"] = np.where(depot, 0, rng.integers(0, 30, n))
        required[:] = False
    if feature == "duration-cost":
        limits |= {"unit_duration_cost": 0.5, "unit_cost": 0.0}
    if feature == "overtime":
        limits |= {"regular_duration": around * 0.4, "unit_overtime_cost": 3.0, "max_duration": around * 1.2}
    if feature == "shifts":
        limits["shift"] = (float(rng.integers(3, 12)), float(rng.integers(50, 90)))
    if feature == "closing-moves":
        closing = np.where(rng.random((n, n)) < 0.6, rng.integers(5, 40, (n, n)).astype(float), math.inf)
    if feature in ("recharging", "initial-energy"):
        room = float(rng.integers(12, 40))
        limits["energy"] = Energy(room, 1.0, "travel", (0, 1), room // 2 if feature == "initial-energy" else None)
    elif rng.random() < 0.15:
        charges = ENERGY_CHARGES if feature != "several-windows" and not risky else ENERGY_CHARGES[:3]
        limits["energy"] = Energy(around * 1.5, 1.0, str(rng.choice(charges)))
    if feature == "reloads":
        limits |= {
            "reloads": (0, 1) if rng.random() < 0.5 else (1,),
            "max_reloads": int(rng.integers(1, 3)) if rng.random() < 0.5 else None,
        }
    variances, team_risk = None, None
    if risky:
        variances = rng.integers(0, 40, (n, n)).astype(float)
        limits["max_duration"] = around * float(rng.uniform(1.1, 1.7))
    if feature == "route-risk":
        limits["risk"] = float(rng.choice([0.02, 0.1, 0.3]))
    if feature == "team-risk":
        team_risk = float(rng.choice([0.02, 0.1, 0.3]))
    first = VehicleType(**limits, name="first")  # type: ignore[arg-type]
    fleet = [first]
    if feature in ("vehicle-speeds", "vehicle-travel", "skills", "committed-vehicles", "several-depots") or rng.random() < 0.3:
        second = replace(first, count=1, name="second", end=depots - 1, fixed_cost=3.0)
        if feature == "vehicle-speeds":
            second = replace(second, speed=2.0, max_duration=around * 0.7)
        if feature == "vehicle-travel":
            second = replace(second, travel=Travel(EXPLICIT, matrix=rng.integers(1, 25, (n, n)).astype(float), closing=closing))
        if feature == "skills":
            second = replace(second, skills=frozenset({"cold"})), replace(second, skills=frozenset({"cold", "tall"}), name="third")
        if feature == "committed-vehicles":
            second = replace(second, committed=True)
        fleet += list(second) if isinstance(second, tuple) else [second]
    goals: list[Composable] = [
        TotalCost(), Makespan(), TotalDuration(), LatestReturn(), LongestRoute(), Reward(), Reward().then(Makespan()),
        TotalCost() - Reward(), Vehicles().then(TotalCost()), TotalCost() + Penalties(), Penalties().then(TotalDuration()),
        Reward() - 0.25 * Makespan(),
    ]  # fmt: skip
    usual = {"penalties": 9, "duration-cost": 0, "overtime": 0}
    objective = goals[usual[feature]] if feature in usual else goals[int(rng.integers(len(goals)))]
    sites = Sites.of(range(n), required=required, **held)  # type: ignore[arg-type]
    travel = Travel(EXPLICIT, matrix=matrix, closing=closing, variances=variances)
    return RoutingProblem(sites, travel, fleet, objective, name=f"{feature}-{seed}", team_risk=team_risk)


WHOLE_FAMILY = (
    "several-depots", "duration-cost", "overtime", "shifts", "vehicle-speeds", "vehicle-travel", "several-loads", "pickups", "shipments",
    "groups", "several-windows", "skills", "penalties", "reloads", "recharging", "initial-energy", "closing-moves", "committed-vehicles",
    "route-risk", "team-risk",
)  # fmt: skip
"""What ``varied`` knows."""


def _in_order(problem: RoutingProblem) -> RoutingProblem:
    """Penalties before costs, where they are weighed against them."""
    terms = {type(term) for level in problem.objective.levels() for _, term in level.terms}
    return replace(problem, objective=Penalties().then(TotalCost())) if terms == {Penalties, TotalCost} else problem


def _alone(problem: RoutingProblem) -> RoutingProblem:
    """One shipment, whose ends have no loads of their own."""
    s = problem.sites
    ends = [site for x in s.shipments[:1] for site in (x.pickup, x.delivery)]
    rest = np.ones(len(s), dtype=bool)
    rest[ends] = False
    loads = {name: (getattr(s, name).T * rest).T for name in ("demand", "pickup", "further_demand", "further_pickup")}
    return replace(problem, sites=replace(s, shipments=s.shipments[:1], **loads))


def _unlimited(problem: RoutingProblem) -> RoutingProblem:
    return replace(problem, fleet=tuple(replace(v, energy=None, max_duration=math.inf) for v in problem.fleet))


def _unpaused(problem: RoutingProblem) -> RoutingProblem:
    """Stores with no station to fill them up, but more in them."""
    fuller = lambda e: e and replace(e, stations=(), capacity=5 * e.capacity, initial=4 * e.at_departure)  # noqa: E731
    return replace(problem, fleet=tuple(replace(v, energy=fuller(v.energy)) for v in problem.fleet))


def _required(problem: RoutingProblem) -> RoutingProblem:
    must = ~problem.sites.depot
    must[[site for group in problem.sites.groups for site in group.sites]] = False
    return replace(problem, sites=replace(problem.sites, required=must))


def simplified(problem: RoutingProblem, feature: str, missing: Callable[[RoutingProblem], frozenset[str]]) -> RoutingProblem | None:
    """The problem without what a solver lacks, as long as it has ``feature``; None where that cannot be."""
    steps: tuple[Callable[[RoutingProblem], RoutingProblem], ...] = (
        _in_order, _alone, _unpaused, lambda p: replace(p, objective=TotalCost()), _required, _unlimited,
    )  # fmt: skip
    for step in (lambda p: p, *steps):
        if missing(problem):
            problem = step(problem)
    return None if missing(problem) or feature not in problem.features() else problem


def plane(seed: int, customers: int, capacity: float, count: int | None = None) -> RoutingProblem:
    """Customers in a square, whole demands of 1 to 9."""
    rng = np.random.default_rng(seed)
    sites = Sites.of(range(customers + 1), demand=[0, *rng.integers(1, 10, customers)])
    travel = Travel("EUC_2D", rng.integers(0, 100, (customers + 1, 2)).astype(float))
    return RoutingProblem(sites, travel, (VehicleType(count, capacity),))


def drawn(feature: str, seed: int, convention: str = "round") -> RoutingProblem:
    """A problem in which a feature matters, of ``FEATURES`` or of the whole family, small enough for enumeration."""
    return varied(feature, seed, few(feature)) if feature in WHOLE_FAMILY else small(feature, seed, convention)


@functools.lru_cache(maxsize=8)
def enumerated(problem: RoutingProblem) -> tuple[float, ...] | None:
    """``best_values``, of a problem that is asked for again and again."""
    return best_values(problem)


def excludes(problem: RoutingProblem, bound: float, relative: float = 1e-9, absolute: float = 1e-9) -> bool:
    """Whether a bound is beyond the optimum of the first level by more than is allowed; none is where there is no answer."""
    best = enumerated(problem)
    sign = 1.0 if problem.sense == "min" else -1.0
    return best is not None and sign * (bound - float(best[0])) > max(relative * abs(float(best[0])), absolute)


LINE = np.abs(np.subtract.outer(*[np.array([0.0, 4, -5, 6, -7])] * 2))


def at_risk(
    risk: float | None, team_risk: float | None = None, scale: float = 1.0, service: float = 1.0, **limits: object
) -> RoutingProblem:
    """Three vehicles and customers on both sides of the depot, each with a service; times, not distances, in other units."""
    travel = Travel(EXPLICIT, matrix=LINE, duration_matrix=scale * LINE, variances=scale**2 * LINE / 4)
    sites = Sites.of(range(5), service=scale * service * np.array([0.0, 1, 1, 1, 1]))
    fleet = (VehicleType(**{"count": 3, "risk": risk, "max_duration": 18.0 * scale, **limits}),)  # type: ignore[arg-type]
    return RoutingProblem(sites, travel, fleet, team_risk=team_risk)


def context(seconds: float = 10.0) -> Context:
    """For a heuristic that runs by itself."""
    return Context(np.random.default_rng(1), seconds, None, lambda answer: None, NEVER, LinearPrograms())
