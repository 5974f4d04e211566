"""Routing instances: validated, immutable arrays that know no problem class and no solver."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from ..clock import Clock as Clock, moment_told
from ..errors import InputError, UsageError
from ..number_arrays import Flags, Integers
from .sites import Group as Group, Shipment as Shipment, Sites as Sites
from .travel import EXPLICIT, Travel
from .vehicle_type import (
    ENERGY_CHARGES as ENERGY_CHARGES,
    MOST_VEHICLES as MOST_VEHICLES,
    Energy as Energy,
    VehicleType as VehicleType,
    checked_risk,
)

SHOWN = 5
"""Depots that a message names."""

LARGEST = 1e150
"""Largest coordinate, distance, time, demand and cost: squares, products and sums of millions of them are finite."""


@dataclass(frozen=True, eq=False)
class RoutingInstance:
    """Sites, travel and fleet as a file gives them.

    Parameters
    ----------
    name : str
        For tables and files.
    format : str
        Name of the format it was read from (``solomon``, ``vrplib``, ``csv``, ``json``, ``generated``, ...).
    sites : Sites
        Depots and customers.
    travel : Travel
        Distances and durations between them.
    fleet : sequence of VehicleType
        Kinds of vehicles.
    problem : str
        The problem the format stands for (``vrptw``, ``cvrp``, ``tsp``, ...).
    problems : tuple of str
        All problems that may be asked of it; contains ``problem``.
    min_vehicles : int
        Routes that must be used at least.
    objective : tuple of str, optional
        The objective's terms, or weighted sums of them, in order of priority, where the file says them; else the problem's own.
    notes : tuple of str
        What a user should be told, such as where the fleet limit comes from.
    team_risk : float, optional
        The largest probability with which any of all routes may overrun a limit, as of ``VehicleType.risk``.
    forbidden : bool array of shape (sites, sites), optional
        Moves that no route makes.
    clock : Clock, optional
        What times count, where that is known; shown, and never computed with.
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
    team_risk: float | None = None
    forbidden: Flags | None = None
    clock: Clock | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "fleet", tuple(self.fleet))
        object.__setattr__(self, "problems", tuple(self.problems) or (self.problem,))
        check_routing_data(self.sites, self.travel, self.fleet, self.min_vehicles, self.team_risk, self.clock)
        check_moves(self.sites, self.forbidden)

    def with_customers(self, count: int) -> "RoutingInstance":
        """The depots and the first ``count`` customers, as the short versions of Solomon's files are made."""
        customers = self.sites.customers
        if not 1 <= count <= len(customers):
            raise UsageError(f"customers={count} is out of range: {self.name} has {len(customers)} customers", "out-of-range")
        keep = np.sort(np.concatenate([self.sites.depots, customers[:count]]))
        fleet = tuple(placed(v, keep) for v in self.fleet)
        moves = None if self.forbidden is None else self.forbidden[np.ix_(keep, keep)]
        sites, travel = self.sites.subset(keep), self.travel.subset(keep)
        return replace(self, name=f"{self.name}.{count}", sites=sites, travel=travel, fleet=fleet, forbidden=moves)


def placed(vehicle: VehicleType, keep: Integers) -> VehicleType:
    """The vehicle type where only the sites ``keep`` are left, its depots among them."""
    position = {int(site): k for k, site in enumerate(keep)}
    energy = vehicle.energy
    return replace(
        vehicle, start=position[vehicle.start], end=position[vehicle.end], reloads=tuple(position[k] for k in vehicle.reloads),
        energy=None if energy is None else replace(energy, stations=tuple(position[k] for k in energy.stations)),
        travel=None if vehicle.travel is None else vehicle.travel.subset(keep),
    )  # fmt: skip


def check_routing_data(
    sites: Sites,
    travel: Travel,
    fleet: Sequence[VehicleType],
    min_vehicles: int,
    team_risk: float | None = None,
    clock: Clock | None = None,
) -> None:
    """Raise InputError unless the parts of a routing instance fit each other."""
    if len(travel) != len(sites):
        raise InputError("travel and sites have different sizes", "wrong-shape", expected=str(len(sites)), found=str(len(travel)))
    if not fleet:
        raise InputError("the fleet is empty", "missing")
    if team_risk is not None:
        checked_risk(team_risk, "the risk of the team")
    for vehicle in fleet:
        _check_vehicle(vehicle, sites, travel, clock)
        if (vehicle.risk is not None or team_risk is not None) and (vehicle.travel or travel).uncertain:
            _check_normal(vehicle, sites)
    if min_vehicles < 0:
        raise InputError("the least number of vehicles must not be negative", "out-of-range", found=str(min_vehicles))
    _refuse_overflow(sites, travel, fleet)
    total = fleet_size(fleet)
    if total is not None and min_vehicles > total:
        raise InputError(f"at least {min_vehicles} vehicles are asked for, but the fleet has {total}", "contradiction")
    for k, needs in enumerate(sites.skills):
        if needs and sites.required[k] and not any(needs <= v.skills for v in fleet):
            message = f"no vehicle has the skills that site {sites.ids[k]} asks for"
            raise InputError(message, "contradiction", expected=", ".join(sorted(needs)))


def check_moves(sites: Sites, moves: Flags | None, what: str = "forbidden") -> None:
    """Raise InputError unless ``moves`` tells of each pair of sites whether it is in the set."""
    if moves is not None and (moves.shape != (len(sites), len(sites)) or moves.dtype != np.bool_):
        message = f"{what} moves must be truth values, one for each pair of sites"
        raise InputError(message, "malformed" if moves.dtype != np.bool_ else "wrong-shape", found=f"{moves.dtype} {moves.shape}")


def _check_vehicle(vehicle: VehicleType, sites: Sites, travel: Travel, clock: Clock | None) -> None:
    name = vehicle.name
    for stops, what in (((vehicle.start, vehicle.end), "starts or ends"), (vehicle.reloads, "reloads"), (vehicle.stations, "recharges")):
        for site in stops:
            if not 0 <= site < len(sites):
                raise InputError(f"{name} {what} at site {site}, which does not exist", "unknown-name", expected=f"0 to {len(sites) - 1}")
            if not sites.depot[site]:
                depots = [sites.ids[k] for k in sites.depots[:SHOWN].tolist()]
                more = ", ..." if len(sites.depots) > SHOWN else ""
                expected = f"{', '.join(depots)}{more}"
                raise InputError(f"{name} {what} at site {sites.ids[site]}, which is no depot", "unknown-name", expected=expected)
    if len(vehicle.further_capacity) not in (0, sites.dimensions - 1):
        message = f"capacity of {name} has another number of load dimensions than the sites"
        raise InputError(message, "wrong-shape", expected=str(sites.dimensions), found=str(1 + len(vehicle.further_capacity)))
    opens, closes = max(float(sites.ready[vehicle.start]), vehicle.shift[0]), min(float(sites.due[vehicle.end]), vehicle.shift[1])
    if math.isfinite(vehicle.shift[0]) and opens > float(sites.due[vehicle.start]):
        found = f"from {moment_told(clock, opens)}, the latest departure is {moment_told(clock, float(sites.due[vehicle.start]))}"
        raise InputError(f"the shift of {name} begins after its depot has closed", "contradiction", found=found)
    if (math.isfinite(vehicle.shift[0]) or math.isfinite(vehicle.shift[1])) and opens > closes:
        message = f"the shift of {name} leaves no time between departure and return"
        raise InputError(message, "contradiction", found=f"{moment_told(clock, opens)} to {moment_told(clock, closes)}")
    if sites.windows and vehicle.energy is not None and vehicle.energy.charge == "windows":
        message = f"energy of {name} is charged by windows, and a site has several"
        raise InputError(message, "contradiction", expected="travel, elapsed or elapsed-fixed-start")
    own = vehicle.travel
    if own is not None:
        if len(own) != len(sites):
            message = f"travel of {name} and sites have different sizes"
            raise InputError(message, "wrong-shape", expected=str(len(sites)), found=str(len(own)))
        plain = {"file", "exact"}  # the same thing for a matrix
        if own.convention != travel.convention and not (
            {own.convention, travel.convention} <= plain and (own.metric == EXPLICIT or travel.metric == EXPLICIT)
        ):
            message = f"{name} travels under another convention than the others"
            raise InputError(message, "contradiction", expected=travel.convention, found=own.convention)


def _check_normal(vehicle: VehicleType, sites: Sites) -> None:
    """Raise InputError unless what is limited of a route is a sum of its moves, and so normal where they are."""
    energy = vehicle.energy
    if energy is not None and (energy.stations or energy.charge == "windows"):
        why = "is filled up on the way" if energy.stations else "is charged by windows"
        message = f"the store of {vehicle.name} {why}, so that no risk of its running out is known"
        raise InputError(message, "unsupported", expected="one charge for a route")
    if math.isinf(vehicle.max_duration) and (energy is None or energy.charge == "travel"):
        return
    opens = max(float(sites.ready[vehicle.start]), vehicle.shift[0])
    stops = [*sites.customers.tolist(), *vehicle.reloads]
    late = [k for k in stops if sites.ready[k] > opens or (sites.windows and sites.windows[k])]
    if late:
        message = f"{vehicle.name} may have to wait at site {sites.ids[late[0]]}, so that no risk of its taking too long is known"
        raise InputError(message, "unsupported", expected="windows that are open when it departs, or energy for travel as its only limit")


def _refuse_overflow(sites: Sites, travel: Travel, fleet: Sequence[VehicleType]) -> None:
    """Raise InputError for finite numbers whose squares, products or sums would not be finite."""
    ways = [travel, *(v.travel for v in fleet if v.travel is not None)]
    for what, columns in (
        *((name, column) for t in ways for name, column in (
            ("coordinate", t.coordinates), ("distance", t.matrix), ("duration", t.duration_matrix), ("variance", t.variances))),
        ("coordinate", sites.coordinates), ("demand", sites.demand), ("ready time", sites.ready), ("service", sites.service),
        ("reward", sites.reward), ("penalty", sites.penalty), ("pickup", sites.pickup), ("demand", sites.further_demand),
        ("pickup", sites.further_pickup),
    ):  # fmt: skip
        if columns is None or max(float(columns.max(initial=0.0)), -float(columns.min(initial=0.0))) <= LARGEST:
            continue
        worst = np.abs(columns)
        site = sites.ids[int(np.argmax(worst if worst.ndim == 1 else worst.max(axis=1)))]
        message = f"{what} of site {site} is too large to compute with"
        raise InputError(message, "out-of-range", expected=f"at most {LARGEST:g}", found=f"{worst.max():g}")
    for vehicle in fleet:
        for name in ("fixed_cost", "unit_cost", "unit_duration_cost", "unit_overtime_cost"):
            if getattr(vehicle, name) > LARGEST:
                found = f"{getattr(vehicle, name):g}"
                message = f"{name} of {vehicle.name} is too large to compute with"
                raise InputError(message, "out-of-range", expected=f"at most {LARGEST:g}", found=found)


def fleet_size(fleet: Sequence[VehicleType]) -> int | None:
    """Number of vehicles of all types, None if any type is unlimited."""
    counts = [vehicle.count for vehicle in fleet]
    return None if any(c is None for c in counts) else sum(c for c in counts if c is not None)
