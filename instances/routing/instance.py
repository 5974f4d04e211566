"""What a routing instance holds: validated, immutable arrays. An instance knows no problem class and no solver."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, UsageError
from .travel import Travel

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

LARGEST = 1e150
"""Largest coordinate, distance, time, demand and cost: squares, products and sums of millions of them are finite."""

MOST_VEHICLES = 10**18
"""Largest number of vehicles of one type."""

ENERGY_CHARGES = ("travel", "elapsed", "elapsed-fixed-start", "windows")


@dataclass(frozen=True, eq=False)
class Sites:
    """Places to visit or to start from, one entry a site in the file's order.

    Parameters
    ----------
    ids : sequence of str
        The file's own names, all different.
    depot : array of bool
        Sites where routes start and end; they are never visited.
    demand : array, units of load, >= 0
    ready, due : arrays, units of time
        Service may start within [ready, due]; a vehicle may wait. Defaults 0 and infinity.
        At a depot: the earliest departure and the latest return.
    service : array, units of time, >= 0
    reward : array, >= 0
    required : array of bool
        Customers that must be visited; by default all that are no depots.
    coordinates : array of shape (sites, 2), optional
        For maps; distances belong to ``Travel``.

    Raises
    ------
    InputError
        Naming the site and the quantity that is wrong.
    """

    ids: tuple[str, ...]
    depot: Flags
    demand: Floats
    ready: Floats
    due: Floats
    service: Floats
    reward: Floats
    required: Flags
    coordinates: Floats | None = None

    @classmethod
    def of(
        cls,
        ids: Sequence[object],
        *,
        depot: ArrayLike | None = None,
        demand: ArrayLike = 0.0,
        ready: ArrayLike = 0.0,
        due: ArrayLike = math.inf,
        service: ArrayLike = 0.0,
        reward: ArrayLike = 0.0,
        required: ArrayLike | None = None,
        coordinates: ArrayLike | None = None,
    ) -> Sites:
        """Sites from arrays or scalars; without ``depot`` the first site is the only depot."""
        n = len(ids)
        if n == 0:
            raise InputError("there are no sites")
        flags = np.zeros(n, dtype=bool)
        if depot is None:
            flags[0] = True
        else:
            flags[:] = np.asarray(depot, dtype=bool)
        must = ~flags if required is None else np.array(np.broadcast_to(np.asarray(required, dtype=bool), n))

        def spread(v: ArrayLike) -> Floats:
            return np.array(np.broadcast_to(np.asarray(v, dtype=np.float64), n))

        xy = None if coordinates is None else np.array(coordinates, dtype=np.float64)
        return cls(
            tuple(str(i) for i in ids), flags, spread(demand), spread(ready), spread(due), spread(service),
            spread(reward), must & ~flags, xy,
        )  # fmt: skip

    def __post_init__(self) -> None:
        n = len(self.ids)
        for name in ("depot", "demand", "ready", "due", "service", "reward", "required"):
            values = getattr(self, name)
            if values.shape != (n,):
                raise InputError(f"{name} must have one entry a site", expected=str(n), found=str(values.shape))
            values.setflags(write=False)
        if self.coordinates is not None:
            if self.coordinates.shape != (n, 2):
                raise InputError("coordinates must have two entries a site", expected=f"({n}, 2)", found=str(self.coordinates.shape))
            self._refuse(~np.isfinite(self.coordinates).all(axis=1), "coordinate of site {} is not finite", self.coordinates)
            self.coordinates.setflags(write=False)
        seen: set[str] = set()
        for site in self.ids:
            if site in seen:
                raise InputError(f"two sites have the id {site!r}", expected="different ids")
            seen.add(site)
        for name in ("demand", "service", "reward"):
            values = getattr(self, name)
            self._refuse(np.asarray(~(values >= 0) | np.isinf(values)), name + " of site {} must be finite and not negative", values)
        self._refuse(~np.isfinite(self.ready), "ready time of site {} must be finite", self.ready)
        self._refuse(np.asarray(np.isnan(self.due) | np.isneginf(self.due)), "due time of site {} must be a number", self.due)
        self._refuse(
            np.asarray(self.ready > self.due), "time window of site {} closes before it opens", np.column_stack([self.ready, self.due])
        )
        if not self.depot.any():
            raise InputError("there is no depot")

    def _refuse(self, bad: Flags | np.bool_, message: str, values: Floats) -> None:
        if np.any(bad):
            k = int(np.argmax(bad))
            raise InputError(message.format(self.ids[k]), found=str(values[k]))

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def depots(self) -> NDArray[np.int64]:
        """Indices of the depots."""
        return np.nonzero(self.depot)[0]

    @property
    def customers(self) -> NDArray[np.int64]:
        """Indices of all sites that are no depots."""
        return np.nonzero(~self.depot)[0]

    def index(self) -> dict[str, int]:
        """Index of each id."""
        return {site: k for k, site in enumerate(self.ids)}

    def subset(self, sites: ArrayLike) -> Sites:
        """The given sites, in the given order."""
        keep = np.asarray(sites, dtype=np.int64)
        arrays = {
            name: np.array(getattr(self, name)[keep]) for name in ("depot", "demand", "ready", "due", "service", "reward", "required")
        }
        xy = None if self.coordinates is None else np.array(self.coordinates[keep])
        return Sites(ids=tuple(self.ids[k] for k in keep.tolist()), coordinates=xy, **arrays)


@dataclass(frozen=True)
class Energy:
    """An energy store that is full at departure and must last for a route.

    Parameters
    ----------
    capacity : float, energy, >= 0
    rate : float, energy per unit of time, > 0
    charge : str
        What a route is charged for, from loosest to strictest: ``travel`` (time on the move; waiting and service are
        free), ``elapsed`` (from departure to return, departing as late as possible), ``elapsed-fixed-start`` (the same,
        departing when the depot opens), ``windows`` (each move i -> j at max(s_i + d_ij, a_j - a_i): row (3.14) of the source,
        conservative).

    Notes
    -----
    Source: Mitchell (2020), section 3.2 and (3.14); the four modes compared: docs/formulations/routing.md#energy.
    """

    capacity: float
    rate: float = 1.0
    charge: str = "travel"

    def __post_init__(self) -> None:
        for name in ("capacity", "rate"):
            object.__setattr__(self, name, float(getattr(self, name)))
        if not self.capacity >= 0 or not math.isfinite(self.capacity):
            raise InputError("energy capacity must be finite and not negative", found=str(self.capacity))
        if not self.rate > 0 or not math.isfinite(self.rate):
            raise InputError("energy rate must be positive and finite", found=str(self.rate))
        if self.charge not in ENERGY_CHARGES:
            raise InputError("unknown energy charge", expected=", ".join(ENERGY_CHARGES), found=self.charge)


@dataclass(frozen=True)
class VehicleType:
    """Vehicles of one kind.

    Parameters
    ----------
    count : int or None
        How many there are; None for any number.
    capacity : float, units of load
    start, end : int
        Site index of the depot where its routes start, and end.
    max_duration : float, units of time
        Longest time from departure to return, service and waiting included, departing as late as the windows allow.
    max_distance : float, units of distance
    energy : Energy, optional
    fixed_cost : float
        Cost of using one vehicle.
    unit_cost : float
        Cost of one unit of distance.
    name : str
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

    def __post_init__(self) -> None:
        if self.count is not None and not 1 <= self.count <= MOST_VEHICLES:
            wrong = "least 1" if self.count < 1 else f"most {MOST_VEHICLES}"
            raise InputError(f"the number of vehicles must be at {wrong}", found=str(self.count))
        for name in ("capacity", "max_duration", "max_distance", "fixed_cost", "unit_cost"):
            object.__setattr__(self, name, float(getattr(self, name)))  # 5 and 5.0 must hash alike
        for name in ("capacity", "max_duration", "max_distance"):
            value = getattr(self, name)
            if not value >= 0:
                raise InputError(f"{name} of {self.name} must be a number and not negative", found=str(value))
        for name in ("fixed_cost", "unit_cost"):
            value = getattr(self, name)
            if not value >= 0 or not math.isfinite(value):
                raise InputError(f"{name} of {self.name} must be finite and not negative", found=str(value))


@dataclass(frozen=True, eq=False)
class RoutingInstance:
    """Sites, travel and fleet as a file gives them.

    Parameters
    ----------
    name : str
    format : str
        Name of the format it was read from (``solomon``, ``vrplib``, ``csv``, ``json``, ``generated``, ...).
    sites : Sites
    travel : Travel
    fleet : sequence of VehicleType
    problem : str
        The problem the format stands for (``vrptw``, ``cvrp``, ``tsp``, ...).
    problems : tuple of str
        All problems that may be asked of it; contains ``problem``.
    min_vehicles : int
        Routes that must be used at least.
    objective : tuple of str, optional
        Names of the objective's terms in order of priority, where the file says them; else the problem's own.
    notes : tuple of str
        What a user should be told, such as where the fleet limit comes from.
    """

    kind: ClassVar[str] = "routing"
    name: str
    format: str
    sites: Sites
    travel: Travel
    fleet: Sequence[VehicleType]
    problem: str = "cvrp"
    problems: tuple[str, ...] = ()
    min_vehicles: int = 0
    objective: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "fleet", tuple(self.fleet))
        object.__setattr__(self, "problems", tuple(self.problems) or (self.problem,))
        check_routing_data(self.sites, self.travel, self.fleet, self.min_vehicles)

    def with_customers(self, count: int) -> RoutingInstance:
        """The depots and the first ``count`` customers, as the short versions of Solomon's files are made."""
        customers = self.sites.customers
        if not 1 <= count <= len(customers):
            raise UsageError(f"customers={count} is out of range: {self.name} has {len(customers)} customers")
        keep = np.sort(np.concatenate([self.sites.depots, customers[:count]]))
        position = {int(site): k for k, site in enumerate(keep)}
        fleet = tuple(replace(v, start=position[v.start], end=position[v.end]) for v in self.fleet)
        return replace(self, name=f"{self.name}.{count}", sites=self.sites.subset(keep), travel=self.travel.subset(keep), fleet=fleet)


def check_routing_data(sites: Sites, travel: Travel, fleet: Sequence[VehicleType], min_vehicles: int) -> None:
    """Raise InputError unless the parts of a routing instance fit each other."""
    if len(travel) != len(sites):
        raise InputError("travel and sites have different sizes", expected=str(len(sites)), found=str(len(travel)))
    if not fleet:
        raise InputError("the fleet is empty")
    for vehicle in fleet:
        for end in (vehicle.start, vehicle.end):
            if not 0 <= end < len(sites) or not sites.depot[end]:
                raise InputError(f"{vehicle.name} starts or ends at site {end}, which is no depot")
    if min_vehicles < 0:
        raise InputError("the least number of vehicles must not be negative", found=str(min_vehicles))
    _refuse_overflow(sites, travel, fleet)
    total = fleet_size(fleet)
    if total is not None and min_vehicles > total:
        raise InputError(f"at least {min_vehicles} vehicles are asked for, but the fleet has {total}")


def _refuse_overflow(sites: Sites, travel: Travel, fleet: Sequence[VehicleType]) -> None:
    """Raise InputError for finite numbers whose squares, products or sums would not be finite."""
    for what, columns in (
        ("coordinate", sites.coordinates), ("coordinate", travel.coordinates), ("demand", sites.demand), ("ready time", sites.ready),
        ("service", sites.service), ("reward", sites.reward), ("distance", travel.matrix), ("duration", travel.duration_matrix),
    ):  # fmt: skip
        if columns is None or max(float(columns.max(initial=0.0)), -float(columns.min(initial=0.0))) <= LARGEST:
            continue
        worst = np.abs(columns)
        site = sites.ids[int(np.argmax(worst if worst.ndim == 1 else worst.max(axis=1)))]
        raise InputError(f"{what} of site {site} is too large to compute with", expected=f"at most {LARGEST:g}", found=f"{worst.max():g}")
    for vehicle in fleet:
        for name in ("fixed_cost", "unit_cost"):
            if getattr(vehicle, name) > LARGEST:
                found = f"{getattr(vehicle, name):g}"
                raise InputError(f"{name} of {vehicle.name} is too large to compute with", expected=f"at most {LARGEST:g}", found=found)


def fleet_size(fleet: Sequence[VehicleType]) -> int | None:
    """Number of vehicles of all types, None if any type is unlimited."""
    counts = [vehicle.count for vehicle in fleet]
    return None if any(c is None for c in counts) else sum(c for c in counts if c is not None)
