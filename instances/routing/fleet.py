"""Fleets of equal vehicles, and the problems that the data of an instance allow."""

from dataclasses import replace
from typing import Any

from .features import ENERGY, Data, features
from .instance import RoutingInstance, Sites, VehicleType

BEYOND_TOURS = frozenset({"shipments", "pickups", "reloads", "recharging", "closing-moves", "shifts", "committed-vehicles"})
"""Features that make one vehicle's route more than a tour."""


def equal_fleet(sites: Sites, *, count: int | None = None, **limits: Any) -> tuple[VehicleType, ...]:
    """One type of vehicle for each depot, all alike: ``count`` vehicles at each, with ``limits`` as in ``VehicleType``."""
    depots = sites.depots.tolist()
    names = ["vehicle"] if len(depots) == 1 else [f"vehicle at {sites.ids[d]}" for d in depots]
    return tuple(VehicleType(count, start=d, end=d, name=name, **limits) for d, name in zip(depots, names, strict=True))


def problems_of(data: Data) -> tuple[str, ...]:
    """Problems that may be asked of sites and a fleet, the one that is meant first.

    ``vrptw`` where there are time windows; without them ``cvrp`` where vehicles are limited in load, or ``tsp`` for
    one vehicle that is not limited at all. ``min-cost-vrp`` always. Stations make it a ``recharging-vrp`` in the first place; shipments may
    be asked for fewest vehicles (``pdptw``), a limited fleet for a short makespan, optional sites with rewards for the best choice of them.
    """
    present = features(data)
    return (*(["recharging-vrp"] if "recharging" in present else []), *_plain(data, present), *_other(data, present))


def _plain(data: Data, held: frozenset[str]) -> tuple[str, ...]:
    if "multiple-depots" not in held:
        if held & {"time-windows", "depot-windows"}:
            return "vrptw", "min-cost-vrp"
        if "capacity" in held and "shipments" not in held:
            return "cvrp", "min-cost-vrp"
        limits = {"max-duration", "max-distance", "heterogeneous-fleet", "optional-sites", *ENERGY, *BEYOND_TOURS}
        if not held & limits and data.fleet[0].count == 1:
            return "tsp", "min-cost-vrp"
    return ("min-cost-vrp",)


def _other(data: Data, held: frozenset[str]) -> tuple[str, ...]:
    problems = ["pdptw"] if "shipments" in held else []
    problems += ["mdvrp"] if "multiple-depots" in held and "recharging" not in held else []
    if "limited-fleet" in held:
        problems.append("min-makespan-vrp")
        if {"rewards", "optional-sites"} <= held:
            alone = len(data.fleet) == 1 and data.fleet[0].count == 1
            problems += [*(["orienteering"] if alone else []), "team-orienteering", "makespan-orienteering"]
    return tuple(problems)


def with_problems(instance: RoutingInstance) -> RoutingInstance:
    """The instance with the problems that its data allow, as the one that is meant first."""
    problems = problems_of(instance)
    return replace(instance, problem=problems[0], problems=problems)
