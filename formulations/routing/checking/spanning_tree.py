"""Evidence ``spanning-tree``: a bound from node prices, in the manner of Held and Karp, for any number of routes.

k routes through all customers without their closing arcs are a spanning tree of depot and customers in which k edges touch the depot, and
the k dropped arcs end in k different customers; docs/formulations/routing.md#spanning-tree has the bound.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...checking.evidence_numbers import number, numbers
from ...checking.granularity import lift
from ..problem import RoutingProblem
from .known_features import Floats, Integers, routing_evidence
from .relaxation import Relaxation, relax


@routing_evidence("spanning-tree", "a spanning tree is")
def check_spanning_tree(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on total cost, the number of vehicles, or a weighted sum of them, that any node prices prove.

    ``data``: ``multipliers``, one number per site (entries of depots are ignored); ``depot``, optional: the price of a tree edge at the
    depot.

    Source: Held and Karp (1970, 1971) for one route; Christofides, Mingozzi, Toth (1981) for k-degree centre trees.
    """
    prices, theta = numbers(data, "multipliers", len(problem.sites)), number(data, "depot", 0.0)
    relaxed = relax(problem)
    if relaxed is None:
        return -math.inf
    if relaxed.fewest > relaxed.most:
        return math.inf
    with np.errstate(over="ignore"):
        bound = _bound(relaxed, prices[relaxed.customers], theta)
    return lift(bound, "min", relaxed.grain)


def _bound(relaxed: Relaxation, prices: Floats, theta: float) -> float:
    price = np.concatenate([[theta], prices])
    usable = np.isfinite(relaxed.cost)
    size = 2 * float(np.abs(price).max()) + float(np.abs(relaxed.cost[usable]).max(initial=0.0))
    if not math.isfinite(64.0 * size * len(price)):
        return -math.inf
    edges = np.minimum(relaxed.cost, relaxed.cost.T)
    edges[0] = relaxed.cost[0]
    tails, heads = np.nonzero(np.triu(np.isfinite(edges), k=1))
    weights = edges[tails, heads] + price[tails] + price[heads]
    tree = _smallest_tree(tails, heads, weights, len(price))
    rest = relaxed.cheapest_routes(relaxed.cost[1:, 0] + prices, -theta, relaxed.last)
    if tree == math.inf or rest == math.inf:
        return math.inf
    # Fewer than 4 nodes numbers are summed up, each from a few rounded ones no larger than ``size`` together.
    error = 32.0 * float(np.finfo(np.float64).eps) * 4 * len(price) * size
    return math.fsum([tree, rest, -2.0 * math.fsum(prices), -error])


def _smallest_tree(tails: Integers, heads: Integers, weights: Floats, nodes: int) -> float:
    """Weight of a minimum spanning tree; infinite if the edges do not join all nodes."""
    import scipy.sparse as sp
    from scipy.sparse.csgraph import minimum_spanning_tree

    # scipy takes a weight of 0 for a missing edge. Only the order of the weights matters, so their ranks stand in for them.
    rank = np.empty(len(weights))
    rank[np.argsort(weights, kind="stable")] = np.arange(1, len(weights) + 1)
    chosen = minimum_spanning_tree(sp.csr_matrix((rank, (tails, heads)), shape=(nodes, nodes)))
    if chosen.nnz < nodes - 1:
        return math.inf
    return math.fsum(np.sort(weights)[chosen.data.astype(np.int64) - 1])
