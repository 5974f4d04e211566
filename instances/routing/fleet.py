"""Fleets of equal vehicles, and the problems that the data of an instance allow."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from .features import ENERGY, Data, features
from .instance import RoutingInstance, Sites, VehicleType


def equal_fleet(sites: Sites, *, count: int | None = None, **limits: Any) -> tuple[VehicleType, ...]:
    """One type of vehicle for each depot, all alike: ``count`` vehicles at each, with ``limits`` as in ``VehicleType``."""
    depots = sites.depots.tolist()
    names = ["vehicle"] if len(depots) == 1 else [f"vehicle at {sites.ids[d]}" for d in depots]
    return tuple(VehicleType(count, start=d, end=d, name=name, **limits) for d, name in zip(depots, names, strict=True))


def problems_of(data: Data) -> tuple[str, ...]:
    """Problems that may be asked of sites and a fleet, the one that is meant first.

    ``vrptw`` where there are time windows; without them ``cvrp`` where vehicles are limited in load, or ``tsp`` for
    one vehicle that is not limited at all. ``min-cost-vrp`` always.
    """
    held = features(data)
    if "multiple-depots" not in held:
        if held & {"time-windows", "depot-windows"}:
            return "vrptw", "min-cost-vrp"
        if "capacity" in held:
            return "cvrp", "min-cost-vrp"
        limits = {"max-duration", "max-distance", "heterogeneous-fleet", "optional-sites", *ENERGY}
        if not held & limits and data.fleet[0].count == 1:
            return "tsp", "min-cost-vrp"
    return ("min-cost-vrp",)


def with_problems(instance: RoutingInstance) -> RoutingInstance:
    """The instance with the problems that its data allow, as the one that is meant first."""
    problems = problems_of(instance)
    return replace(instance, problem=problems[0], problems=problems)
