"""Features of routing data, in the vocabulary in which file formats, problems, forms, solvers and heuristics name what they can express."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .instance import ENERGY_CHARGES, Sites, VehicleType
from .travel import Travel


class Data(Protocol):
    """The data of a routing instance, and of a problem that is made of it."""

    @property
    def sites(self) -> Sites: ...

    @property
    def travel(self) -> Travel: ...

    @property
    def fleet(self) -> Sequence[VehicleType]: ...

    @property
    def min_vehicles(self) -> int: ...

    @property
    def team_risk(self) -> float | None: ...

    @property
    def forbidden(self) -> NDArray[np.bool_] | None: ...


def _windows(sites: Sites, at: NDArray[np.int64]) -> bool:
    return bool(sites.ready[at].any() or np.isfinite(sites.due[at]).any())


def _limited(data: Data, limit: str) -> bool:
    return any(math.isfinite(getattr(v, limit)) for v in data.fleet)


def _any(data: Data, of: Callable[[VehicleType], Any]) -> bool:
    return any(of(v) for v in data.fleet)


def _closing(data: Data) -> bool:
    ways = (data.travel, *(v.travel for v in data.fleet if v.travel is not None))
    return any(t.closing is not None and bool(np.isfinite(t.closing).any()) for t in ways)


def _uncertain(data: Data) -> bool:
    return any(t.uncertain for t in (data.travel, *(v.travel for v in data.fleet if v.travel is not None)))


def _charged(data: Data, charge: str) -> bool:
    return any(v.energy is not None and v.energy.charge == charge for v in data.fleet)


ENERGY = tuple(f"energy:{charge}" for charge in ENERGY_CHARGES)

FEATURES: dict[str, Callable[[Any], bool]] = {
    "capacity": partial(_limited, limit="capacity"),
    "demands": lambda d: bool(d.sites.demand[d.sites.customers].any()),
    "time-windows": lambda d: _windows(d.sites, d.sites.customers),
    "depot-windows": lambda d: _windows(d.sites, d.sites.depots),
    "service-times": lambda d: bool(d.sites.service[d.sites.customers].any()),
    "demand-or-service-of-depots": lambda d: bool((d.sites.demand + d.sites.service)[d.sites.depots].any()),
    "rewards": lambda d: bool(d.sites.reward.any()),
    "optional-sites": lambda d: not d.sites.required[d.sites.customers].all(),
    "limited-fleet": lambda d: any(v.count is not None for v in d.fleet),
    "min-vehicles": lambda d: d.min_vehicles > 0,
    "heterogeneous-fleet": lambda d: len(d.fleet) > 1,
    "multiple-depots": lambda d: len(d.sites.depots) > 1,
    "open-routes": lambda d: any(v.start != v.end for v in d.fleet),
    "max-duration": partial(_limited, limit="max_duration"),
    "max-distance": partial(_limited, limit="max_distance"),
    **{name: partial(_charged, charge=charge) for name, charge in zip(ENERGY, ENERGY_CHARGES, strict=True)},
    "fixed-cost": lambda d: any(v.fixed_cost > 0 for v in d.fleet),
    "unit-cost": lambda d: any(v.unit_cost != 1 for v in d.fleet),
    "separate-durations": lambda d: d.travel.own_durations,
    "duration-cost": partial(_any, of=lambda v: v.unit_duration_cost > 0),
    "overtime": partial(_any, of=lambda v: v.unit_overtime_cost > 0 and v.regular_duration < math.inf),
    "shifts": partial(_any, of=lambda v: v.shift != (-math.inf, math.inf)),
    "vehicle-speeds": partial(_any, of=lambda v: v.speed != 1),
    "vehicle-travel": partial(_any, of=lambda v: v.travel is not None),
    "several-loads": lambda d: d.sites.dimensions > 1,
    "pickups": lambda d: bool(d.sites.pickup.any() or d.sites.further_pickup.any()),
    "shipments": lambda d: bool(d.sites.shipments),
    "groups": lambda d: bool(d.sites.groups),
    "several-windows": lambda d: any(d.sites.windows),
    "skills": lambda d: any(d.sites.skills),
    "penalties": lambda d: bool(d.sites.penalty.any()),
    "reloads": partial(_any, of=lambda v: v.reloads),
    "recharging": partial(_any, of=lambda v: v.stations),
    "initial-energy": partial(_any, of=lambda v: v.energy is not None and v.energy.at_departure < v.energy.capacity),
    "closing-moves": _closing,
    "forbidden-moves": lambda d: d.forbidden is not None,
    "committed-vehicles": partial(_any, of=lambda v: v.committed),
    "uncertain-durations": _uncertain,
    "route-risk": partial(_any, of=lambda v: v.risk is not None),
    "team-risk": lambda d: d.team_risk is not None,
}
"""Test of each feature by its name. Data that everything can express (asymmetric distances, equal vehicles at one depot) have no name."""

UNASKED = frozenset({"demands", "demand-or-service-of-depots", "rewards", "unit-cost", "penalties", "uncertain-durations"})
"""Features that ask nothing of a solver by themselves: rewards and penalties count where the objective has a term for them."""

LOADS = frozenset({"demands", "pickups", "shipments"})
"""Without any of them a capacity limits nothing."""

RISKS = frozenset({"route-risk", "team-risk"})
"""They limit nothing where all durations are certain."""


def features(data: Data) -> frozenset[str]:
    """Names of all that the data hold: what a file format must have a place for."""
    return frozenset(name for name, held in FEATURES.items() if held(data))


def restrictions(data: Data) -> frozenset[str]:
    """Features that a solver must be able to express: a capacity only where there are loads, a risk only where durations are uncertain."""
    present = features(data)
    idle = (frozenset() if present & LOADS else {"capacity"}) | (frozenset() if "uncertain-durations" in present else RISKS)
    return present - UNASKED - idle
