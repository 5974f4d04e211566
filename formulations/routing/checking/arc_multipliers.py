"""Evidence ``arc-multipliers``: a Lagrangian bound from prices of sites and of resources, such as the duals of a two-index LP.

The rows and the bound are in docs/formulations/routing.md#arc-multipliers. Two sets of x that hold every answer are minimised over by
hand, and the better of the two counts: one arc into each customer and k into the depot; one arc out of each customer and k out of the
depot.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ...checking.evidence_numbers import number, numbers
from ...checking.granularity import lift
from ..problem import RoutingProblem
from .known_features import RESOURCES, Flags, Floats, routing_evidence
from .relaxation import Relaxation, Resource, order_resource, relax

PRICED = (*RESOURCES, "order")


@routing_evidence("arc-multipliers", "arc-multipliers are")
def check_arc_multipliers(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on total cost, the number of vehicles, or a weighted sum of them, by any multipliers (weak duality).

    ``data``: ``out`` and ``in``, lists with one number per site (entries of depots are ignored); ``fleet``, one number; ``resources``,
    optional: lists with one number per site by name (also ``order``, the number of moves so far), negative ones read as 0; ``ray``,
    optional: true for multipliers of the rows alone, as if no arc cost anything. A ray with a bound above 0 proves that there is no
    answer.

    Source: Geoffrion (1974), "Lagrangean relaxation for integer programming"; rows as in Bard, Kontoravdis, Yu (2002).
    """
    sites = len(problem.sites)
    out, into, phi = numbers(data, "out", sites), numbers(data, "in", sites), number(data, "fleet", 0.0)
    lists = data.get("resources", {})
    if not isinstance(lists, Mapping) or not set(lists) <= set(PRICED):
        raise InputError("evidence 'resources' must be an object", expected=", ".join(PRICED), found=str(lists)[:80])
    prices = {str(name): np.maximum(numbers(lists, name, sites), 0.0) for name in lists}
    ray = data.get("ray", False)
    if not isinstance(ray, bool):
        raise InputError("evidence 'ray' must be true or false", found=str(ray)[:80])
    relaxed = relax(problem)
    if relaxed is None:
        return -math.inf
    if relaxed.fewest > relaxed.most:
        return math.inf
    at = relaxed.customers
    relaxed = replace(relaxed, resources={**relaxed.resources, "order": order_resource(len(at))})

    def to_node(values: Floats) -> Floats:
        return np.concatenate([[0.0], values[at]])

    if ray:
        relaxed = replace(relaxed, cost=np.where(np.isfinite(relaxed.cost), 0.0, math.inf))
    with np.errstate(over="ignore"):
        bound = _bound(relaxed, to_node(out), to_node(into), phi, {name: to_node(mu) for name, mu in prices.items()})
    if ray:
        return math.inf if bound > 0 else -math.inf
    return lift(bound, "min", relaxed.grain)


def _bound(relaxed: Relaxation, out: Floats, into: Floats, phi: float, prices: dict[str, Floats]) -> float:
    """The bound; vectors have one entry per node, 0 for the depot."""
    usable = np.isfinite(relaxed.cost)
    used = {name: mu for name, mu in prices.items() if name in relaxed.resources and mu.any()}
    size = float(np.abs(out).max()) + float(np.abs(into).max()) + abs(phi) + float(np.abs(relaxed.cost[usable]).max(initial=0.0))
    for name, mu in used.items():
        size += float(mu.max()) * relaxed.resources[name].size
    if not math.isfinite(64.0 * size * len(out)):
        return -math.inf
    reduced = relaxed.cost - out[:, None] - into[None, :]
    reduced[0] -= phi
    for name, mu in used.items():
        reduced += _resource_cost(relaxed.resources[name], mu, usable)
    bounds = [
        math.fsum(reduced[:, 1:].min(axis=0)) + relaxed.cheapest_routes(reduced[1:, 0], phi, relaxed.last),
        math.fsum(reduced[1:, :].min(axis=1)) + relaxed.cheapest_routes(reduced[0, 1:], phi, relaxed.first),
    ]
    # At most 2 nodes arcs are summed up, each from a few rounded numbers of which ``size`` is the sum of the largest.
    error = 64.0 * float(np.finfo(np.float64).eps) * 2 * len(out) * size
    return math.fsum([*out, *into, max(bounds), -error]) if max(bounds) < math.inf else math.inf


def _resource_cost(resource: Resource, mu: Floats, usable: Flags) -> Floats:
    """``mu_j w_ij`` plus the least of ``(mu_j - mu_i) f`` over the levels at which a route may leave i for j."""
    low = resource.lower[:, None] - resource.slack
    high = np.minimum(resource.upper[:, None], resource.upper[None, :] - resource.weight) + resource.slack
    slope = mu[None, :] - mu[:, None]
    level = np.where(usable, np.where(slope > 0, low, high), 0.0)
    cost: Floats = mu[None, :] * resource.weight + slope * level
    cost[0] = mu * (resource.weight[0] + resource.start)
    return cost
