"""The three-index form: one binary variable for each arc and vehicle, so that every vehicle may be of its own kind.

The rows of single vehicles are in docs/formulations/routing.md#three-index-form. Beside them::

    closing[i,j,k] t_ik + (b_i + s_i - e_ij) x_ijk <= b_i                 moves that must have begun by e_ij
    reloads[k]     sum of x_ijk into depots where k reloads <= max_reloads
    serves[k]      sum over customers i of sum_j x_ijk + x_ogk >= 1       nobody drives only to stop at depots

and the terms of ``_objective``, groups, shipments and several windows of ``_groups_and_windows``, loads that rise and fall and residual
energy of ``_loads_and_energy``. Depots where vehicles reload or recharge are nodes like customers, as many copies of each as an answer
may need (``copies``). A committed vehicle that serves nobody drives the idle arc (o,g), at its cost and within its limits.

Departure is free within the depot's window and the vehicle's shift, and [a_i, b_i] is the window tightened by ``prepare``. One t_i for
all vehicles would do where no type has windows of its own; it has fewer rows, and HiGHS was no faster with it. The numbering of vehicles
of one type made HiGHS 2 to 12 times faster on the first 15 or 25 customers of Solomon's C101, R101 and RC106, no clear difference on C103
and RC104, and left a weaker bound on RC101. Rows that put idle vehicles last did not help.

Source: Mitchell (2020), CMU-RI-TR-20-52, (3.7)-(3.14), with demands and service times, (5.16) and (5.17)-(5.18); corrected as in
docs/formulations/routing.md#errata.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...forms import FORMS, Form
from ...programs.circuits import Circuit
from ...programs.compiled import Compiled
from ...programs.program import Floats, Program
from ..preparation import leaves_cycles, offset
from ..problem import RoutingProblem
from ..routes import Route, Routes
from . import _sizes
from ._groups_and_windows import add_copies, add_groups, add_shipments, add_windows
from ._loads_and_energy import add_loads, add_residual_energy
from ._objective import add_objective, adverse, idle_cost, weights
from ._routes import ArcIndex, point_of, routes_of, used, with_levels
from ._vehicles import (
    Drive,
    VehicleBlocks,
    VehicleColumns,
    arc_and_time_columns,
    closing_rows,
    connecting_rows,
    fleet_rows,
    limits_rows,
    order_rows,
    time_rows,
    vehicle_columns,
    visits_rows,
)

FEATURES = frozenset(
    {
        "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "energy:travel", "energy:elapsed",
        "energy:elapsed-fixed-start", "energy:windows", "optional-sites", "limited-fleet", "min-vehicles", "heterogeneous-fleet",
        "multiple-depots", "open-routes", "fixed-cost", "separate-durations", "duration-cost", "overtime", "shifts", "vehicle-speeds",
        "vehicle-travel", "several-loads", "pickups", "shipments", "groups", "several-windows", "skills", "reloads", "recharging",
        "initial-energy", "closing-moves", "forbidden-moves", "committed-vehicles",
        "objective:total-cost", "objective:vehicles", "objective:reward",
        "objective:makespan", "objective:longest-route", "objective:total-duration", "objective:latest-return", "objective:penalties",
        "objective:weights", "objective:priorities",
    }
)  # fmt: skip


def refuses(problem: RoutingProblem) -> frozenset[str]:
    """Maxima that should be large; and several windows where both the earliest return and the shortest duration count.

    The latter may need two schedules of one route, and the form writes one.
    """
    features = adverse(problem)
    if "several-windows" in problem.features():
        terms, present = weights(problem).keys(), problem.features()
        early = "latest-return" in terms or "energy:elapsed-fixed-start" in present
        shortest = {"makespan", "total-duration"} & terms or present & {"max-duration", "energy:elapsed", "duration-cost", "overtime"}
        if early and shortest:
            features |= {"several-windows"}
    return features


def build(problem: RoutingProblem) -> Compiled:
    """The program of the three-index form; an unlimited type counts as one vehicle per customer."""
    return with_levels(problem, partial(written, form="three-index"))


def written(
    problem: RoutingProblem,
    form: str,
    connect: Callable[[VehicleBlocks], tuple[Circuit, ...]] | None = None,
    further: Sequence[Callable[[VehicleBlocks], None]] = (),
) -> Compiled:
    """The program for the first level of the objective.

    ``connect`` makes routes of arcs in place of rows of departure, flow and order, ``further`` write what this form has not.
    """
    types: list[VehicleColumns] = []
    first = vehicle = 0
    for number in range(len(problem.fleet)):
        kind = vehicle_columns(problem, number, first, vehicle)
        types.append(kind)
        first, vehicle = kind.end, vehicle + kind.prep.fleet
    variables = [block for kind in types for block in arc_and_time_columns(kind, idle_cost(problem, kind))]
    row_blocks = [visits_rows(types), fleet_rows(problem, types)]
    for kind in types:
        row_blocks += connecting_rows(kind) if connect is None else []
        row_blocks += [*limits_rows(problem, kind), time_rows(kind), closing_rows(kind)]
    blocks = VehicleBlocks(problem, types)
    ordered = bool(problem.sites.shipments)
    cyclic = [kind for kind in types if ordered or (connect is None and leaves_cycles(kind.prep, [kind.prep.time]))]
    if cyclic:
        order = blocks.add_columns("u", (np.arange(1, blocks.nodes + 1),), (blocks.names,), 1.0, float(blocks.nodes))
        blocks.rows += [order_rows(kind, order, ordered) for kind in cyclic]
        blocks.encoders.append(partial(_number_visits, order, blocks.nodes))
        add_shipments(blocks, order)
    for add in (add_groups, add_windows, add_copies, add_loads, add_residual_energy, *further, add_objective):
        add(blocks)
    circuits = () if connect is None else connect(blocks)
    rows = tuple(b for b in (*row_blocks, *blocks.rows) if b.size)
    bare = Program(
        form, problem.sense, (*variables, *blocks.variables), rows, offset=offset(problem), circuits=circuits, cones=tuple(blocks.cones)
    )
    return Compiled(bare, problem, partial(_decode, problem, types), partial(_encode, blocks, bare))


def _decode(problem: RoutingProblem, types: list[VehicleColumns], x: Floats) -> Routes:
    routes: list[Route] = []
    for kind in types:
        chosen = used(x[kind.first : kind.clock]).reshape(len(kind.tail), len(kind.vehicles))
        chosen[kind.idle] = False
        back = np.delete(np.arange(len(kind.tail)), kind.idle)
        for k in np.nonzero(chosen.any(axis=0))[0]:
            routes.extend(routes_of(kind.prep, np.nonzero(chosen[back, k])[0], problem.sites.ids))
    return Routes(tuple(routes))


def _encode(blocks: VehicleBlocks, program: Program, answer: Routes) -> Floats:
    x = program.lower.copy()
    for kind in blocks.types:
        x[kind.first + kind.idle * kind.count + np.arange(kind.count)] = 1.0
    drives = list(_drives(blocks, answer))
    for d in drives:
        kind, count = d.kind, d.kind.count
        if len(d.arcs):
            x[kind.first + kind.idle * count + d.number] = 0.0
            x[kind.first + kind.arc_of[d.arcs] * count + d.number] = 1.0
        x[kind.clock + d.nodes * count + d.number] = d.clock
    for fill in blocks.encoders:
        fill(x, drives)
    return point_of(program, x)


def _drives(blocks: VehicleBlocks, answer: Routes) -> Iterator[Drive]:
    """The drive of each vehicle in an answer; vehicles of one type are numbered by the first customer that each visits."""
    problem, types = blocks.problem, blocks.types
    taken, stops = [0] * len(types), dict[int, int]()
    names, depot = problem.sites.ids, problem.sites.depot

    def first_customer(route: Route) -> int:
        return min((site for site in route.visits if not 0 <= site < len(depot) or not depot[site]), default=0)

    for route in sorted(answer, key=first_customer):
        if not 0 <= route.vehicle < len(types):
            raise InputError(f"a route uses vehicle type {route.vehicle}, which does not exist", "unknown-name")
        kind = types[route.vehicle]
        index, k = ArcIndex(kind.prep), taken[route.vehicle]
        if k >= kind.count:
            raise InputError(
                f"the answer uses more than the {kind.count} vehicles of type {problem.fleet[route.vehicle].name}", "contradiction"
            )
        taken[route.vehicle] += 1
        nodes = index.nodes_of(route, names, stops)
        arcs = index.arcs_of(nodes, names)
        yield Drive(kind, k, nodes, arcs, _clock(kind, nodes, arcs))
    for kind, number in zip(types, taken, strict=True):
        for k in range(number, kind.count if kind.committed else 0):
            clock = kind.lower[0] + np.array([0.0, kind.idle_duration])
            yield Drive(kind, k, np.array([0, kind.prep.end]), np.zeros(0, dtype=np.int64), clock)


def _number_visits(first: int, nodes: int, x: Floats, drives: list[Drive]) -> None:
    x[first : first + nodes] = 1.0
    for d in drives:
        x[first + d.nodes[1:-1] - 1] = np.arange(1.0, len(d.nodes) - 1)


def _clock(kind: VehicleColumns, nodes: NDArray[np.int64], arcs: NDArray[np.int64]) -> Floats:
    """Earliest times; where the time from departure to return counts, those of the shortest time that there is.

    One window a site: that of the latest departure that delays no return. Several: of all departures that meet the end of a window.
    """
    earliest = _times(kind, nodes, arcs, float(kind.lower[0]))
    if not kind.elapsed:
        return earliest
    busy = np.append(0.0, np.cumsum(kind.prep.time.weight[arcs]))
    several = any(node in kind.windows for node in nodes.tolist())
    schedules = [earliest]
    for at, node in enumerate(nodes.tolist()):
        ends = [end for _, end in kind.windows.get(node, ())] + [
            float(kind.upper[node]),
            float(earliest[-1]) if at == len(nodes) - 1 else np.inf,
        ]
        if at < len(arcs):
            ends.append(float(kind.closing[kind.arc_of[arcs[at]]] - kind.prep.service[node]))
        for end in ends:
            departure = end - busy[at]
            if kind.lower[0] < departure <= kind.upper[0]:
                schedules.append(_times(kind, nodes, arcs, departure))
    size = 1e-9 * (1.0 + float(np.abs(earliest).max()))
    kept = [t for t in schedules if _in_time(kind, nodes, arcs, t, size) and (several or t[-1] <= earliest[-1] + size)]
    return min(kept, key=lambda t: t[-1] - t[0], default=earliest)


def _times(kind: VehicleColumns, nodes: NDArray[np.int64], arcs: NDArray[np.int64], departure: float) -> Floats:
    """Begin of service at each node, as early as a departure allows."""
    begins = np.empty(len(nodes))
    begins[0] = departure
    for k, arc in enumerate(arcs.tolist(), start=1):
        node = int(nodes[k])
        at = max(float(kind.lower[node]), begins[k - 1] + float(kind.prep.time.weight[arc]))
        begins[k] = next((max(at, opens) for opens, closes in kind.windows.get(node, ()) if at <= closes + kind.prep.time.tolerance), at)
    return begins


def _in_time(kind: VehicleColumns, nodes: NDArray[np.int64], arcs: NDArray[np.int64], times: Floats, slack: float) -> bool:
    begins = times[:-1] + kind.prep.service[nodes[:-1]]
    return bool((times <= kind.upper[nodes] + slack).all() and (begins <= kind.closing[kind.arc_of[arcs]] + slack).all())


FORMS.enter(Form("three-index", "routing", FEATURES, build, refuses=refuses, order=4, size=_sizes.three_index))
