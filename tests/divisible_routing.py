"""Problems of 60 customers whose routes are coupled through nothing but the fleet."""

from __future__ import annotations

import numpy as np

import waybound as wb

CUSTOMERS = 60


def made(feature: str = "capacity") -> wb.RoutingProblem:
    """A problem of 60 customers with some feature that restricts its routes."""
    rng = np.random.default_rng(3)
    n, xy = CUSTOMERS + 2, np.random.default_rng(1).uniform(0, 100, (CUSTOMERS + 2, 2))
    xy[:2] = [[30, 30], [70, 70]]
    depot = np.arange(n) < 2
    demand = np.where(depot, 0.0, rng.integers(1, 9, n))
    columns: dict[str, object] = {"depot": depot, "demand": demand, "coordinates": xy}
    fleet = [wb.VehicleType(capacity=40.0)]
    objective: object = None
    if feature == "windows":
        ready = np.where(depot, 0.0, rng.integers(0, 200, n))
        columns |= {"ready": ready, "due": np.where(depot, 500.0, ready + 150.0), "service": np.where(depot, 0.0, 5.0)}
    elif feature == "fleet":
        fleet = [wb.VehicleType(count=6, capacity=30.0, name="van"), wb.VehicleType(count=7, capacity=40.0, fixed_cost=9.0, name="lorry")]
    elif feature == "depots":
        fleet = [wb.VehicleType(count=9, capacity=40.0, start=k, end=k, name=f"of {k}") for k in range(2)]
    elif feature == "open":
        fleet = [wb.VehicleType(capacity=40.0, start=0, end=1, max_distance=250.0)]
    elif feature == "skills":
        columns["skills"] = {k: ["lift"] for k in range(2, n, 3)}
        fleet = [wb.VehicleType(capacity=40.0, name="plain"), wb.VehicleType(capacity=40.0, skills=frozenset({"lift"}), unit_cost=1.5)]
    elif feature == "penalties":
        columns |= {"required": np.zeros(n, dtype=bool), "penalty": np.where(depot, 0.0, rng.integers(1, 60, n))}
        objective = "total-cost + penalties"
    elif feature == "reward":
        columns |= {"required": np.zeros(n, dtype=bool), "reward": np.where(depot, 0.0, rng.integers(1, 9, n))}
        fleet, objective = [wb.VehicleType(count=4, max_distance=120.0)], wb.Reward()
    elif feature == "vehicles":
        objective = "vehicles then total-cost"
    return wb.RoutingProblem(wb.Sites.of(range(n), **columns), wb.Travel("euclidean", xy), fleet, objective)  # type: ignore[arg-type]


FEATURES = ("capacity", "windows", "fleet", "depots", "open", "skills", "penalties", "reward", "vehicles")
