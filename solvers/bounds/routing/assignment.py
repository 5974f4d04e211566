"""Bound ``assignment``: the cheapest assignment of one predecessor and one successor to each customer, as evidence ``arc-multipliers``."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ....formulations.evidence import Evidence
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop, Stopped
from ....formulations.verified_bounds import verified_bound
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from .arcs import Arcs, Floats, arc_costs, by_site, lacks_arc_costs

STEPS_PER_SECOND = 4e9
"""Cubes of the number of nodes that fit in a second of the budget, with a wide margin: 1,000 nodes take 0.1 s, prices twice that."""

STALLED = 1e-13
"""Part of the dearest arc by which prices must change for another round to be worth it."""


@bound_method("assignment", of_family("routing", lacks_arc_costs), order=1)
def assignment_bound(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from the prices of a cheapest assignment of successors; None where the time does not suffice or there is no assignment.

    The depot is as many nodes as there may be routes; those beyond the least number may succeed each other at no cost. The bound is strong
    where costs are far from symmetric; elsewhere near sites succeed each other both ways, and trees prove more.
    """
    arcs = arc_costs(problem, stop)
    if arcs is None or arcs.fewest > arcs.most or (len(arcs.customers) + arcs.most) ** 3 > STEPS_PER_SECOND * stop.seconds_left:
        return None
    best: Evidence | None = None
    try:
        for data in _multipliers(problem, arcs, stop):
            value = verified_bound(problem, Evidence("arc-multipliers", "assignment", -math.inf, data))
            if best is None or value > best.value:
                best = Evidence("arc-multipliers", "assignment", value, data)
            stop.check()
    except Stopped:
        pass
    return best


def _multipliers(problem: RoutingProblem, arcs: Arcs, stop: Stop) -> Iterator[dict[str, object]]:
    """Multipliers of the assignment, with the price of a route that its depots have, or those of the depots that may stay idle."""
    from scipy.optimize import linear_sum_assignment

    depots, least, n = arcs.most, arcs.fewest, len(arcs.customers)
    cost = np.full((depots + n, depots + n), math.inf)
    cost[depots:, depots:] = arcs.cost[1:, 1:]
    cost[:depots, depots:], cost[depots:, :depots] = arcs.cost[0, 1:], arcs.cost[1:, [0]]
    cost[least:depots, least:depots] = 0.0
    try:
        successor = linear_sum_assignment(cost)[1]
    except ValueError:  # no assignment is finite
        return
    rows, columns = _prices(cost, successor, stop)

    for part in (slice(0, least), slice(least, depots)):
        if part.start < part.stop:
            leaving, entering = float(rows[part].mean()), float(columns[part].mean())
            out, into = by_site(problem, rows[depots:] + entering), by_site(problem, columns[depots:] - entering)
            yield {"out": out, "in": into, "fleet": leaving + entering}


def _prices(cost: Floats, successor: NDArray[np.integer], stop: Stop = NEVER) -> tuple[Floats, Floats]:
    """Prices of rows and columns that no cost is below and that chosen costs equal: shortest paths between columns (Bellman-Ford)."""
    chosen = np.take_along_axis(cost, successor[:, None], axis=1)
    dearer = np.empty_like(cost)
    dearer[successor] = cost - chosen
    columns, enough = np.zeros(len(cost)), STALLED * float(np.abs(chosen).max())
    for _ in range(len(cost)):
        stop.check()
        lower = np.minimum(columns, (columns[:, None] + dearer).min(axis=0))
        if (columns - lower).max() <= enough:
            break
        columns = lower
    return chosen[:, 0] - columns[successor], columns
