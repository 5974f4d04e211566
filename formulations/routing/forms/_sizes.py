"""How large the forms of a problem would become, from lists of sites and a few rows of moves."""

import math
from collections.abc import Callable

import numpy as np

from ....instances.routing.travel import EXPLICIT
from ...programs.size import ProgramSize
from ...tolerance import widened
from ..preparation import copies, waiting_is_possible
from ..problem import RoutingProblem

SAMPLE = 100
"""Sites of which all moves are looked at."""

MATRICES = 6
"""Matrices of one number per move that are in memory at once while moves are prepared; there are more of them for each resource."""

MATRICES_OF_RESOURCE = 3


def moves(problem: RoutingProblem, kind: int = 0) -> float:
    """Estimate of the moves that some route of a type of vehicle can make: those that keep windows and capacity by themselves."""
    vehicle, sites, at, travel = problem.fleet[kind], problem.sites, problem.customers, problem.travel_of(kind)
    n, further = len(at), len(copies(problem))
    some = at[np.unique(np.linspace(0, n - 1, min(SAMPLE, n)).astype(np.int64))] if n else at
    allowed = some[:, None] != at[None, :]
    if np.isfinite(sites.due[at]).any():
        opens = np.maximum(sites.ready[some] + sites.service[some], vehicle.shift[0])
        allowed &= opens[:, None] + travel.duration(some[:, None], at[None, :]) <= widened(sites.due[at])
    if sites.demand[at].any() and not vehicle.reloads:
        allowed &= sites.demand[some][:, None] + sites.demand[at] <= widened(vehicle.capacity)
    if sites.skills:
        able = np.array([sites.skills[k] <= vehicle.skills for k in range(len(sites))])
        allowed &= able[some][:, None] & able[at]
    if problem.forbidden is not None:
        allowed &= ~problem.forbidden[np.ix_(some, at)]
    share = float(allowed.mean()) if allowed.size else 0.0
    return share * n * n + 2.0 * n + further * (2.0 * n + further + 2.0)


def resources(problem: RoutingProblem, kind: int = 0) -> list[str]:
    """Names of the resources of which a type of vehicle has limits."""
    vehicle, sites, at = problem.fleet[kind], problem.sites, problem.customers
    names = []
    last = min(float(sites.due[vehicle.end]), vehicle.shift[1])
    if np.isfinite(sites.due[at]).any() or math.isfinite(last) or "energy:elapsed-fixed-start" in problem.features():
        names.append("time")
    for k, capacity in enumerate(vehicle.capacities):
        if math.isfinite(capacity) and not vehicle.reloads:
            demand, pickup = (sites.demand, sites.pickup) if k == 0 else (sites.further_demand[:, k - 1], sites.further_pickup[:, k - 1])
            names += [name for name, amount in (("load", demand), ("pickup", pickup)) if amount[at].any()]
    names += [name for name in ("distance", "duration") if math.isfinite(getattr(vehicle, f"max_{name}"))]
    return [*names, "energy"] if vehicle.energy is not None else names


def _work(problem: RoutingProblem, limited: int) -> float:
    """Bytes of the matrices of all moves that are prepared for a type of vehicle."""
    nodes = len(problem.customers) + len(copies(problem)) + 2.0
    matrices = 0 if problem.travel.metric == EXPLICIT else 1  # an explicit one is there already
    return 8.0 * nodes**2 * (matrices + MATRICES + MATRICES_OF_RESOURCE * (1 + limited))


def two_index(problem: RoutingProblem, flows: Callable[[str], bool], connected: bool = False) -> ProgramSize:
    """Size of the programs of ``two_index``; resources are arc flows where ``flows`` says so, and node levels elsewhere."""
    n, arcs, limited = len(problem.customers), moves(problem), resources(problem)
    if connected or set(limited) <= {"time"} or not limited:
        limited = [*limited, "order"]
    size = ProgramSize(arcs, 2.0 * n + 2.0 + len(problem.sites.groups), 2.0 * arcs + n, _work(problem, len(limited)))
    for name in limited:
        if flows(name):
            size += ProgramSize(arcs, arcs + n, 6.0 * arcs)
        else:
            size += ProgramSize(n, arcs + 2.0 * n, (5.0 if name == "time" else 6.0) * arcs + 2.0 * n)
    return size


def three_index(problem: RoutingProblem, further: float = 0.0) -> ProgramSize:
    """Size of the programs of ``three_index``; ``further`` entries a move and vehicle beside theirs."""
    n, groups = float(len(problem.customers) + len(copies(problem))), len(problem.sites.groups)
    size, moved = ProgramSize(0.0, n + 1.0 + groups, 0.0), 0.0
    windows = 3.0 * sum(map(len, problem.sites.windows)) if problem.sites.windows else 0.0
    waits = float(waiting_is_possible(problem))
    for kind, vehicle in enumerate(problem.fleet):
        count = min(n, float(vehicle.count or n)) if not vehicle.committed else float(vehicle.count or n)
        arcs, limited = moves(problem, kind) + 1.0, len(resources(problem, kind))
        moved = max(moved, arcs)
        closing = float(problem.travel_of(kind).closing is not None) + float(bool(problem.sites.shipments))
        rows = count * (n + 2.0 + limited + arcs * (1.0 + closing) + windows + len(problem.sites.shipments) + 4.0)
        entries = count * arcs * (6.0 + limited + 2.0 * closing + waits + further) + count * (windows * 4.0 + n * 2.0)
        size += ProgramSize(count * (arcs + n + 8.0), rows, entries, _work(problem, 1 + limited))
        # Loads, orders and stores on the way are rows of single moves, over all vehicles.
        on_the_way = bool(vehicle.stations) + bool(problem.sites.shipments or problem.sites.pickup.any()) + 1.0
        size += ProgramSize(on_the_way * n, on_the_way * (arcs + 2.0 * n), on_the_way * (2.0 + 2.0 * count) * arcs)
    return size + ProgramSize(windows, windows, windows * 2.0)


def three_index_pieces(problem: RoutingProblem, pieces: float) -> ProgramSize:
    """Size of the program of ``three_index`` with this many pieces for each vehicle."""
    n = float(len(problem.customers))
    vehicles = sum(float(v.count or n) for v in problem.fleet)
    own = ProgramSize(vehicles * 3.0 * pieces, vehicles * (4.0 * pieces + 4.0), vehicles * 17.0 * pieces)
    return three_index(problem, 3.0) + own


def circuit(problem: RoutingProblem, arcs_say_enough: bool) -> ProgramSize:
    """Size of a program with one variable for each move, or for each move and vehicle; circuits count as entries."""
    if not arcs_say_enough:
        count = sum(float(v.count or len(problem.customers)) for v in problem.fleet)
        return three_index(problem, 2.0) + ProgramSize(count * (len(problem.customers) + len(copies(problem)) + 1.0), 0.0, 0.0)
    return two_index(problem, lambda name: False) + ProgramSize(0.0, 0.0, moves(problem))


def set_partitioning(problem: RoutingProblem) -> ProgramSize:
    """Size of a program with one variable for each route: at least one for each set of sites, and more where their order counts."""
    n = len(problem.customers)
    sets = len(problem.fleet) * 2.0 ** min(n, 500) * (1.0 if problem.team_risk is None else 2.0)
    maxima = sum(name in problem.features() for name in ("objective:makespan", "objective:longest-route", "objective:latest-return"))
    return ProgramSize(
        sets + 4.0, n * (1.0 + maxima) + len(problem.fleet) * 4.0 + 3.0 + len(problem.sites.groups), sets * (n * (1.0 + maxima) + 4.0)
    )
