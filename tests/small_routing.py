"""Small routing problems in which one feature matters."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from waybound.formulations.routing.objective import Composable, Reward, TotalCost, Vehicles
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

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


def plane(seed: int, customers: int, capacity: float, count: int | None = None) -> RoutingProblem:
    """Customers in a square, whole demands of 1 to 9."""
    rng = np.random.default_rng(seed)
    sites = Sites.of(range(customers + 1), demand=[0, *rng.integers(1, 10, customers)])
    travel = Travel("EUC_2D", rng.integers(0, 100, (customers + 1, 2)).astype(float))
    return RoutingProblem(sites, travel, (VehicleType(count, capacity),))
