"""What a format cannot express, found before anything is written."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ...errors import UsageError
from ..features import features
from ..instance import RoutingInstance

ORIENTEERING = ("orienteering", "team-orienteering")


def refuse_inexpressible(instance: object, format_name: str, expressible: Collection[str]) -> frozenset[str]:
    """All features of the instance; raises UsageError naming those that ``format_name`` has no place for."""
    if not isinstance(instance, RoutingInstance):
        raise UsageError(f"{getattr(instance, 'name', 'this')} holds no routing data, so it cannot be written as {format_name}; use json")
    held = features(instance)
    missing = sorted((held | ({"objective"} if instance.objective else set())) - set(expressible))
    if missing:
        raise UsageError(f"{instance.name} cannot be written as {format_name}, which has no place for {', '.join(missing)}; use json")
    return held


def numbered(instance: RoutingInstance, first: int) -> bool:
    """Whether the ids of the sites are ``first``, ``first + 1``, ... in order."""
    return instance.sites.ids == tuple(str(k) for k in range(first, first + len(instance.sites)))


def cannot(instance: RoutingInstance, format_name: str, why: str) -> UsageError:
    """That ``instance`` cannot be written, and why."""
    return UsageError(f"{instance.name} cannot be written as {format_name}: {why}; use json")


def refuse_no_paths(instance: RoutingInstance, format_name: str, limit: float) -> None:
    """Raise UsageError unless optional points in the plane are visited by a number of paths that ``limit`` bounds."""
    travel = instance.travel
    if travel.metric != "euclidean" or travel.convention != "exact":
        raise cannot(instance, format_name, f"its distances are {travel.metric} {travel.convention}, not Euclidean and exact")
    if not np.isfinite(limit) or instance.fleet[0].count is None:
        raise cannot(instance, format_name, "the format needs a number of paths and their limit")
    if instance.sites.required.any():
        raise cannot(instance, format_name, "it has sites that must be visited")
    if instance.problem not in ORIENTEERING:
        raise cannot(instance, format_name, f"it is no orienteering problem but {instance.problem}")
