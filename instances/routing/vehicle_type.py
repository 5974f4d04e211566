"""Kinds of vehicles: where they start, what they carry, how long they last, what they cost."""

import math
from dataclasses import dataclass, fields

from ..errors import InputError
from .travel import Travel

MOST_VEHICLES = 10**18
"""Largest number of vehicles of one type."""

ENERGY_CHARGES = ("travel", "elapsed", "elapsed-fixed-start", "windows")


@dataclass(frozen=True, repr=False)
class Energy:
    """An energy store that is full at departure and must last for a route, or from one recharging stop to the next.

    Parameters
    ----------
    capacity : float, energy, >= 0
        What a full store holds.
    rate : float, energy per unit of time, > 0
        What is drawn while the charged time passes.
    charge : str
        What a route is charged for, from loosest to strictest: ``travel`` (time on the move; waiting and service are
        free), ``elapsed`` (from departure to return, departing as late as possible), ``elapsed-fixed-start`` (the same,
        departing when the depot opens), ``windows`` (each move i -> j at max(s_i + d_ij, a_j - a_i): row (3.14) of the source,
        conservative).
    stations : tuple of int
        Site indices of depots where the store is filled up on the way, any number of times (``travel`` only); a stop there takes the
        service time of the site.
    initial : float, optional
        Energy at departure, where it is less than the capacity.

    Notes
    -----
    Source: Mitchell (2020), section 3.2 and (3.14), stations (2.7)-(2.12); the four modes compared: docs/formulations/routing.md#energy.
    """

    capacity: float
    rate: float = 1.0
    charge: str = "travel"
    stations: tuple[int, ...] = ()
    initial: float | None = None

    def __post_init__(self) -> None:
        for name in ("capacity", "rate"):
            object.__setattr__(self, name, float(getattr(self, name)))
        object.__setattr__(self, "stations", tuple(int(k) for k in self.stations))
        if not self.capacity >= 0 or not math.isfinite(self.capacity):
            raise InputError("energy capacity must be finite and not negative", "out-of-range", found=str(self.capacity))
        if not self.rate > 0 or not math.isfinite(self.rate):
            raise InputError("energy rate must be positive and finite", "out-of-range", found=str(self.rate))
        if self.charge not in ENERGY_CHARGES:
            raise InputError("unknown energy charge", "unknown-name", expected=", ".join(ENERGY_CHARGES), found=self.charge)
        if self.stations and self.charge != "travel":
            message = "a store that is recharged on the way is charged for travel"
            raise InputError(message, "contradiction", expected="charge travel", found=self.charge)
        if self.initial is not None:
            object.__setattr__(self, "initial", float(self.initial))
            if not 0 <= self.initial <= self.capacity:
                message = "energy at departure must be within the capacity"
                raise InputError(message, "out-of-range", expected=f"0 to {self.capacity:g}", found=str(self.initial))

    @property
    def at_departure(self) -> float:
        """Energy in the store at departure."""
        return self.capacity if self.initial is None else self.initial

    def __repr__(self) -> str:
        return _told(self, ("capacity", "rate", "charge"))


@dataclass(frozen=True, repr=False)
class VehicleType:
    """Vehicles of one kind.

    Parameters
    ----------
    count : int or None
        How many there are; None for any number.
    capacity : float, units of load
        Most that it carries at any moment; infinite by default.
    start, end : int
        Site index of the depot where its routes start, and end.
    max_duration : float, units of time
        Longest time from departure to return, service and waiting included, departing as late as the windows allow.
    max_distance : float, units of distance
        Longest route; infinite by default.
    energy : Energy, optional
        A store that must last; none by default.
    fixed_cost : float
        Cost of using one vehicle.
    unit_cost : float
        Cost of one unit of distance.
    name : str
        For tables, pictures and files.
    further_capacity : tuple of float
        Of the second load dimension, the third, ...; empty for no limit.
    unit_duration_cost : float
        Cost of one unit of time from departure to return.
    regular_duration, unit_overtime_cost : float
        Each unit of a route's duration beyond the regular one costs so much more; ``max_duration`` limits the whole.
    shift : (float, float), units of time
        Earliest departure and latest return, besides those of the depots.
    skills : frozenset of str
        What it can do: it may serve a site if it can do all that ``Sites.skills`` asks for.
    speed : float, > 0
        Durations of moves are divided by it.
    travel : Travel, optional
        Distances and durations of its own.
    reloads : tuple of int
        Site indices of depots where it may unload what it collected and load what it delivers next, between two trips of a route.
    max_reloads : int, optional
        How often on a route.
    committed : bool
        Each vehicle drives: one that serves no site goes straight from start to end, at its cost. So are vehicles that are under way.
    risk : float, optional
        Where durations of moves are uncertain: the largest probability with which a route may take longer than ``max_duration``, or draw
        more than its store holds. Above 0, and at most 1/2.
    """

    count: int | None = None
    capacity: float = math.inf
    start: int = 0
    end: int = 0
    max_duration: float = math.inf
    max_distance: float = math.inf
    energy: Energy | None = None
    fixed_cost: float = 0.0
    unit_cost: float = 1.0
    name: str = "vehicle"
    further_capacity: tuple[float, ...] = ()
    unit_duration_cost: float = 0.0
    regular_duration: float = math.inf
    unit_overtime_cost: float = 0.0
    shift: tuple[float, float] = (-math.inf, math.inf)
    skills: frozenset[str] = frozenset()
    speed: float = 1.0
    travel: Travel | None = None
    reloads: tuple[int, ...] = ()
    max_reloads: int | None = None
    committed: bool = False
    risk: float | None = None

    def __post_init__(self) -> None:
        if self.count is not None and not 1 <= self.count <= MOST_VEHICLES:
            wrong = "least 1" if self.count < 1 else f"most {MOST_VEHICLES}"
            raise InputError(f"the number of vehicles must be at {wrong}", "out-of-range", found=str(self.count))
        limits = ("capacity", "max_duration", "max_distance", "regular_duration")
        costs = ("fixed_cost", "unit_cost", "unit_duration_cost", "unit_overtime_cost")
        for name in (*limits, *costs, "speed"):
            object.__setattr__(self, name, float(getattr(self, name)))  # 5 and 5.0 must hash alike
        object.__setattr__(self, "further_capacity", tuple(float(v) for v in self.further_capacity))
        object.__setattr__(self, "shift", tuple(float(v) for v in self.shift))
        object.__setattr__(self, "skills", frozenset(self.skills))
        object.__setattr__(self, "reloads", tuple(int(k) for k in self.reloads))
        for name in limits:
            value = getattr(self, name)
            if not value >= 0:
                raise InputError(f"{name} of {self.name} must be a number and not negative", "out-of-range", found=str(value))
        for value in self.further_capacity:
            if not value >= 0:
                message = f"capacity of {self.name} must be a number and not negative in each load dimension"
                raise InputError(message, "out-of-range", found=str(value))
        for name in costs:
            value = getattr(self, name)
            if not value >= 0 or not math.isfinite(value):
                raise InputError(f"{name} of {self.name} must be finite and not negative", "out-of-range", found=str(value))
        if not 0 < self.speed < math.inf:
            raise InputError(f"speed of {self.name} must be positive and finite", "out-of-range", found=str(self.speed))
        if len(self.shift) != 2 or not self.shift[0] <= self.shift[1] or self.shift[0] == math.inf or self.shift[1] == -math.inf:
            found = ", ".join(f"{v:g}" for v in self.shift)
            message = f"the shift of {self.name} must have a begin and a later end"
            raise InputError(message, "contradiction", expected="two times", found=found)
        if self.max_reloads is not None and self.max_reloads < 0:
            raise InputError(f"max_reloads of {self.name} must not be negative", "out-of-range", found=str(self.max_reloads))
        if self.max_reloads is not None and not self.reloads:
            raise InputError(f"max_reloads of {self.name} is given, but no depot where it may reload", "missing", expected="reloads")
        if self.committed and self.count is None:
            raise InputError(f"{self.name} is committed, but without number", "missing", expected="a number of vehicles")
        if self.risk is not None:
            object.__setattr__(self, "risk", checked_risk(self.risk, f"the risk of {self.name}"))

    @property
    def capacities(self) -> tuple[float, ...]:
        """Capacity of each load dimension that is limited."""
        return (self.capacity, *self.further_capacity)

    @property
    def stations(self) -> tuple[int, ...]:
        """Site indices of depots where it recharges on the way."""
        return () if self.energy is None else self.energy.stations

    def __repr__(self) -> str:
        return _told(self, tuple(f.name for f in fields(self)[:10]))


def checked_risk(value: float, what: str) -> float:
    """``value``, if it is a probability up to which limits are stricter than those of the means."""
    if not 0.0 < float(value) <= 0.5:
        raise InputError(f"{what} must be a probability above 0, and 1/2 at most", "out-of-range", found=str(value))
    return float(value)


def _told(value: Energy | VehicleType, always: tuple[str, ...]) -> str:
    """A repr that leaves out what has its default, but for the fields ``always``."""
    parts = []
    for f in fields(value):
        held = getattr(value, f.name)
        if f.name in always or held != f.default:
            parts.append(f"{f.name}={sorted(held)!r}" if isinstance(held, frozenset) else f"{f.name}={held!r}")
    return f"{type(value).__name__}({', '.join(parts)})"
