"""What kernels that insert sites are told of a problem with one vehicle type."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import Stop
from ...heuristic import HEURISTICS
from ..tour_steps.dense import dense


def site_data(problem: RoutingProblem, stop: Stop, what: str) -> tuple[NDArray[np.int64], tuple[Any, ...], tuple[float, ...]] | None:
    """Site of each node; demand, service, ready, due, distances, durations; and limits: see ``insertion_kernels``.

    None where it was asked to stop.

    Raises
    ------
    UsageError
        If there are too many sites, or no memory for them.
    """
    sites, travel, vehicle = problem.sites, problem.travel, problem.fleet[0]
    savings = not HEURISTICS["savings"].missing(problem)
    nodes = np.concatenate([[vehicle.start], problem.customers, [vehicle.end]])
    distance = dense(travel.distance, nodes, stop, what, savings=savings)
    time = distance if not travel.own_durations or distance is None else dense(travel.duration, nodes, stop, what, savings=savings)
    if distance is None or time is None:
        return None
    data = (sites.demand[nodes], sites.service[nodes], sites.ready[nodes], sites.due[nodes], distance, time)
    limits = (float(sites.ready[vehicle.start]), float(sites.due[vehicle.end]), vehicle.max_duration, vehicle.max_distance)
    return nodes, data, limits
