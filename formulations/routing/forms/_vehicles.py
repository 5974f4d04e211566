"""Columns and rows of the three-index form: arcs and times of each vehicle, type by type, their visits, flow, limits and order of time."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...programs.cones import Cones
from ...programs.program import Floats, Rows, Variables
from ...programs.rows import Ints, Part, rows
from ...tolerance import widened
from ..preparation import SHORT, Preparation, prepare, waiting_is_possible
from ..reachability import minimum_vehicles
from ._objective import durations_count
from ._routes import Blocks

if TYPE_CHECKING:
    from ....instances.routing.vehicle_type import VehicleType
    from ..problem import RoutingProblem


@dataclass(frozen=True, eq=False)
class VehicleColumns:
    """The columns of one vehicle type: x[arc,k] from ``first``, arc by arc, then t[node,k] from ``clock``, node by node.

    ``idle`` is the position of the arc from start to end; ``elapsed`` tells whether the time from departure to return counts;
    ``closing`` holds when each arc must have begun, ``windows`` those of nodes that have several.
    """

    prep: Preparation
    vehicle: VehicleType
    tail: NDArray[np.int32]
    head: NDArray[np.int32]
    idle: int
    vehicles: NDArray[np.int32]
    first: int
    names: list[str]
    numbers: list[str]
    lower: Floats
    upper: Floats
    elapsed: bool
    idle_distance: float
    idle_duration: float
    may_idle: bool
    closing: Floats
    windows: dict[int, tuple[tuple[float, float], ...]]

    @property
    def count(self) -> int:
        return len(self.vehicles)

    @property
    def clock(self) -> int:
        return self.first + len(self.tail) * self.count

    @property
    def end(self) -> int:
        """First column after this type."""
        return self.clock + self.prep.nodes * self.count

    @property
    def committed(self) -> bool:
        return self.vehicle.committed

    def with_idle(self, values: Floats, idle: float = 0.0) -> Floats:
        """Values of arcs, ``idle`` for the idle one, which only committed vehicles drive."""
        return np.insert(values, self.idle, idle if self.committed else 0.0)

    @property
    def arc_of(self) -> NDArray[np.int64]:
        """Position with the idle arc of each arc of the preparation."""
        every = np.arange(len(self.prep.tail))
        return every + (every >= self.idle)

    def each(self, arcs: Ints) -> NDArray[np.int32]:
        """Columns of the given arcs, vehicle by vehicle."""
        base = (self.first + np.asarray(arcs, dtype=np.int32) * self.count).astype(np.int32)
        return (base[None, :] + np.arange(self.count, dtype=np.int32)[:, None]).ravel()

    def together(self, arcs: Ints) -> NDArray[np.int64]:
        """Columns of the given arcs, arc by arc."""
        return (self.first + np.asarray(arcs, dtype=np.int64)[:, None] * self.count + np.arange(self.count)).ravel()

    def along(self, arcs: Ints, value: Floats) -> Part:
        """Entries of one row per vehicle: the values of its arcs."""
        return np.repeat(np.arange(self.count), len(arcs)), self.each(arcs), np.tile(value, self.count)

    def largest_out(self, value: Floats) -> Floats:
        """The largest value of the arcs out of each node: all together they bound what a route adds up."""
        largest = np.zeros(self.prep.nodes)
        np.maximum.at(largest, self.tail, value)
        return largest

    def over_arcs(self, name: str, arcs: Ints, value: Floats, lower: float, upper: float, column: int | None = None) -> Rows:
        """One row per vehicle over its arcs, and over -1 times its column from ``column`` on."""
        count, size = self.count, len(arcs)
        if column is None:
            return Rows(
                name, (self.vehicles,), (self.numbers,), indptr=np.arange(count + 1, dtype=np.int32) * size, indices=self.each(arcs),
                data=np.tile(value, count), lower=np.full(count, lower), upper=np.full(count, upper),
            )  # fmt: skip
        row = np.arange(count)
        parts: list[Part] = [self.along(arcs, value), (row, column + row, -1.0)]
        return rows(name, count, parts, lower, upper, (self.vehicles,), (self.numbers,))

    def inner(self) -> NDArray[np.bool_]:
        """Arcs between two nodes on the way."""
        return np.asarray((self.tail != 0) & (self.head != self.prep.end))


@dataclass(frozen=True, eq=False)
class Drive:
    """The route of the ``number``-th vehicle of a type as nodes, arcs of the preparation, and times at the nodes."""

    kind: VehicleColumns
    number: int
    nodes: NDArray[np.int64]
    arcs: NDArray[np.int64]
    clock: Floats


class VehicleBlocks(Blocks):
    """Columns and rows of a program, block after block, and how an answer fills what is beside arcs and times."""

    def __init__(self, problem: RoutingProblem, types: Sequence[VehicleColumns]) -> None:
        super().__init__(problem)
        self.types = types
        self.nodes = types[0].prep.nodes - 2
        self.names = types[0].names
        self.cones: list[Cones] = []
        self.columns = types[-1].end
        self.encoders: list[Callable[[Floats, list[Drive]], None]] = []

    def visits(self, nodes: Ints, types: Sequence[VehicleColumns] | None = None) -> list[Part]:
        """Entries of one row for each of ``nodes``: all arcs of ``types`` that leave it."""
        place = np.full(self.nodes + 2, -1)
        place[nodes] = np.arange(len(nodes))
        parts: list[Part] = []
        for kind in self.types if types is None else types:
            arcs = np.nonzero((place[kind.tail] >= 0) & (kind.tail != 0))[0]
            parts.append((np.repeat(place[kind.tail[arcs]], kind.count), kind.together(arcs), 1.0))
        return parts

    def united(self, chosen: Sequence[tuple[VehicleColumns, Ints]]) -> tuple[Ints, Ints, Ints, Ints]:
        """Tail and head of each move that is among the ``chosen`` arcs of a type, and row and column of every vehicle's variable."""
        width = self.nodes + 2
        keys = [kind.tail[arcs].astype(np.int64) * width + kind.head[arcs] for kind, arcs in chosen]
        moves = np.unique(np.concatenate(keys))
        row = np.concatenate([np.repeat(np.searchsorted(moves, key), kind.count) for key, (kind, _) in zip(keys, chosen, strict=True)])
        column = np.concatenate([kind.together(arcs) for kind, arcs in chosen])
        return moves // width, moves % width, row, column


def vehicle_columns(problem: RoutingProblem, number: int, first: int, before: int) -> VehicleColumns:
    """The columns of type ``number``, from column ``first`` on, after ``before`` vehicles of other types."""
    prep, vehicle = prepare(problem, number), problem.fleet[number]
    idle = int(np.searchsorted(prep.tail, 1))
    charge = vehicle.energy
    elapsed = math.isfinite(vehicle.max_duration) or (charge is not None and charge.charge == "elapsed")
    elapsed = elapsed or (durations_count(problem, vehicle) and waiting_is_possible(problem))
    lower, upper = prep.time.lower.copy(), prep.time.upper.copy()
    travel, ends = problem.travel_of(number), (np.array([vehicle.start]), np.array([vehicle.end]))
    distance, duration = float(travel.distance(*ends)[0]), float(travel.duration(*ends)[0])
    if elapsed or vehicle.committed:  # an idle vehicle returns when it departs
        lower[-1] = lower[0]
    tail, head = np.insert(prep.tail, idle, 0), np.insert(prep.head, idle, prep.end)
    sites = prep.sites
    closing = np.full(len(tail), math.inf) if travel.closing is None else np.asarray(travel.closing[sites[tail], sites[head]])
    may_idle = not vehicle.committed or _may_go_home(problem, vehicle, float(lower[0]), distance, duration, float(closing[idle]))
    if vehicle.committed and may_idle:
        upper[-1] = max(upper[-1], lower[0] + duration)
    several = {k: problem.sites.windows[s] for k, s in enumerate(sites.tolist()) if problem.sites.windows and problem.sites.windows[s]}
    return VehicleColumns(
        prep, vehicle, tail, head, idle, np.arange(before, before + prep.fleet, dtype=np.int32), first,
        _node_names(problem, prep), [str(k + 1) for k in range(before + prep.fleet)], lower, upper, elapsed,
        distance, duration, may_idle, closing, several,
    )  # fmt: skip


def _node_names(problem: RoutingProblem, prep: Preparation) -> list[str]:
    """Ids of sites; copies of depots are numbered."""
    ids, n, taken = problem.sites.ids, len(problem.customers), dict[int, int]()
    names = []
    for node, site in enumerate(prep.sites.tolist()):
        copy = n < node < prep.end
        taken[site] = taken.get(site, 0) + copy
        names.append(f"{ids[site]}#{taken[site]}" if copy else ids[site])
    return names


def _may_go_home(problem: RoutingProblem, vehicle: VehicleType, opens: float, distance: float, duration: float, closing: float) -> bool:
    """Whether a committed vehicle can keep its limits on the way straight from its start to its end."""
    limits = [(opens + duration, min(float(problem.sites.due[vehicle.end]), vehicle.shift[1])), (opens, closing)]
    limits += [(distance, vehicle.max_distance), (duration, vehicle.max_duration)]
    if vehicle.energy is not None:
        limits.append((vehicle.energy.rate * duration, vehicle.energy.at_departure))
    return all(value <= widened(limit) for value, limit in limits)


def arc_and_time_columns(kind: VehicleColumns, idle_cost: float) -> list[Variables]:
    """Blocks x, departure, t and return."""
    count, names, nodes = kind.count, kind.names, kind.prep.nodes
    arcs = len(kind.tail)
    node = np.arange(nodes, dtype=np.int32)
    variables = [
        Variables(
            "x", (np.repeat(kind.tail, count), np.repeat(kind.head, count), np.tile(kind.vehicles, arcs)), (names, names, kind.numbers),
            lower=np.zeros(arcs * count), upper=_numbered(kind).ravel(),
            cost=np.repeat(kind.with_idle(kind.prep.cost, idle_cost), count), integer=True,
        )
    ]  # fmt: skip
    for name, at in {"departure": node[:1], "t": node[1:-1], "return": node[-1:]}.items():
        keys: tuple[Ints, ...] = (np.repeat(at, count), np.tile(kind.vehicles, len(at)))
        labels: tuple[Any, ...] = (names, kind.numbers)
        if name != "t":
            keys, labels = keys[1:], labels[1:]
        variables.append(
            Variables(
                name, keys, labels, lower=np.repeat(kind.lower[at], count), upper=np.repeat(kind.upper[at], count),
                cost=np.zeros(len(at) * count),
            )
        )  # fmt: skip
    return variables


def _numbered(kind: VehicleColumns) -> Floats:
    """Upper bounds of x, shape (arcs, vehicles): 0 where a vehicle would visit a customer before its own number."""
    most = kind.prep.nodes + kind.count
    lowest = np.minimum(np.where(kind.tail == 0, most, kind.tail), np.where(kind.head == kind.prep.end, most, kind.head))
    upper = (lowest[:, None] > np.arange(kind.count)).astype(np.float64)
    upper[kind.idle] = float(kind.may_idle)
    return upper


def visits_rows(types: list[VehicleColumns]) -> Rows:
    """Arcs are in order of their tails, so that each type's columns of a customer are a range."""
    prep = types[0].prep
    n = prep.customers
    parts: list[Any] = []
    for kind in types:
        count = kind.count
        columns = np.arange(kind.first + (kind.idle + 1) * count, kind.clock, dtype=np.int32)
        parts.append((np.repeat(kind.tail[kind.idle + 1 :] - 1, count), columns))
    sizes = [np.bincount(row, minlength=n) for row, _ in parts]
    columns = parts[0][1]
    if len(parts) > 1:
        order = np.argsort(np.concatenate([row for row, _ in parts]), kind="stable")
        columns = np.concatenate([c for _, c in parts])[order]
    least = np.where(prep.required[1:-1], 1.0, 0.0)
    return Rows(
        "visit", (np.arange(1, n + 1),), (types[0].names,), indptr=_starts(sum(sizes)), indices=columns, data=np.ones(len(columns)),
        lower=least, upper=np.ones(n),
    )  # fmt: skip


def fleet_rows(problem: RoutingProblem, types: list[VehicleColumns]) -> Rows:
    columns = np.concatenate([kind.each(np.arange(kind.idle)) for kind in types])
    least = minimum_vehicles(problem)
    size = int(least > 0)
    return rows("fleet", size, [(np.zeros(len(columns), dtype=np.int64), columns, 1.0)] if size else [], lower=float(least))


def connecting_rows(kind: VehicleColumns) -> list[Rows]:
    """Rows of single vehicles: departure and flow."""
    return [kind.over_arcs("depart", np.arange(kind.idle + 1), np.ones(kind.idle + 1), 1.0, 1.0), _flow(kind)]


def limits_rows(problem: RoutingProblem, kind: VehicleColumns) -> list[Rows]:
    """Rows of single vehicles: loads, distance, duration and energy."""
    prep, vehicle = kind.prep, kind.vehicle
    every, inner = np.arange(len(kind.tail)), np.arange(kind.idle + 1, len(kind.tail))
    blocks: list[Rows] = []
    for name, resource in prep.resources.items():
        if name.startswith(("load", "pickup")):
            capacity = vehicle.capacities[int(name.partition("-")[2] or 1) - 1]
            blocks.append(kind.over_arcs(name, inner, _at_head(kind, resource.weight)[kind.tail[inner]], -math.inf, capacity))
    if "distance" in prep.resources:
        blocks.append(kind.over_arcs("distance", every, kind.with_idle(prep.distance, kind.idle_distance), -math.inf, vehicle.max_distance))
    if math.isfinite(vehicle.max_duration):
        blocks.append(_elapsed(kind, "duration", 1.0, vehicle.max_duration))
    energy = vehicle.energy
    if energy is not None and energy.charge == "elapsed":
        blocks.append(_elapsed(kind, "energy", energy.rate, energy.at_departure))
    elif energy is not None and "energy" in prep.resources:
        weight = kind.with_idle(prep.resources["energy"].weight, energy.rate * kind.idle_duration)
        blocks.append(kind.over_arcs("energy", every, weight, -math.inf, energy.at_departure))
    if vehicle.max_reloads is not None:
        into = np.nonzero(np.isin(prep.sites[kind.head], vehicle.reloads) & (kind.head != prep.end))[0]
        blocks.append(kind.over_arcs("reloads", into, np.ones(len(into)), -math.inf, float(vehicle.max_reloads)))
    if (vehicle.reloads or vehicle.stations) and len(every) > 1:
        # Who only stops at depots serves no site.
        served = np.nonzero((kind.tail >= 1) & (kind.tail <= len(problem.customers)))[0]
        arcs = np.append(served, kind.idle)
        blocks.append(kind.over_arcs("serves", arcs, np.ones(len(arcs)), 1.0, math.inf))
    return blocks


def _at_head(kind: VehicleColumns, weight: Floats) -> Floats:
    """A weight of arcs that depends on the head alone, by node."""
    weights = np.zeros(kind.prep.nodes)
    weights[kind.prep.head] = weight
    weights[-1] = 0.0
    return weights


def _elapsed(kind: VehicleColumns, name: str, rate: float, limit: float) -> Rows:
    """Time from departure to return, times ``rate``, within ``limit``."""
    count = kind.count
    row, last = np.arange(count), kind.prep.end * count
    parts: list[Part] = [(row, kind.clock + last + row, rate), (row, kind.clock + row, -rate)]
    return rows(name, count, parts, upper=limit, keys=(kind.vehicles,), labels=(kind.numbers,))


def _flow(kind: VehicleColumns) -> Rows:
    """Arcs into a customer less arcs out of it, vehicle by vehicle."""
    n, count = kind.prep.customers, len(kind.vehicles)
    entering = np.nonzero(kind.head != kind.prep.end)[0]
    leaving = np.arange(kind.idle + 1, len(kind.tail))
    at = np.concatenate([kind.head[entering], kind.tail[leaving]])
    order = np.argsort(at, kind="stable")
    arcs = np.concatenate([entering, leaving])[order]
    sign = np.where(order < len(entering), 1.0, -1.0)
    sizes = np.bincount(at, minlength=n + 1)[1:]
    return Rows(
        "flow", (np.tile(np.arange(1, n + 1, dtype=np.int32), count), np.repeat(kind.vehicles, n)), (kind.names, kind.numbers),
        indptr=_starts(np.tile(sizes, count)), indices=kind.each(arcs), data=np.tile(sign, count),
        lower=np.zeros(n * count), upper=np.zeros(n * count),
    )  # fmt: skip


def time_rows(kind: VehicleColumns) -> Rows:
    """t_i - t_j + M x <= M - s_i - d_ij, three entries per row."""
    count = kind.count
    tail, head, weight = kind.tail, kind.head, kind.with_idle(kind.prep.time.weight, kind.idle_duration)
    big = kind.upper[tail] + weight - kind.lower[head]
    if not kind.committed:
        big[kind.idle] = 0.0
    arcs = np.nonzero(big > 0)[0].astype(np.int32)
    i, j, big = tail[arcs], head[arcs], big[arcs]
    k = np.arange(count, dtype=np.int32)
    columns = np.empty((len(arcs), count, 3), dtype=np.int32)
    for place, base in enumerate((kind.clock + i * count, kind.clock + j * count, kind.first + arcs * count)):
        np.add(base[:, None], k, out=columns[:, :, place])
    data = np.empty((len(arcs), count, 3))
    data[:, :, 0], data[:, :, 1], data[:, :, 2] = 1.0, -1.0, big[:, None]
    size = len(arcs) * count
    return Rows(
        "time", (np.repeat(i, count), np.repeat(j, count), np.tile(kind.vehicles, len(arcs))), (kind.names, kind.names, kind.numbers),
        indptr=np.arange(0, 3 * size + 1, 3, dtype=np.int32), indices=columns.ravel(), data=data.ravel(),
        lower=np.full(size, -math.inf), upper=np.repeat(big - weight[arcs], count),
    )  # fmt: skip


def closing_rows(kind: VehicleColumns) -> Rows:
    """t_i + (b_i + s_i - closing_ij) x_ijk <= b_i, so that nobody begins a move that is closed."""
    count, service = kind.count, kind.prep.service
    over = kind.upper[kind.tail] + service[kind.tail] - kind.closing
    arcs = np.nonzero((over > 0) & np.isfinite(kind.closing))[0]
    if not kind.committed:
        arcs = arcs[arcs != kind.idle]
    i, row = np.repeat(kind.tail[arcs], count), np.arange(len(arcs) * count)
    number = np.tile(np.arange(count), len(arcs))
    parts: list[Part] = [(row, kind.clock + i * count + number, 1.0), (row, kind.together(arcs), np.repeat(over[arcs], count))]
    keys = (i, np.repeat(kind.head[arcs], count), np.tile(kind.vehicles, len(arcs)))
    return rows("closing", len(row), parts, upper=kind.upper[i], keys=keys, labels=(kind.names, kind.names, kind.numbers))


def order_rows(kind: VehicleColumns, first: int, every: bool) -> Rows:
    """Visit numbers that grow along ``every`` arc, or those of (almost) no duration; ``first`` is the column of the first node's."""
    n, count = kind.prep.customers, kind.count
    short = kind.with_idle(kind.prep.time.weight) <= SHORT * kind.prep.time.size
    arcs = np.nonzero(kind.inner() & (every | short))[0]
    i, j = np.repeat(kind.tail[arcs], count), np.repeat(kind.head[arcs], count)
    row = np.arange(len(i))
    parts: list[Part] = [(row, first + i - 1, 1.0), (row, first + j - 1, -1.0), (row, kind.together(arcs), float(n))]
    keys = (i, j, np.tile(kind.vehicles, len(arcs)))
    return rows("order", len(row), parts, upper=n - 1.0, keys=keys, labels=(kind.names, kind.names, kind.numbers))


def _starts(sizes: Any) -> NDArray[np.int32]:
    starts = np.zeros(len(sizes) + 1, dtype=np.int32)
    np.cumsum(sizes, out=starts[1:])
    return starts
