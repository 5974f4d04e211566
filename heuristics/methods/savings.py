"""Savings: Clarke and Wright's parallel merging of routes, with loads, time windows and route limits."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.problems.routing import RoutingProblem
from ...formulations.routes import Route, Routes
from ...instances.errors import UsageError
from ..heuristic import HEURISTICS, Heuristic, Outcome, Setting

FEATURES = frozenset(
    {
        "objective:total-cost", "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance",
        "limited-fleet", "fixed-cost", "separate-durations",
    }
)  # fmt: skip


def savings(problem: RoutingProblem, setting: Setting, *, shape: float = 1.0) -> Outcome:
    """Start with one route a customer, and join route ends in order of the cost they save.

    Parameters
    ----------
    problem : RoutingProblem
        One depot, one vehicle type, every site required.
    setting : Setting
        Not used: the method is deterministic and fast.
    shape : float, > 0
        Weight of the joining arc: savings are ``c_i0 + c_0j - shape * c_ij`` (Yellow 1970). 1 is the original.

    Returns
    -------
    Outcome
        May use more vehicles than the fleet has: joins are never taken back.

    Notes
    -----
    Clarke and Wright, Operations Research 12 (1964) 568-581. Without windows and with symmetric data routes are joined
    at either end (reversed where needed), else last to first only. While there are more routes than vehicles, joins that save
    nothing are taken too, the least loss first. O(n^2 log n) plus one walk a join that is tried.
    """
    if not (isinstance(shape, int | float) and 0 < shape <= 1e6):
        raise UsageError(f"shape must be a positive number of at most 1e6, not {shape!r}")
    from ..savings_kernels import merge

    vehicle, sites = problem.fleet[0], problem.sites
    depot = vehicle.start
    distance, time = problem.travel.distances, problem.travel.durations
    cost = vehicle.unit_cost * distance
    gain = cost[:, depot][:, None] + cost[depot, :][None, :] - float(shape) * cost + vehicle.fixed_cost
    both_ways = bool((distance == distance.T).all()) and (time is distance or bool((time == time.T).all()))
    both_ways = both_ways and not problem.features() & {"time-windows"}
    gain[depot, :] = gain[:, depot] = -np.inf
    np.fill_diagonal(gain, -np.inf)
    if both_ways:
        gain[np.tril_indices(len(gain))] = -np.inf
    limit = problem.vehicle_limit
    # Joins that cost more than they save come last, and only where the fleet is too small without them.
    pairs: NDArray[np.int64] = np.nonzero(gain.ravel() > (0 if limit is None else -np.inf))[0]
    # Stable sort on the negated gain: ties go to the lower site numbers, so the result does not depend on the platform.
    order = pairs[np.argsort(-gain.ravel()[pairs], kind="stable")]
    losing = int((gain.ravel()[order] > 0).sum())
    i, j = np.divmod(order, len(gain))
    _, first, following, size = merge(
        i, j, losing, len(problem.customers), len(gain) if limit is None else limit, depot, time, distance,
        np.asarray(sites.service), np.asarray(sites.ready), np.asarray(sites.due), np.asarray(sites.demand), vehicle.capacity,
        vehicle.max_duration, vehicle.max_distance, both_ways,
    )  # fmt: skip
    routes = []
    for head in np.nonzero(size > 0)[0].tolist():
        if sites.depot[head]:
            continue
        visits, node = [], int(first[head])
        while node >= 0:
            visits.append(node)
            node = int(following[node])
        routes.append(Route(tuple(visits)))
    answer = Routes(tuple(routes)).canonical()
    message = ""
    if limit is not None and len(answer) > limit:
        message = f"savings found no way to join its {len(answer)} routes for a fleet of {limit}"
    return Outcome(answer, statistics={"routes": len(answer), "savings": losing}, message=message)


def _refuses(problem: Any) -> frozenset[str]:
    return frozenset({"open-routes"}) if problem.fleet[0].start != problem.fleet[0].end else frozenset()


HEURISTICS.add(
    "savings",
    Heuristic(
        name="savings",
        families=("routing",),
        features=FEATURES,
        run=savings,
        summary="Clarke and Wright's parallel savings, with windows and route limits",
        refuses=_refuses,
    ),
)
