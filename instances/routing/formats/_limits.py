"""What a format cannot express, found before anything is written."""

from __future__ import annotations

from collections.abc import Collection

from ...errors import UsageError
from ..features import features
from ..instance import RoutingInstance


def refuse_inexpressible(instance: object, format_name: str, expressible: Collection[str]) -> frozenset[str]:
    """All features of the instance; raises UsageError naming those that ``format_name`` has no place for."""
    if not isinstance(instance, RoutingInstance):
        raise UsageError(f"{getattr(instance, 'name', 'this')} holds no routing data, so it cannot be written as {format_name}; use json")
    held = features(instance)
    missing = sorted((held | ({"objective"} if instance.objective else set())) - set(expressible))
    if missing:
        raise UsageError(f"{instance.name} cannot be written as {format_name}, which has no place for {', '.join(missing)}; use json")
    return held
