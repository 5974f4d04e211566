"""Fleets of equal vehicles, and the problems that the data of an instance allow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .instance import Sites, VehicleType


def equal_fleet(sites: Sites, *, count: int | None = None, **limits: Any) -> tuple[VehicleType, ...]:
    """One type of vehicle for each depot, all alike: ``count`` vehicles at each, with ``limits`` as in ``VehicleType``."""
    depots = sites.depots.tolist()
    names = ["vehicle"] if len(depots) == 1 else [f"vehicle at {sites.ids[d]}" for d in depots]
    return tuple(VehicleType(count, start=d, end=d, name=name, **limits) for d, name in zip(depots, names, strict=True))


def problems_of(sites: Sites, fleet: Sequence[VehicleType]) -> tuple[str, ...]:
    """Problems that may be asked of sites and a fleet, the one that is meant first.

    ``vrptw`` where there are time windows; without them ``cvrp`` where vehicles are limited in load, or ``tsp`` for
    one vehicle that is not limited at all. ``min-cost-vrp`` always.
    """
    windows = bool((sites.ready > 0).any() or np.isfinite(sites.due).any())
    loads = any(math.isfinite(v.capacity) for v in fleet)
    one_depot = len(sites.depots) == 1
    free = not loads and all(math.isinf(v.max_duration) and math.isinf(v.max_distance) and v.energy is None for v in fleet)
    found = []
    if one_depot and windows:
        found.append("vrptw")
    elif one_depot and loads:
        found.append("cvrp")
    elif one_depot and free and len(fleet) == 1 and fleet[0].count == 1 and sites.required[sites.customers].all():
        found.append("tsp")
    return (*found, "min-cost-vrp")
