"""Bound ``spanning-tree``: node prices by subgradient ascent, for the evidence of the same name."""

import math

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from .arcs import LIMITS, Arcs, Floats, arc_costs, by_site, lacks_arc_costs
from .subgradient_ascent import ascend

BUDGET = 0.1
"""Part of the time that it gets where routes are limited, of which trees see nothing."""

KERNELS = ("waybound.solvers.bounds.routing.prim_kernels",)


@bound_method("spanning-tree", of_family("routing", lacks_arc_costs), order=1, kernels=KERNELS)
def spanning_tree_bound(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from the best node prices that an ascent finds; None where the time does not suffice for the arcs and the first tree."""
    if problem.features() & LIMITS:
        stop = stop.within(BUDGET * stop.seconds_left)
    arcs = arc_costs(problem, stop)
    ascended = None if arcs is None else _ascend(arcs, stop)
    if ascended is None:
        return None
    prices, theta, value = ascended
    data = {"multipliers": by_site(problem, prices), "depot": float(theta)}
    return Evidence("spanning-tree", "spanning tree with node prices", value, data)


def _ascend(arcs: Arcs, stop: Stop) -> tuple[Floats, float, float] | None:
    """Node prices of the customers, that of the depot, and their value."""
    from .prim_kernels import spanning_tree_degrees

    edges = np.minimum(arcs.cost, arcs.cost.T)
    edges[0] = arcs.cost[0]
    edges[:, 0] = arcs.cost[0]
    np.fill_diagonal(edges, math.inf)
    closing = arcs.cost[1:, 0]
    routes = np.arange(arcs.fewest, arcs.most + 1)

    def look(price: Floats) -> tuple[float, Floats]:
        tree, degree = spanning_tree_degrees(stop.flag, edges, price)
        last = closing + price[1:]
        order = np.argsort(last, kind="stable")
        sums = np.concatenate([[0.0], np.cumsum(last[order])])[routes] - price[0] * routes
        k = int(np.argmin(sums))
        slope = degree.astype(np.float64)
        slope[1:] -= 2.0
        slope[1 + order[: routes[k]]] += 1.0
        slope[0] -= routes[k]
        return tree + float(sums[k]) - 2.0 * float(price[1:].sum()), slope

    price = np.zeros(len(edges))
    if len(routes) == 0:
        return price[1:], 0.0, math.inf
    dearest = float(arcs.cost[np.isfinite(arcs.cost)].max(initial=0.0))
    # No answer costs more than all moves at the dearest: what rises beyond it rises for ever.
    best_price, best = ascend(look, price, 1e-3 * dearest, 2.0 * len(edges) * dearest, stop)
    return None if math.isnan(best) else (best_price[1:], float(best_price[0]), best)
