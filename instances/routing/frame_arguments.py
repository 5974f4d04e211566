"""Arguments of ``RoutingProblem.from_frame``, and the checks of those that are one number or one text."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import InputError


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameArguments:
    """Arguments of ``RoutingProblem.from_frame`` beside the sites, the objective and the problem; it documents them."""

    travel: Any = None
    durations: Any = None
    vehicles: int | None = None
    capacity: float | Sequence[float] = math.inf
    max_duration: Any = math.inf
    max_distance: float = math.inf
    fixed_cost: float = 0.0
    unit_cost: float = 1.0
    speed: float | None = None
    fleet: Any = None
    columns: Mapping[Any, Any] | str | None = None
    extra: Iterable[Any] | bool = ()
    time_unit: str | None = None
    distance_unit: str = "km"
    weight: str = "weight"
    convention: str = ""
    name: str = "frame"
    closing: Any = None
    min_vehicles: int = 0
    windows: Any = None
    shipments: Any = ()
    groups: Any = ()
    variances: Any = None
    team_risk: float | None = None

    def __post_init__(self) -> None:
        for name in ("name", "distance_unit", "weight", "convention"):
            text_of(getattr(self, name), name)

    @property
    def limits_vehicles(self) -> bool:
        """True if any argument describes vehicles that are all alike, in place of ``fleet``."""
        capacity = self.capacity if isinstance(self.capacity, float | int) else None  # an array cannot be compared
        limits = (capacity, self.max_duration, self.max_distance, self.fixed_cost, self.unit_cost)
        return self.vehicles is not None or limits != (math.inf, math.inf, math.inf, 0.0, 1.0)


def text_of(value: Any, what: str) -> str:
    """A text."""
    if not isinstance(value, str):
        raise InputError(f"{what} must be a text", found=repr(value)[:60])
    return value


def number_of(value: Any, what: str) -> float:
    """A number, whose range is checked where it is used."""
    try:
        if not isinstance(value, str | bytes):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{what} must be a number", found=repr(value)[:60])


def whole_of(value: Any, what: str) -> int:
    """A whole number."""
    number = math.nan if isinstance(value, bool) else number_of(value, what)
    if not number.is_integer():
        raise InputError(f"{what} must be whole", found=repr(value)[:60])
    return int(number)


def loads_of(value: Any, what: str) -> list[float]:
    """One number, or one a load dimension."""
    several = isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)
    loads = [number_of(each, what) for each in (value if several else [value])]
    if not loads:
        raise InputError(f"{what} is empty", "missing", expected="one number a load dimension")
    return loads


def titles_of(value: Any, what: str) -> list[Any] | bool:
    """A list of titles, True for all of them."""
    if isinstance(value, str):
        return [value]
    if not isinstance(value, bool) and (not isinstance(value, Iterable) or isinstance(value, bytes)):
        raise InputError(f"{what} must be a list of titles, or True", found=repr(value)[:60])
    return value if isinstance(value, bool) else list(value)
