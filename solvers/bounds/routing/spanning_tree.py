"""Bound ``spanning-tree``: node prices by subgradient ascent, for the evidence of the same name."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....formulations.evidence import Evidence
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod
from .arcs import Arcs, arc_costs, lacks_arc_costs

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

Floats = NDArray[np.float64]

_MEMORY = 0.7
"""Share of the last direction in the next one (Volgenant and Jonker 1982 use 0.6 to 0.7 over two steps)."""
_PATIENCE = 30
_SMALLEST_AIM = 1e-11
"""Relative rise at which the ascent gives up aiming higher."""


def spanning_tree_bound(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from the best prices that an ascent finds.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
        The ascent ends earlier when it stalls.
    linear : unused
        No program is solved.

    Returns
    -------
    Evidence of kind ``spanning-tree``, or None where the budget does not suffice for the arcs and the first tree

    Notes
    -----
    Every step aims at a rise above the best bound so far; the aim is halved when it is out of reach and widened when it is met
    (level control after Brännlund 1993, Goffin and Kiwiel 1999), so no value of an answer is needed.
    """
    arcs = arc_costs(problem, stop)
    found = None if arcs is None else _ascend(arcs, stop)
    if arcs is None or found is None:
        return None
    prices, theta, value = found
    listed = np.zeros(len(problem.sites))
    listed[arcs.customers] = prices
    return Evidence("spanning-tree", "spanning tree with node prices", value, {"multipliers": listed.tolist(), "depot": float(theta)})


@dataclass(frozen=True, eq=False)
class _Point:
    """Value and subgradient at some prices; entry 0 belongs to the depot."""

    value: float
    slope: Floats


def _ascend(arcs: Arcs, stop: Stop) -> tuple[Floats, float, float] | None:
    from .prim import spanning_tree_degrees

    edges = np.minimum(arcs.cost, arcs.cost.T)
    edges[0] = arcs.cost[0]
    edges[:, 0] = arcs.cost[0]
    np.fill_diagonal(edges, math.inf)
    closing = arcs.cost[1:, 0]
    routes = np.arange(arcs.fewest, arcs.most + 1)

    def look(price: Floats) -> _Point:
        tree, degree = spanning_tree_degrees(stop.flag, edges, price)
        last = closing + price[1:]
        order = np.argsort(last, kind="stable")
        sums = np.concatenate([[0.0], np.cumsum(last[order])])[routes] - price[0] * routes
        k = int(np.argmin(sums))
        slope = degree.astype(np.float64)
        slope[1:] -= 2.0
        slope[1 + order[: routes[k]]] += 1.0
        slope[0] -= routes[k]
        return _Point(tree + float(sums[k]) - 2.0 * float(price[1:].sum()), slope)

    price = np.zeros(len(edges))
    if len(routes) == 0 or math.isinf((here := look(price)).value):
        return price[1:], 0.0, math.inf
    if math.isnan(point := here.value):
        return None
    best, best_price = point, price
    usable = arcs.cost[np.isfinite(arcs.cost)]
    dearest = float(usable.max(initial=0.0))
    least, most = 1e-3 * dearest, 2.0 * len(edges) * dearest  # no answer costs more: what rises beyond it rises for ever
    aim, direction, waited = 0.05 * max(abs(best), least), np.zeros(len(price)), 0
    while not stop.reached() and aim > _SMALLEST_AIM * max(abs(best), least) and best <= most:
        direction = here.slope + _MEMORY * direction
        length = float(direction @ direction)
        if length == 0.0:
            break
        price = price + (best + aim - here.value) / length * direction
        here = look(price)
        if here.value > best:
            waited = 0 if here.value > best + 0.1 * aim else waited + 1
            if here.value > best + 0.5 * aim:
                aim *= 1.5
            best, best_price = here.value, price
        else:
            waited += 1
        if waited >= _PATIENCE:
            aim, waited, price, direction = aim / 2.0, 0, best_price, np.zeros(len(price))
            here = look(price)
    return best_price[1:], float(best_price[0]), best


def _prepare() -> None:
    from . import prim as prim  # compiles, or loads what was compiled before


BOUNDS.add("spanning-tree", BoundMethod("spanning-tree", lacks_arc_costs, spanning_tree_bound, order=1, prepare=_prepare))
