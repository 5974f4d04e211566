"""Features that a format cannot express, found before anything is written."""

from collections.abc import Collection

import numpy as np

from ...errors import UsageError
from ...number_arrays import Floats
from ..features import features
from ..instance import RoutingInstance

ORIENTEERING = ("orienteering", "team-orienteering")


def refuse_inexpressible(instance: object, format_name: str, expressible: Collection[str]) -> frozenset[str]:
    """All features of the instance; raises UsageError naming those that ``format_name`` has no place for."""
    if not isinstance(instance, RoutingInstance):
        message = f"{getattr(instance, 'name', 'this')} holds no routing data, so it cannot be written as {format_name}; use json"
        raise UsageError(message, "unsupported")
    present = features(instance)
    missing = sorted((present | ({"objective"} if instance.objective else set())) - set(expressible))
    if missing:
        message = f"{instance.name} cannot be written as {format_name}, which has no place for {', '.join(missing)}; use json"
        raise UsageError(message, "unsupported")
    return present


def cannot(instance: RoutingInstance, format_name: str, why: str) -> UsageError:
    """The error for an instance that cannot be written, with the reason."""
    return UsageError(f"{instance.name} cannot be written as {format_name}: {why}; use json", "unsupported")


def refuse_where(instance: RoutingInstance, format_name: str, *faults: tuple[object, str]) -> None:
    """Raise UsageError with the reason of the first fault that is true."""
    for wrong, why in faults:
        if wrong:
            raise cannot(instance, format_name, why)


def points_of(instance: RoutingInstance, format_name: str) -> Floats:
    """Points of the plane, shape (sites, 2), whose exact Euclidean distances are those of the instance; UsageError for any others."""
    travel = instance.travel
    if travel.metric != "euclidean" or travel.convention != "exact":
        raise cannot(instance, format_name, f"its distances are {travel.metric} {travel.convention}, not Euclidean and exact")
    assert travel.coordinates is not None
    return travel.coordinates


def numbered(instance: RoutingInstance, first: int, depots: Collection[int] = (0,)) -> bool:
    """True if the sites are numbered ``first``, ``first + 1``, ... in order, and the depots stand in the places ``depots``."""
    sites = instance.sites
    return sites.ids == tuple(str(k) for k in range(first, first + len(sites))) and sites.depots.tolist() == list(depots)


def finite(values: Floats) -> bool:
    """True if all values are finite."""
    return bool(np.isfinite(values).all())
