"""All distances and durations between sites, as far as there are memory and time for them."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import Stop
from ....instances.errors import UsageError
from ....instances.memory import fits, readable
from ....instances.number_arrays import Flags as Flags, Floats as Floats, Integers
from ...heuristic import HEURISTICS

Sites = Integers

MOST_SITES = 10_000
"""Sites between which all distances are held, at most."""

STRIP = 1 << 20
"""Distances that are computed between two looks at the time."""


def dense(
    between: Callable[[ArrayLike, ArrayLike], Floats], nodes: Sites, stop: Stop, what: str, *, savings: bool = False
) -> Floats | None:
    """``between(nodes[i], nodes[j])`` for all i and j; None where it was asked to stop.

    Raises UsageError where there are too many sites for ``what``, or no memory for them; it names ``savings`` where that takes the problem.
    """
    n = len(nodes)
    if n > MOST_SITES or not fits(24.0 * n * n):
        reason = f"needs {readable(24.0 * n * n)}" if n <= MOST_SITES else f"takes at most {MOST_SITES:,}"
        other = "; savings needs none of them" if savings else ""
        raise UsageError(f"{what} of {n:,} sites holds all distances between them and {reason}{other}", "too-large")
    matrix, step = np.empty((n, n)), max(1, STRIP // n)
    for first in range(0, n, step):
        if stop.reached():
            return None
        matrix[first : first + step] = between(nodes[first : first + step, None], nodes[None, :])
    return matrix


def takes_savings(problem: RoutingProblem) -> bool:
    """Whether savings, which holds no distances, takes the problem too."""
    return not HEURISTICS["savings"].missing(problem)


def travel_matrices(problem: RoutingProblem, nodes: Sites, stop: Stop, what: str, *, savings: bool = False) -> tuple[Floats, Floats] | None:
    """Distances and durations between sites, one array where they are equal; None and errors as for ``dense``."""
    travel = problem.travel
    distance = dense(travel.distance, nodes, stop, what, savings=savings)
    time = distance if not travel.own_durations or distance is None else dense(travel.duration, nodes, stop, what, savings=savings)
    return None if distance is None or time is None else (distance, time)


def site_data(problem: RoutingProblem, stop: Stop, what: str) -> tuple[Sites, tuple[Any, ...], tuple[float, ...]] | None:
    """Data of the nodes for kernels that insert sites, of a problem with one vehicle type; None and errors as for ``dense``.

    They are the site of each node; demand, service, ready, due, distances, durations; and limits: see ``insertion_kernels``.
    """
    sites, vehicle = problem.sites, problem.fleet[0]
    nodes = np.concatenate([[vehicle.start], problem.customers, [vehicle.end]])
    matrices = travel_matrices(problem, nodes, stop, what, savings=takes_savings(problem))
    if matrices is None:
        return None
    data = (sites.demand[nodes], sites.service[nodes], sites.ready[nodes], sites.due[nodes], *matrices)
    limits = (float(sites.ready[vehicle.start]), float(sites.due[vehicle.end]), vehicle.max_duration, vehicle.max_distance)
    return nodes, data, limits
