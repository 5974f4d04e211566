"""What a format cannot express, found before anything is written."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ...errors import UsageError
from ..instance import RoutingInstance


def contents(instance: RoutingInstance) -> frozenset[str]:
    """Names of everything in ``instance`` beyond sites with distances, one depot and any number of equal vehicles."""
    sites, fleet = instance.sites, instance.fleet
    at = sites.customers
    marks = {
        "capacity": any(np.isfinite(v.capacity) for v in fleet) or bool(sites.demand[at].any()),
        "time-windows": bool(sites.ready.any() or np.isfinite(sites.due).any()),
        "service-times": bool(sites.service[at].any()),
        "demand-or-service-of-depots": bool(sites.demand[sites.depots].any() or sites.service[sites.depots].any()),
        "rewards": bool(sites.reward.any()),
        "optional-sites": not bool(sites.required[at].all()),
        "fleet-limit": any(v.count is not None for v in fleet),
        "several-vehicle-types": len(fleet) > 1,
        "several-depots": len(sites.depots) > 1,
        "open-routes": any(v.start != v.end for v in fleet),
        "max-duration": any(np.isfinite(v.max_duration) for v in fleet),
        "max-distance": any(np.isfinite(v.max_distance) for v in fleet),
        "energy": any(v.energy is not None for v in fleet),
        "fixed-cost": any(v.fixed_cost != 0 for v in fleet),
        "unit-cost": any(v.unit_cost != 1 for v in fleet),
        "min-vehicles": instance.min_vehicles > 0,
        "objective": bool(instance.objective),
        "durations": instance.travel.duration_matrix is not None,
    }
    return frozenset(name for name, present in marks.items() if present)


def refuse_inexpressible(instance: object, format_name: str, expressible: Collection[str]) -> None:
    """Raise UsageError naming what ``format_name`` has no place for."""
    if not isinstance(instance, RoutingInstance):
        raise UsageError(f"{getattr(instance, 'name', 'this')} holds no routing data, so it cannot be written as {format_name}; use json")
    missing = sorted(contents(instance) - set(expressible))
    if missing:
        raise UsageError(f"{instance.name} cannot be written as {format_name}, which has no place for {', '.join(missing)}; use json")
