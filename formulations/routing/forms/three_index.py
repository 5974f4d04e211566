"""The three-index form: one binary variable for each arc and vehicle, so that every vehicle may be of its own kind.

For each vehicle k with its arcs A_k (those that some route of its type can use, and the idle arc (o,g) from start to end)::

    min/max  sum_k sum_{(i,j) in A_k} c_ij x_ijk,   x binary
    visit[i]       sum_k sum_j x_ijk = 1                                  required customers i (<= 1 for optional ones)
    depart[k]      sum_j x_ojk = 1                                        each k; an idle vehicle uses (o,g)
    flow[h,k]      sum_i x_ihk = sum_j x_hjk                              customers h, each k; with depart it implies the return
    fleet          sum_k sum_{j != g} x_ojk >= K_min                      K_min from ``minimum_vehicles``
    load[k]        sum_{(i,j)} q_i x_ijk <= Q_k
    time[i,j,k]    t_ik - t_jk + M_ij x_ijk <= M_ij - s_i - d_ij          (i,j) in A_k but (o,g);   a_i <= t_ik <= b_i
                   M_ij = b_i + s_i + d_ij - a_j;  rows with M_ij <= 0 always hold and are dropped
    distance[k]    sum distance_ij x_ijk <= max_distance
    duration[k]    return_k - departure_k <= max_duration
    energy[k]      ``travel``   rate sum d_ij x_ijk                           <= capacity
                   ``windows``  rate sum max(s_i + d_ij, a_j - a_i) x_ijk     <= capacity   (a as given, s_i + d_ig on return)
                   ``elapsed``  rate (return_k - departure_k)                 <= capacity
                   ``elapsed-fixed-start`` is the due time a_o + capacity / rate of the return
    order[i,j,k]   u_i - u_j + n x_ijk <= n - 1,  1 <= u_i <= n           only where cycles of (almost) no duration are left

Here t_ok is departure_k and t_gk is return_k; departure is free within the depot's window, s_i is the service at i (0 at a
depot), and [a_i, b_i] is the window tightened by ``prepare``. The time rows exclude cycles without the depot wherever durations are
positive. One t_i for all vehicles would do where no type has windows of its own; it has fewer rows, and HiGHS was no faster with it.

Vehicles of one type are alike, so they may be numbered by the first customer (in site order) that each visits, idle ones last: then
the k-th visits none before the k-th, and x_ijk is fixed to 0 where i or j is a customer before the k-th of the type. With HiGHS and
the first 15 or 25 customers of Solomon's files this was 2 to 12 times faster on C101, R101 and RC106, made no clear difference on
C103 and RC104, and left a weaker bound on RC101. Rows that put idle vehicles last did not help.

Source: Mitchell (2020), CMU-RI-TR-20-52, (3.7)-(3.14), with demands and service times; corrected as in docs/formulations/routing.md#errata.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Floats, Program, Rows, Variables
from ...programs.reductions.units import scaled
from ...programs.rows import Ints, rows
from ..preparation import SHORT, Preparation, leaves_cycles, prepare
from ..reachability import minimum_vehicles
from ..routes import Route, Routes
from ._routes import ArcIndex, levels, routes_of, used

if TYPE_CHECKING:
    from ..problem import RoutingProblem

FEATURES = frozenset(
    {
        "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "energy:travel", "energy:elapsed",
        "energy:elapsed-fixed-start", "energy:windows", "optional-sites", "limited-fleet", "min-vehicles", "heterogeneous-fleet",
        "multiple-depots", "open-routes", "fixed-cost", "separate-durations", "objective:total-cost", "objective:vehicles",
        "objective:reward", "objective:weights",
    }
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Type:
    """The columns of one vehicle type: x[arc,k] from ``first``, arc by arc, then t[node,k] from ``clock``, node by node."""

    prep: Preparation
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

    @property
    def clock(self) -> int:
        return self.first + len(self.tail) * len(self.vehicles)

    @property
    def end(self) -> int:
        """First column after this type."""
        return self.clock + self.prep.nodes * len(self.vehicles)

    def with_idle(self, values: Floats) -> Floats:
        """Values of arcs, 0 for the idle one."""
        return np.insert(values, self.idle, 0.0)

    @property
    def arc_of(self) -> NDArray[np.int64]:
        """Position with the idle arc of each arc of the preparation."""
        every = np.arange(len(self.prep.tail))
        return every + (every >= self.idle)


def build(problem: RoutingProblem) -> Compiled:
    """The program of the three-index form; see the module's text for its mathematics.

    Parameters
    ----------
    problem : RoutingProblem
        An unlimited type counts as one vehicle a customer.
    """
    types: list[_Type] = []
    first = vehicle = 0
    for number in range(len(problem.fleet)):
        made = _type(problem, number, first, vehicle)
        types.append(made)
        first, vehicle = made.end, vehicle + made.prep.fleet
    variables = [block for kind in types for block in _columns(kind)]
    blocks = [_visits(problem, types), _fleet(problem, types)]
    for kind in types:
        blocks.extend(_limits(problem, kind))
        blocks.append(_time(kind))
    orders = [leaves_cycles(kind.prep, [kind.prep.time]) for kind in types]
    if any(orders):
        n = len(problem.customers)
        customers = np.arange(1, n + 1)
        variables.append(Variables("u", (customers,), (types[0].names,), lower=np.ones(n), upper=np.full(n, float(n)), cost=np.zeros(n)))
        blocks.extend(_order(kind, first) for kind, cyclic in zip(types, orders, strict=True) if cyclic)
        first += n
    bare = Program("three-index", problem.sense, tuple(variables), tuple(b for b in blocks if b.size), offset=problem.constant)
    return Compiled(bare, problem, partial(_decode, problem, types), partial(_encode, problem, types, bare))


# -- columns ---------------------------------------------------------------------------------------------------------


def _type(problem: RoutingProblem, kind: int, first: int, vehicle: int) -> _Type:
    prep = prepare(problem, kind)
    idle = int(np.searchsorted(prep.tail, 1))
    charge = problem.fleet[kind].energy
    elapsed = math.isfinite(problem.fleet[kind].max_duration) or (charge is not None and charge.charge == "elapsed")
    lower, upper = prep.time.lower.copy(), prep.time.upper
    if elapsed:  # an idle vehicle returns when it departs
        lower[-1] = lower[0]
    names = [problem.sites.ids[s] for s in prep.sites]
    numbers = [str(k + 1) for k in range(vehicle + prep.fleet)]
    vehicles = np.arange(vehicle, vehicle + prep.fleet, dtype=np.int32)
    tail, head = np.insert(prep.tail, idle, 0), np.insert(prep.head, idle, prep.end)
    return _Type(prep, tail, head, idle, vehicles, first, names, numbers, lower, upper, elapsed)


def _columns(kind: _Type) -> list[Variables]:
    count, names = len(kind.vehicles), kind.names
    arcs, nodes = len(kind.tail), kind.prep.nodes
    size = arcs * count
    node = np.arange(nodes, dtype=np.int32)
    clock = {"departure": node[:1], "t": node[1:-1], "return": node[-1:]}
    made = [
        Variables(
            "x", (np.repeat(kind.tail, count), np.repeat(kind.head, count), np.tile(kind.vehicles, arcs)), (names, names, kind.numbers),
            lower=np.zeros(size), upper=_numbered(kind).ravel(), cost=np.repeat(kind.with_idle(kind.prep.cost), count), integer=True,
        )
    ]  # fmt: skip
    for name, at in clock.items():
        keys: tuple[Ints, ...] = (np.repeat(at, count), np.tile(kind.vehicles, len(at)))
        labels: tuple[Any, ...] = (names, kind.numbers)
        if name != "t":
            keys, labels = keys[1:], labels[1:]
        made.append(
            Variables(
                name, keys, labels, lower=np.repeat(kind.lower[at], count), upper=np.repeat(kind.upper[at], count),
                cost=np.zeros(len(at) * count),
            )
        )  # fmt: skip
    return made


def _numbered(kind: _Type) -> Floats:
    """Upper bounds of x, shape (arcs, vehicles): 0 where a vehicle would visit a customer before its own number."""
    most = kind.prep.nodes
    lowest = np.minimum(np.where(kind.tail == 0, most, kind.tail), np.where(kind.head == kind.prep.end, most, kind.head))
    return (lowest[:, None] > np.arange(len(kind.vehicles))).astype(np.float64)


# -- rows ------------------------------------------------------------------------------------------------------------


def _each(kind: _Type, arcs: Ints) -> NDArray[np.int32]:
    """Columns of the given arcs, vehicle by vehicle."""
    count = len(kind.vehicles)
    base = (kind.first + np.asarray(arcs, dtype=np.int32) * count).astype(np.int32)
    return (base[None, :] + np.arange(count, dtype=np.int32)[:, None]).ravel()


def _visits(problem: RoutingProblem, types: list[_Type]) -> Rows:
    """Arcs are in order of their tails, so that each type's columns of a customer are a range."""
    n = len(problem.customers)
    parts: list[Any] = []
    for kind in types:
        count = len(kind.vehicles)
        columns = np.arange(kind.first + (kind.idle + 1) * count, kind.clock, dtype=np.int32)
        parts.append((np.repeat(kind.tail[kind.idle + 1 :] - 1, count), columns))
    sizes = [np.bincount(row, minlength=n) for row, _ in parts]
    columns = parts[0][1]
    if len(parts) > 1:
        order = np.argsort(np.concatenate([row for row, _ in parts]), kind="stable")
        columns = np.concatenate([c for _, c in parts])[order]
    least = np.where(problem.sites.required[problem.customers], 1.0, 0.0)
    return Rows(
        "visit", (np.arange(1, n + 1),), (types[0].names,), indptr=_starts(sum(sizes)), indices=columns, data=np.ones(len(columns)),
        lower=least, upper=np.ones(n),
    )  # fmt: skip


def _fleet(problem: RoutingProblem, types: list[_Type]) -> Rows:
    columns = np.concatenate([_each(kind, np.arange(kind.idle)) for kind in types])
    least = minimum_vehicles(problem)
    size = int(least > 0)
    return rows("fleet", size, [(np.zeros(len(columns), dtype=np.int64), columns, 1.0)] if size else [], lower=float(least))


def _limits(problem: RoutingProblem, kind: _Type) -> list[Rows]:
    """Rows of single vehicles: departure, flow, load, distance, duration and energy."""
    prep, count, vehicle = kind.prep, len(kind.vehicles), problem.fleet[kind.prep.vehicle]
    keys, labels = (kind.vehicles,), (kind.numbers,)

    def over_arcs(name: str, arcs: Ints, value: Floats, lower: float, upper: float) -> Rows:
        starts = np.arange(0, (count + 1) * len(arcs), max(1, len(arcs)), dtype=np.int32) if len(arcs) else np.zeros(count + 1, np.int32)
        return Rows(
            name, keys, labels, indptr=starts, indices=_each(kind, arcs), data=np.tile(value, count),
            lower=np.full(count, lower), upper=np.full(count, upper),
        )  # fmt: skip

    every, inner = np.arange(len(kind.tail)), np.arange(kind.idle + 1, len(kind.tail))
    made = [over_arcs("depart", every[: kind.idle + 1], np.ones(kind.idle + 1), 1.0, 1.0), _flow(kind)]
    if "load" in prep.resources:
        made.append(over_arcs("load", inner, prep.demand[kind.tail[inner]], -math.inf, vehicle.capacity))
    if "distance" in prep.resources:
        made.append(over_arcs("distance", every, kind.with_idle(prep.distance), -math.inf, vehicle.max_distance))
    if math.isfinite(vehicle.max_duration):
        made.append(_elapsed(kind, "duration", 1.0, vehicle.max_duration))
    energy = vehicle.energy
    if energy is not None and energy.charge == "elapsed":
        made.append(_elapsed(kind, "energy", energy.rate, energy.capacity))
    elif energy is not None and "energy" in prep.resources:
        made.append(over_arcs("energy", every, kind.with_idle(prep.resources["energy"].weight), -math.inf, energy.capacity))
    return made


def _elapsed(kind: _Type, name: str, rate: float, limit: float) -> Rows:
    """Time from departure to return, times ``rate``, within ``limit``."""
    count = len(kind.vehicles)
    row, last = np.arange(count), kind.prep.end * count
    parts = [(row, kind.clock + last + row, rate), (row, kind.clock + row, -rate)]
    return rows(name, count, parts, upper=limit, keys=(kind.vehicles,), labels=(kind.numbers,))


def _flow(kind: _Type) -> Rows:
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
        indptr=_starts(np.tile(sizes, count)), indices=_each(kind, arcs), data=np.tile(sign, count),
        lower=np.zeros(n * count), upper=np.zeros(n * count),
    )  # fmt: skip


def _time(kind: _Type) -> Rows:
    """t_i - t_j + M x <= M - s_i - d_ij, three entries a row."""
    count = len(kind.vehicles)
    tail, head, weight = kind.tail, kind.head, kind.with_idle(kind.prep.time.weight)
    big = kind.upper[tail] + weight - kind.lower[head]
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


def _order(kind: _Type, first: int) -> Rows:
    """Visit numbers that grow along arcs of (almost) no duration; ``first`` is the column of the first customer's number."""
    n, count = kind.prep.customers, len(kind.vehicles)
    short = (kind.tail != 0) & (kind.head != kind.prep.end) & (kind.with_idle(kind.prep.time.weight) <= SHORT * kind.prep.time.size)
    arcs = np.nonzero(short)[0]
    i, j = np.repeat(kind.tail[arcs], count), np.repeat(kind.head[arcs], count)
    row = np.arange(len(i))
    x = (kind.first + arcs[:, None] * count + np.arange(count)).ravel()
    parts = [(row, first + i - 1, 1.0), (row, first + j - 1, -1.0), (row, x, float(n))]
    keys = (i, j, np.tile(kind.vehicles, len(arcs)))
    return rows("order", len(row), parts, upper=n - 1.0, keys=keys, labels=(kind.names, kind.names, kind.numbers))


def _starts(sizes: Any) -> NDArray[np.int32]:
    made = np.zeros(len(sizes) + 1, dtype=np.int32)
    np.cumsum(sizes, out=made[1:])
    return made


# -- answers ---------------------------------------------------------------------------------------------------------


def _decode(problem: RoutingProblem, types: list[_Type], x: Floats) -> Routes:
    routes: list[Route] = []
    for kind in types:
        chosen = used(x[kind.first : kind.clock]).reshape(len(kind.tail), len(kind.vehicles))
        chosen[kind.idle] = False
        back = np.delete(np.arange(len(kind.tail)), kind.idle)
        for k in np.nonzero(chosen.any(axis=0))[0]:
            routes.extend(routes_of(kind.prep, np.nonzero(chosen[back, k])[0], problem.sites.ids))
    return Routes(tuple(routes))


def _encode(problem: RoutingProblem, types: list[_Type], program: Program, answer: Routes) -> Floats:
    x = program.lower.copy()
    x[types[-1].end :] = 1.0
    taken = [0] * len(types)
    for kind in types:
        x[kind.first + kind.idle * len(kind.vehicles) + np.arange(len(kind.vehicles))] = 1.0
    by_first_customer = sorted(answer, key=lambda route: min(route.visits, default=0))
    for route in by_first_customer:
        if not 0 <= route.vehicle < len(types):
            raise InputError(f"a route uses vehicle type {route.vehicle}, which does not exist")
        kind = types[route.vehicle]
        index, count, k = ArcIndex(kind.prep), len(kind.vehicles), taken[route.vehicle]
        if k >= count:
            raise InputError(f"the answer uses more than the {count} vehicles of type {problem.fleet[route.vehicle].name}")
        taken[route.vehicle] += 1
        nodes = index.nodes_of(route, problem.sites.ids)
        arcs = index.arcs_of(nodes, problem.sites.ids)
        x[kind.first + kind.idle * count + k] = 0.0
        x[kind.first + kind.arc_of[arcs] * count + k] = 1.0
        x[kind.clock + nodes * count + k] = _clock(kind, nodes, arcs)
        if len(x) > types[-1].end:
            x[types[-1].end + nodes[1:-1] - 1] = np.arange(1.0, len(nodes) - 1)
    excess = scaled(program).residual(x)
    if excess > 1e-5:
        raise InputError("the answer is no point of the program", found=f"a row exceeded by {excess:g}")
    return x


def _clock(kind: _Type, nodes: NDArray[np.int64], arcs: NDArray[np.int64]) -> Floats:
    """Earliest times; where the time from departure to return counts, for the latest departure that delays no return."""
    time = kind.prep.time
    earliest = levels(time, nodes, arcs)
    if not kind.elapsed:
        return earliest
    latest = earliest[-1]
    for node, arc in zip(nodes[-2::-1].tolist(), arcs[::-1].tolist(), strict=True):
        latest = min(float(time.upper[node]), latest - float(time.weight[arc]))
    return levels(time, nodes, arcs, max(earliest[0], latest))


FORMS.add("three-index", Form("three-index", "routing", FEATURES, build, order=4))
