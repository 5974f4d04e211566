"""Random small problems of the whole routing family: each with one feature that it was drawn for, and up to two more."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...formulations.routing.objective import (
    Composable,
    LatestReturn,
    LongestRoute,
    Makespan,
    Objective,
    Penalties,
    Reward,
    TotalCost,
    TotalDuration,
    Vehicles,
)
from ...formulations.routing.problem import RoutingProblem
from ...instances.errors import InputError
from ...instances.routing.features import RISKS, features
from ...instances.routing.instance import ENERGY_CHARGES, Energy, Group, Shipment, Sites, VehicleType, fleet_size
from ...instances.routing.travel import EXPLICIT, Travel

CUSTOMERS = {1: 5, 2: 24, 3: 38, 4: 25, 5: 6, 6: 1, 7: 1}
"""Numbers of customers, and how often of 100 times each is drawn: one of seven takes solvers of programs a minute and more."""

GOALS: tuple[Composable, ...] = (
    TotalCost(), TotalDuration(), Makespan(), LatestReturn(), LongestRoute(), Vehicles() * 9.0 + TotalCost(), Reward(),
    TotalCost() - Reward(), TotalCost() + Penalties(), Makespan() + 0.25 * TotalDuration(), LongestRoute() + 0.5 * Vehicles(),
    Reward() - 0.25 * Makespan(), Penalties() + 0.5 * LatestReturn(), Vehicles().then(TotalCost()), Vehicles().then(TotalDuration()),
    Reward().then(Makespan()), Reward().then(TotalCost()), Penalties().then(TotalDuration()), Makespan().then(TotalCost()),
    TotalCost().then(LatestReturn()), Vehicles().then(LongestRoute()).then(TotalCost()), LatestReturn().then(Vehicles()),
)  # fmt: skip


@dataclass
class _Draft:
    """A problem in the making."""

    rng: np.random.Generator
    customers: int
    depots: int
    wanted: tuple[str, ...]
    unit: float
    sites: dict[str, Any] = field(default_factory=dict)
    vehicle: dict[str, Any] = field(default_factory=dict)
    others: list[dict[str, Any]] = field(default_factory=list)
    closing: Any = None
    forbidden: Any = None
    durations: Any = None
    variances: Any = None
    team_risk: float | None = None
    min_vehicles: int = 0

    def __post_init__(self) -> None:
        n = self.size
        self.depot = np.arange(n) < self.depots
        self.xy = self.numbers(0, 20, (n, 2))
        self.travel = self._travel()
        self.around = float(self.travel.distances.max()) * 2.0 + self.unit
        self.sites["required"] = ~self.depot

    @property
    def size(self) -> int:
        return self.customers + self.depots

    def numbers(self, low: int, high: int, shape: Any = None) -> Any:
        """Whole multiples of the unit from ``low`` up to, without, ``high``."""
        drawn = self.rng.integers(round(low / self.unit), round(high / self.unit), shape) * self.unit
        return drawn.round(1) if isinstance(drawn, np.ndarray) else round(float(drawn), 1)

    def number(self, low: float, high: float) -> float:
        return float(self.numbers(math.floor(low), max(math.ceil(high), math.floor(low) + 1)))

    def of_customers(self, low: int, high: int) -> Any:
        return np.where(self.depot, 0.0, self.numbers(low, high, self.size))

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def around_times(self, low: float, high: float) -> float:
        return self.number(low * self.around, high * self.around)

    def own_matrix(self) -> Any:
        drawn = self.numbers(1, 25, (self.size, self.size))
        np.fill_diagonal(drawn, 0.0)
        return drawn

    def pick(self, count: int) -> list[int]:
        """Different customers."""
        return [int(k) for k in self.depots + self.rng.permutation(self.customers)[:count]]

    def _travel(self) -> Travel:
        sort = self.rng.random()
        if sort < 0.35:
            return Travel("euclidean", self.xy, convention=str(self.rng.choice(["exact", "trunc1", "round"])))
        matrix = np.abs(self.xy[:, None] - self.xy[None, :]).sum(axis=2)
        if sort < 0.6:  # neither symmetric nor metric
            matrix = self.own_matrix()
        return Travel(EXPLICIT, self.xy, matrix.round(1))


def _second(d: _Draft, **changes: Any) -> None:
    d.others.append({"count": 1, "fixed_cost": 3.0, "end": d.depots - 1, **changes})


def _windows(d: _Draft) -> None:
    ready = d.of_customers(0, 25)
    d.sites |= {
        "ready": ready + d.sites.get("ready", 0.0) * d.depot,
        "due": np.where(d.depot, d.sites.get("due", math.inf), ready + d.numbers(12, 60, d.size)),
    }


def _depot_windows(d: _Draft) -> None:
    opens = d.number(1, 10)
    closes = opens + d.around_times(1.0, 3.0)
    d.sites |= {
        "ready": np.where(d.depot, opens, d.sites.get("ready", 0.0)), "due": np.where(d.depot, closes, d.sites.get("due", math.inf))
    }  # fmt: skip


def _optional(d: _Draft) -> None:
    d.sites["required"] = ~d.depot & (d.rng.random(d.size) < 0.4)


def _loads(d: _Draft) -> None:
    d.sites["demand"] = d.of_customers(0, 6)
    total, largest = float(d.sites["demand"].sum()), float(d.sites["demand"].max())
    d.vehicle["capacity"] = max(largest, math.ceil(total * d.rng.uniform(0.35, 1.0)), d.unit)


def _pickups(d: _Draft) -> None:
    if "demand" not in d.sites:
        _loads(d)
    d.sites["pickup"] = d.of_customers(0, 6)
    d.vehicle["capacity"] = max(d.vehicle["capacity"], float(d.sites["pickup"].max()))


def _several_loads(d: _Draft) -> None:
    if "demand" not in d.sites:
        _loads(d)
    further = d.of_customers(0, 4)
    d.sites["demand"] = np.column_stack([d.sites["demand"], further])
    d.vehicle["further_capacity"] = (max(float(further.max()), d.number(3, 7)),)


def _shipments(d: _Draft) -> None:
    if d.customers < 2:
        raise InputError("a shipment has two ends")
    first, *others = d.pick(3)
    load = (d.number(1, 5),)
    d.sites["shipments"] = [
        Shipment(first, others[0], load),
        *([Shipment(first, others[1], load)] if len(others) > 1 and d.chance(0.3) else []),
    ]
    if d.chance(0.5):  # optional ones, both ends alike
        d.sites["required"] = d.sites["required"].copy()
        d.sites["required"][[k for x in d.sites["shipments"] for k in (x.pickup, x.delivery)]] = False
    d.vehicle.setdefault("capacity", d.number(3, 9))


def _groups(d: _Draft) -> None:
    if d.customers < 2:
        raise InputError("alternatives are two at least")
    chosen = d.pick(int(d.rng.integers(2, 4)))
    d.sites["groups"] = [Group(tuple(chosen), d.chance(0.6))]


def _several_windows(d: _Draft) -> None:
    opens = d.numbers(0, 15, d.size)
    d.sites["windows"] = {
        int(k): [(opens[k], opens[k] + 4), (opens[k] + 12, opens[k] + 18), (opens[k] + 30, opens[k] + 45)][: int(d.rng.integers(2, 4))]
        for k in d.pick(int(d.rng.integers(1, d.customers + 1)))
    }  # fmt: skip


def _skills(d: _Draft) -> None:
    first, *others = d.pick(2)
    d.sites["skills"] = {first: ["cold"], **{k: ["cold", "tall"] for k in others if d.chance(0.4)}}
    if d.chance(0.3):
        d.vehicle["skills"] = frozenset({"cold", "tall"})
    else:
        _second(d, skills=frozenset({"cold", "tall"}), count=int(d.rng.integers(1, 3)))


def _energy(d: _Draft, charge: str, **more: Any) -> None:
    rate = float(d.rng.choice([1.0, 0.5, 2.0]))
    d.vehicle["energy"] = Energy(rate * d.around_times(0.9, 2.0), rate, charge, **more)


def _initial(d: _Draft) -> None:
    _energy(d, str(d.rng.choice(ENERGY_CHARGES[:3])))
    full = d.vehicle["energy"]
    d.vehicle["energy"] = Energy(full.capacity, full.rate, full.charge, (), math.floor(0.75 * full.capacity))


def _recharging(d: _Draft) -> None:
    room = d.around_times(0.5, 1.1)
    d.vehicle["energy"] = Energy(room, 1.0, "travel", (0, 1) if d.chance(0.7) else (1,), room / 2 if d.chance(0.3) else None)


def _reloads(d: _Draft) -> None:
    _loads(d)
    d.vehicle |= {"capacity": max(float(d.sites["demand"].max()), d.number(4, 7)), "count": int(d.rng.integers(1, 3))}
    d.vehicle |= {"reloads": (0, 1) if d.chance(0.5) else (1,), "max_reloads": int(d.rng.integers(1, 3)) if d.chance(0.5) else None}


def _closing(d: _Draft) -> None:
    drawn = d.numbers(8, 50, (d.size, d.size))
    d.closing = np.where(d.rng.random((d.size, d.size)) < 0.6, drawn, math.inf)


def _forbidden(d: _Draft) -> None:
    d.forbidden = d.rng.random((d.size, d.size)) < 0.3
    np.fill_diagonal(d.forbidden, False)


def _uncertain(d: _Draft) -> None:
    d.variances = d.numbers(0, 9, (d.size, d.size))


def _risks(d: _Draft) -> float:
    """Uncertain durations, with a limit that they may overrun; a risk of it."""
    if d.variances is None:
        _uncertain(d)
    if "energy" not in d.vehicle:
        d.vehicle.setdefault("max_duration", d.around_times(1.0, 2.2))
    return float(d.rng.choice([0.02, 0.1, 0.3]))


def _set(**changes: Callable[[_Draft], Any]) -> Callable[[_Draft], None]:
    """A change that sets attributes of the first vehicle type."""

    def change(d: _Draft) -> None:
        d.vehicle |= {name: value(d) for name, value in changes.items()}

    return change


CHANGES: dict[str, Callable[[_Draft], None]] = {
    "capacity": _loads,
    "time-windows": _windows,
    "depot-windows": _depot_windows,
    "service-times": lambda d: d.sites.update(service=d.of_customers(1, 5)),
    "demand-or-service-of-depots": lambda d: d.sites.update(service=np.where(d.depot, 2.0, d.sites.get("service", 0.0))),
    "rewards": lambda d: d.sites.update(reward=d.of_customers(0, 20)),
    "optional-sites": _optional,
    "limited-fleet": _set(count=lambda d: int(d.rng.integers(1, 4))),
    "min-vehicles": lambda d: setattr(d, "min_vehicles", min(2, d.customers)),
    "heterogeneous-fleet": lambda d: _second(d, unit_cost=0.5, fixed_cost=d.number(3, 20), count=None if d.chance(0.3) else 1),
    "multiple-depots": lambda d: _second(d, start=1, end=1) if d.chance(0.6) else d.vehicle.update(end=1),
    "open-routes": _set(end=lambda d: 1),
    "max-duration": _set(max_duration=lambda d: d.around_times(0.9, 2.0)),
    "max-distance": _set(max_distance=lambda d: d.around_times(0.9, 2.0)),
    **{f"energy:{charge}": (lambda d, charge=charge: _energy(d, charge)) for charge in ENERGY_CHARGES},  # type: ignore[misc]
    "fixed-cost": _set(fixed_cost=lambda d: d.number(1, 30)),
    "unit-cost": _set(unit_cost=lambda d: float(d.rng.choice([0.5, 1.5, 2.0]))),
    "separate-durations": lambda d: setattr(d, "durations", d.own_matrix()),
    "duration-cost": _set(unit_duration_cost=lambda d: 0.5, unit_cost=lambda d: float(d.rng.integers(0, 2))),
    "overtime": _set(regular_duration=lambda d: d.around_times(0.3, 0.9), unit_overtime_cost=lambda d: 3.0),
    "shifts": _set(shift=lambda d: (d.number(3, 12), d.number(14, 30) + d.around_times(0.5, 1.5))),
    "vehicle-speeds": lambda d: _second(d, speed=2.0) if d.chance(0.6) else d.vehicle.update(speed=0.5),
    "vehicle-travel": lambda d: _second(d, travel=d.own_matrix()) if d.chance(0.7) else d.vehicle.update(travel=d.own_matrix()),
    "several-loads": _several_loads,
    "pickups": _pickups,
    "shipments": _shipments,
    "groups": _groups,
    "several-windows": _several_windows,
    "skills": _skills,
    "penalties": lambda d: d.sites.update(penalty=d.of_customers(0, 30)),
    "reloads": _reloads,
    "recharging": _recharging,
    "initial-energy": _initial,
    "closing-moves": _closing,
    "forbidden-moves": _forbidden,
    "committed-vehicles": lambda d: _second(d, committed=True),
    "uncertain-durations": _uncertain,
    "route-risk": _set(risk=_risks),
    "team-risk": lambda d: setattr(d, "team_risk", _risks(d)),
    **dict.fromkeys(sorted({name for goal in GOALS for name in Objective.of(goal).features()}), lambda d: None),
}  # fmt: skip
"""The change that each feature makes; features of objectives choose among ``GOALS``."""

TURNS = tuple(name for name in CHANGES if name not in RISKS | {"uncertain-durations", "forbidden-moves"})
"""Features that ``drawn`` has in turn, and chooses more from. Risks are ``risky``'s, and moves are forbidden by ``with_features`` alone, so
that problems stay what they were without."""

TWO_DEPOTS = {"multiple-depots", "open-routes", "reloads", "recharging"}

EXCLUSIVE = {name for name in CHANGES if name.startswith("energy:")} | {"recharging", "initial-energy"}
"""A store is charged in one way."""

PAID = {"duration-cost", "overtime", "fixed-cost", "unit-cost"}
"""Features that total cost alone knows."""

NEEDED = {"rewards": "objective:reward", "penalties": "objective:penalties", **dict.fromkeys(PAID, "objective:total-cost")}
"""The term that an objective must hold for a feature to matter, unless another one is asked for."""


def _most(wanted: tuple[str, ...]) -> int:
    """Customers that enumeration is done with in a second: stops at depots multiply the routes, several types of vehicles too."""
    held = set(wanted)
    return 3 if "recharging" in held else 4 if "reloads" in held else 6 if len(held & {"heterogeneous-fleet", "skills"}) else 7


def _goal(d: _Draft) -> Objective:
    needs = {name for name in d.wanted if name.startswith("objective:")} or {NEEDED[name] for name in d.wanted if name in NEEDED}
    able = [goal for goal in map(Objective.of, GOALS) if needs <= goal.features()]
    if not able:
        raise InputError("no objective has all of these")
    if "objective:priorities" not in needs and d.chance(0.7):  # they are many, and would be half of all
        able = [goal for goal in able if len(goal.levels()) == 1] or able
    return able[int(d.rng.integers(len(able)))]


def _chosen(rng: np.random.Generator, number: int) -> tuple[str, ...]:
    names = list(TURNS)
    wanted = [names[number % len(names)]]
    for name in rng.permutation(names)[: int(rng.integers(0, 3))].tolist():
        if name not in wanted and not (name in EXCLUSIVE and EXCLUSIVE & set(wanted)):
            wanted.append(name)
    return tuple(sorted(wanted, key=names.index))


def _made(rng: np.random.Generator, wanted: tuple[str, ...], name: str) -> RoutingProblem:
    shares = np.array(list(CUSTOMERS.values())) / 100.0
    customers = min(int(rng.choice(list(CUSTOMERS), p=shares)), _most(wanted))
    d = _Draft(rng, customers, 2 if TWO_DEPOTS & set(wanted) else 1, wanted, float(rng.choice([1.0, 1.0, 0.1])))
    for feature in wanted:
        CHANGES[feature](d)
    goal = _goal(d)
    held = goal.features()
    if "objective:reward" in held and "reward" not in d.sites:
        CHANGES["rewards"](d)
    if "objective:penalties" in held and "penalty" not in d.sites:
        CHANGES["penalties"](d)
    if held & {"objective:reward", "objective:penalties"} and "optional-sites" not in wanted:
        _optional(d)
    for group in d.sites.get("groups", ()):
        d.sites["required"][list(group.sites)] = False
        d.sites["penalty"] = d.sites.get("penalty", np.zeros(d.size))
        d.sites["penalty"][list(group.sites)] = 0.0
    for shipment in d.sites.get("shipments", ()):
        d.sites["required"][shipment.pickup] = d.sites["required"][shipment.delivery]
    if "count" not in d.vehicle and d.chance(0.4):
        d.vehicle["count"] = int(rng.integers(1, 4))
    travel = replace(d.travel, duration_matrix=d.durations, closing=d.closing, variances=d.variances)
    fleet: list[VehicleType] = []
    for k, changes in enumerate(({}, *d.others)):
        attributes = {"name": f"type-{k + 1}", **d.vehicle, **changes}
        if "travel" in attributes:
            attributes["travel"] = Travel(
                EXPLICIT, matrix=attributes["travel"], closing=d.closing, convention=d.travel.convention, variances=d.variances
            )
        fleet.append(VehicleType(**attributes))
    total = fleet_size(fleet)
    least = d.min_vehicles if total is None else min(d.min_vehicles, total)
    sites = Sites.of(range(d.size), depot=d.depot, coordinates=d.xy, **d.sites)
    return RoutingProblem(sites, travel, fleet, goal, least, name, team_risk=d.team_risk, forbidden=d.forbidden)


def features_of(problem: RoutingProblem) -> frozenset[str]:
    """The features of a problem and of its data; an asymmetric matrix has no name of its own."""
    return problem.features() | features(problem)


def with_features(wanted: Sequence[str], seed: int) -> RoutingProblem | None:
    """A problem drawn for these features; None where they do not go together, or came to nothing in this one."""
    rng = np.random.default_rng([seed, *"".join(wanted).encode()])
    try:
        problem = _made(rng, tuple(wanted), f"{'-'.join(wanted)}-{seed}")
    except InputError:
        return None
    return problem if features_of(problem) >= set(wanted) else None


def drawn(seed: int, number: int) -> RoutingProblem:
    """The problem of that number: the same whatever else is drawn. Each has the feature whose turn it is."""
    rng = np.random.default_rng([seed, number])
    feature = TURNS[number % len(TURNS)]
    for _ in range(200):
        try:
            problem = _made(rng, _chosen(rng, number), f"{feature}-{number}")
        except InputError:  # such as a delivery that would come before its pickup
            continue
        if feature in features_of(problem):
            return problem
    raise AssertionError(f"no problem has {feature}")


def risky(seed: int, number: int) -> RoutingProblem:
    """A problem that is drawn, with uncertain durations and a risk of each route, of the team, or both, from a generator of their own."""
    rng = np.random.default_rng([seed, number, len(TURNS)])
    for further in range(200):
        base = drawn(seed, number + further * 100_003)
        n, unit = len(base.sites), float(rng.choice([1.0, 0.1]))
        variances = np.asarray(rng.integers(0, round(60 / unit), (n, n)) * unit, dtype=np.float64)
        most = float(base.travel.durations.max()) * float(rng.uniform(2.0, 3.5)) + 5.0
        asked = number % 3
        risk, team = (float(rng.choice([0.02, 0.1, 0.3])) for _ in range(2))
        limited = [v if v.energy or math.isfinite(v.max_duration) else replace(v, max_duration=round(most, 1)) for v in base.fleet]
        fleet = [v if asked == 1 else replace(v, risk=risk) for v in limited]
        fleet = [v if v.travel is None else replace(v, travel=replace(v.travel, variances=variances)) for v in fleet]
        try:
            problem = replace(
                base, travel=replace(base.travel, variances=variances), fleet=tuple(fleet), team_risk=None if asked == 0 else team,
                name=f"{base.name}-at-risk",
            )  # fmt: skip
        except InputError:  # somebody may have to wait
            continue
        if problem.features() & RISKS:
            return problem
    raise AssertionError("no problem has a risk")
