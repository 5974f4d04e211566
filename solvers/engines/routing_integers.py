"""Routing data as integers, for engines that count in integers: one place, one rule of rounding.

Data of extraordinary size are first brought to an ordinary one by a power of two. What can then be written exactly with at most three
decimals is scaled exactly. All else is scaled by 1e6, consumption up and limits down, so that whatever is feasible for the integers is
feasible for the data.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...formulations.programs.exactness import Exactness, Link
from ...instances.errors import InputError
from .routing_objective import scalarised

if TYPE_CHECKING:
    from ...formulations.routing.problem import RoutingProblem

Integers = NDArray[np.int64]
Floats = NDArray[np.float64]

UNLIMITED = int(np.iinfo(np.int64).max)
"""Stands for infinity; each engine puts its own largest value there."""

FINE = 1_000_000
"""Scale of data that three decimals cannot hold."""

_ROUNDING = 4 * float(np.finfo(np.float64).eps)
_SMALL, _WIDE, _BASE = -10, 40, 20
"""Binary exponents: data below 2**-10, above 2**40, or above 2**20 and to be rounded become just less than 2**20; so do binary fractions,
which that makes exact."""


@dataclass(frozen=True)
class Scale:
    """One unit of the data is ``factor`` integers; ``exact`` if nothing was rounded."""

    factor: float
    exact: bool

    def nearest(self, values: ArrayLike) -> Integers:
        """For costs."""
        return _integers(np.rint(np.asarray(values, dtype=np.float64) * self.factor))

    def up(self, values: ArrayLike) -> Integers:
        """For what is consumed, and for earliest times."""
        scaled = self._scaled(values)
        return _integers(np.ceil(scaled if self.exact else scaled - _ROUNDING * np.abs(scaled)))

    def down(self, values: ArrayLike) -> Integers:
        """For limits; infinite ones become ``UNLIMITED``."""
        scaled = self._scaled(values)
        return _integers(np.floor(scaled if self.exact else scaled + _ROUNDING * np.abs(scaled)))

    def _scaled(self, values: ArrayLike) -> Floats:
        scaled = np.asarray(values, dtype=np.float64) * self.factor
        return np.where(_whole(scaled), np.rint(scaled), scaled) if self.exact else scaled


def scale_of(*values: ArrayLike, fine: int = FINE) -> Scale:
    """The smallest of 1, 10, 100, 1000 that makes all finite ``values`` integers, but for the rounding of floats; else ``fine``.

    Each times a power of two, where the largest value is very small or very large.
    """
    parts = [np.asarray(v, dtype=np.float64).ravel() for v in values]
    every = np.concatenate(parts) if parts else np.zeros(0)
    every = every[np.isfinite(every)]
    largest = float(np.abs(every).max(initial=0.0))
    if largest == 0.0:
        return Scale(1, True)
    exponent = math.frexp(largest)[1]
    other = math.ldexp(1.0, min(1000, _BASE - exponent))
    for unit in (1.0, other) if _SMALL <= exponent <= _WIDE else (other,):
        for factor in (1, 10, 100, 1000):
            if _whole(every * unit * factor).all():
                return Scale(_plain(unit * factor), True)
    return Scale(_plain((1.0 if _SMALL <= exponent <= _BASE else other) * fine), False)


def _plain(factor: float) -> float:
    """A whole number as one, for people to read."""
    return int(factor) if factor == int(factor) else factor


@dataclass(frozen=True, eq=False)
class IntegerRouting:
    """A routing problem in integers; ``UNLIMITED`` where there is no limit.

    Attributes
    ----------
    distance : int array of shape (sites, sites)
        For costs: rounded to the nearest.
    distance_up, duration : int arrays of shape (sites, sites)
        For limits: rounded up.
    service, ready, due, demand : int arrays, one entry a site
        Times count from ``origin``, the earliest ready time if that is negative.
    charge : int array of shape (sites, sites)
        Time charged for a move by ``energy:windows``; rounded up.
    prize : int array, one entry a site
        What a visit is worth in the cost's units.
    capacity, max_duration, max_distance, unit, fixed : int arrays, one entry a vehicle type
    travel_limit, charge_limit, latest_return : int arrays, one entry a vehicle type
        Energy as a limit on time: on the move, charged by windows, and as the latest return of a route that starts when
        its depot opens.
    travel_reach : int array, one entry a vehicle type
        ``travel_limit`` as a limit on distance, where moves take as long as they are.
    cost_factor : float
        Integers in one unit of the objective.
    scales : dict
        For the report: scale of cost, distance, time and load.
    """

    distance: Integers
    distance_up: Integers
    duration: Integers
    service: Integers
    ready: Integers
    due: Integers
    demand: Integers
    charge: Integers | None
    prize: Integers
    capacity: Integers
    max_duration: Integers
    max_distance: Integers
    unit: Integers
    fixed: Integers
    travel_limit: Integers
    travel_reach: Integers
    charge_limit: Integers
    latest_return: Integers
    cost_factor: float
    scales: dict[str, Any]

    @property
    def holds(self) -> Exactness:
        """For what a search of these integers can claim: limits are rounded to the safe side where they are rounded at all."""
        return Exactness.EXACT if self.scales["exact"] else Exactness.RESTRICTION

    @property
    def link(self) -> Link:
        """What was done to the data, for the chain that a solution shows."""
        units = ", ".join(f"{name} times {factor:g}" for name, factor in self.scales.items() if name != "exact")
        return Link("whole-numbers", self.holds, units)


def integer_routing(problem: RoutingProblem, *, largest: int = 2**44, total: int = 2**60, fine: int = FINE) -> IntegerRouting:
    """The data of ``problem`` in integers.

    Parameters
    ----------
    problem : RoutingProblem
        Its objective is a combination of total cost, vehicles and reward (``scalarised``).
    largest : int
        Largest integer that the engine takes as a single value.
    total : int
        Largest sum along a whole answer that it can hold.
    fine : int
        Scale of data that three decimals cannot hold, for engines with little room.

    Raises
    ------
    InputError
        If a value or a sum of them is beyond ``largest`` or ``total``; names the largest value.
    """
    sites, travel, fleet = problem.sites, problem.travel, problem.fleet
    goal = scalarised(problem)
    n = len(sites)

    per_unit = scale_of(goal.unit, fine=fine)
    length = scale_of(travel.distances, goal.fixed * per_unit.factor, goal.prize * per_unit.factor, fine=fine)
    cost = Scale(length.factor * per_unit.factor, length.exact and per_unit.exact)
    served = np.where(sites.depot, 0.0, sites.service)
    clock = scale_of(travel.durations, served, sites.ready, sites.due, fine=fine)
    carried = np.where(sites.depot, 0.0, sites.demand)
    load = scale_of(carried, fine=fine)

    origin = min(0.0, float(sites.ready.min()))
    ready, due = clock.up(sites.ready - origin), clock.down(sites.due - origin)
    service = clock.up(served)
    # A window without an integer in it: begin at the integer below, and count the difference as service.
    narrow = (ready > due) & ~sites.depot
    ready, service = np.where(narrow, due, ready), service + narrow

    budgets = {kind: np.full(len(fleet), math.inf) for kind in ("travel", "elapsed", "elapsed-fixed-start", "windows")}
    for k, vehicle in enumerate(fleet):
        if vehicle.energy is not None:
            budgets[vehicle.energy.charge][k] = vehicle.energy.capacity / vehicle.energy.rate
    opens = sites.ready[[v.start for v in fleet]] - origin
    charge = None
    if np.isfinite(budgets["windows"]).any():
        moved = served[:, None] + travel.durations
        waited = np.where(sites.depot[None, :], -math.inf, sites.ready[None, :] - sites.ready[:, None])
        charge = clock.up(np.maximum(moved, waited))
        np.fill_diagonal(charge, 0)

    demand, capacity = load.up(carried), load.down([v.capacity for v in fleet])
    common = max(1, int(np.gcd.reduce(demand)))
    demand, capacity = demand // common, np.where(capacity == UNLIMITED, UNLIMITED, capacity // common)
    distance = length.nearest(travel.distances)
    made = IntegerRouting(
        distance=distance,
        distance_up=distance if length.exact else length.up(travel.distances),
        duration=clock.up(travel.durations),
        service=service, ready=ready, due=due,
        demand=demand,
        charge=charge,
        prize=cost.nearest(goal.prize),
        capacity=capacity,
        max_duration=np.minimum(clock.down([v.max_duration for v in fleet]), clock.down(budgets["elapsed"])),
        max_distance=length.down([v.max_distance for v in fleet]),
        unit=per_unit.nearest(goal.unit),
        fixed=cost.nearest(goal.fixed),
        travel_limit=clock.down(budgets["travel"]),
        travel_reach=length.down(budgets["travel"]),
        charge_limit=clock.down(budgets["windows"]),
        latest_return=clock.down(opens + budgets["elapsed-fixed-start"]),
        cost_factor=cost.factor,
        scales={
            "cost": cost.factor, "distance": length.factor, "time": clock.factor, "load": _plain(load.factor / common),
            "exact": cost.exact and clock.exact and load.exact,
        },
    )  # fmt: skip
    _check_headroom(made, n, largest, total)
    return made


def _check_headroom(made: IntegerRouting, sites: int, largest: int, total: int) -> None:
    """Refuse data whose sums could overflow. Sums along an answer have at most two moves a site."""
    singles = {
        "distance": (made.distance_up, made.scales["distance"]),
        "duration": (made.duration, made.scales["time"]),
        "service time": (made.service, made.scales["time"]),
        "ready time": (made.ready, made.scales["time"]),
        "demand": (made.demand, made.scales["load"]),
        "fixed cost": (made.fixed, made.scales["cost"]),
        "reward": (made.prize, made.scales["cost"]),
    }
    for what, (values, factor) in singles.items():
        top = int(values.max(initial=0))
        limit = min(largest, total // max(1, 2 * sites))
        if what == "distance":
            limit //= max(1, int(made.unit.max(initial=1)))
        if top > limit:
            raise InputError(
                f"the largest {what} is too large for an engine that counts in integers (scaled by {factor})",
                expected=f"at most {limit / factor:g}", found=f"{top / factor:g}",
            )  # fmt: skip


def _whole(values: Floats) -> NDArray[np.bool_]:
    """Which values are integers but for the rounding of floats."""
    with np.errstate(invalid="ignore"):  # infinity less infinity
        return np.asarray(np.abs(values - np.rint(values)) <= _ROUNDING * np.abs(values))


def _integers(values: Floats) -> Integers:
    """Whole floats as integers; what int64 cannot hold becomes ``UNLIMITED``, with a wide margin for further sums."""
    values = np.asarray(values, dtype=np.float64)
    high = values >= 2.0**62
    made = np.where(high, 0.0, np.maximum(values, -(2.0**62))).astype(np.int64)
    made[high] = UNLIMITED
    return made
