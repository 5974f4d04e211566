"""Columns of the three-index form: arcs and times of each vehicle, type by type, and what is written beside them."""

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
from ..preparation import Preparation, prepare, waiting_is_possible
from ._blocks import Blocks
from ._objective import durations_count

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

    def over_arcs(self, name: str, arcs: Ints, value: Floats, lower: float, upper: float, column: int | None = None) -> Rows:
        """One row a vehicle over its arcs, and over -1 times its column from ``column`` on."""
        count, size = self.count, len(arcs)
        if column is None:
            return Rows(
                name, (self.vehicles,), (self.numbers,), indptr=np.arange(count + 1, dtype=np.int32) * size, indices=self.each(arcs),
                data=np.tile(value, count), lower=np.full(count, lower), upper=np.full(count, upper),
            )  # fmt: skip
        row = np.arange(count)
        parts: list[Part] = [(np.repeat(row, size), self.each(arcs), np.tile(value, count)), (row, column + row, -1.0)]
        return rows(name, count, parts, lower, upper, (self.vehicles,), (self.numbers,))

    def inner(self) -> NDArray[np.bool_]:
        """Arcs between two nodes on the way."""
        return np.asarray((self.tail != 0) & (self.head != self.prep.end))


@dataclass(frozen=True, eq=False)
class Drive:
    """What the ``number``-th vehicle of a type drives: nodes, arcs of the preparation, and times at the nodes."""

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
