"""Evidence ``set-partitioning-duals``: a Lagrangian bound from one price a customer, over the cheapest route at these prices.

Routes are relaxed to walks that may come back to a customer whom they forgot: at each customer some neighbours are remembered, all others
are forgotten there (ng-routes). The least reduced cost of all such walks whose levels keep every limit is found here by labels. The bound
is derived in docs/proofs.md#routes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...checking.evidence_numbers import numbers
from ...checking.granularity import lift
from ...stop import current_stop
from .known_features import Flags, Floats, routing_evidence
from .relaxation import Relaxation, Resource, relax

if TYPE_CHECKING:
    from ..problem import RoutingProblem


CUSTOMERS = 400
"""More are not looked at: nothing is proved."""

LABELS = 1_000_000
"""In one proof at most; some 60 bytes each."""

WORK = 3_000_000_000
"""Comparisons in one proof at most, some 5 s."""


@routing_evidence("set-partitioning-duals", "set-partitioning-duals are")
def check_set_partitioning_duals(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on total cost, the number of vehicles, or a weighted sum of them, by any prices of visits (weak duality).

    ``data``: ``visits``, one number a site (entries of depots are ignored); ``memory``, how many of the nearest customers are remembered
    at each one, of those next to whom he can be visited; ``ray``, optional: true for prices of the visits alone, as if no arc cost
    anything. Minus infinity where labels exceed their limits, infinity where no answer is left.

    Source: Desrochers, Desrosiers, Solomon (1992) for the relaxation and its bound; Baldacci, Mingozzi, Roberti (2011) for ng-routes;
    Feillet, Dejax, Gendreau, Gueguen (2004) for customers out of reach; docs/proofs.md#routes.
    """
    prices, memory, ray = numbers(data, "visits", len(problem.sites)), data.get("memory"), data.get("ray", False)
    if type(memory) is not int or memory < 0:
        raise InputError("evidence 'memory' must be a whole number", "out-of-range", expected="0 or more", found=str(memory)[:80])
    if not isinstance(ray, bool):
        raise InputError("evidence 'ray' must be true or false", found=str(ray)[:80])
    if len(problem.sites.customers) > CUSTOMERS:
        return -math.inf
    relaxed = relax(problem)
    if relaxed is None:
        return -math.inf
    usable = np.isfinite(relaxed.cost)
    if relaxed.fewest > relaxed.most or not usable[1:].any(axis=1).all() or not usable[:, 1:].any(axis=0).all():
        return math.inf
    with np.errstate(over="ignore"):
        bound = _bound(problem, relaxed, np.where(usable, 0.0, math.inf) if ray else relaxed.cost, prices[relaxed.customers], memory)
    if ray:
        return math.inf if bound > 0 else -math.inf
    return lift(bound, "min", relaxed.grain)


def _bound(problem: RoutingProblem, relaxed: Relaxation, cost: Floats, prices: Floats, memory: int) -> float:
    from .walk_kernels import DONE, least_walk

    usable, nodes = np.isfinite(cost), len(cost)
    size = float(np.abs(prices).max()) + float(np.abs(cost[usable]).max())
    # The routes of an answer have fewer than 2 nodes moves. Each is added up from its first on, so that no sum is larger than nodes sizes.
    error = 8.0 * float(np.finfo(np.float64).eps) * 2 * nodes * nodes * size
    if not math.isfinite(64.0 * nodes * nodes * size):
        return -math.inf
    reduced = cost.copy()
    reduced[:, 1:] -= prices[None, :]
    resources = [r for name, r in relaxed.resources.items() if name != "time" or _limits_time(problem)]
    if not resources:  # the length of a walk is limited all the same
        resources = [relaxed.resources["time"]]
    upper = np.array([r.upper + r.slack for r in resources])
    status, least = least_walk(
        current_stop().flag,
        reduced,
        np.array([np.where(usable, r.weight, math.inf) for r in resources]),
        np.array([_ways(r, usable) for r in resources]),
        np.array([r.start for r in resources]),
        np.array([r.lower for r in resources]),
        upper,
        upper + np.array([[r.slack] for r in resources]),
        _remembered(problem, relaxed, memory),
        LABELS,
        WORK,
    )
    if status != DONE:
        return -math.inf
    if least == math.inf:
        return math.inf
    return math.fsum([*prices, min(relaxed.fewest * least, relaxed.most * least), -error])


def _limits_time(problem: RoutingProblem) -> bool:
    ends = [v.end for v in problem.fleet]
    fixed = any(v.energy is not None and v.energy.charge == "elapsed-fixed-start" for v in problem.fleet)
    return fixed or bool(np.isfinite(problem.sites.due[[*problem.sites.customers, *ends]]).any())


def _ways(resource: Resource, usable: Flags) -> Floats:
    """Length of the shortest way from node to node over customers (Floyd 1962); infinite where there is none."""
    length = np.where(usable, resource.weight, math.inf)
    for k in range(1, len(length)):
        np.minimum(length, length[:, k, None] + length[None, k], out=length)
    return length


def _remembered(problem: RoutingProblem, relaxed: Relaxation, memory: int) -> NDArray[np.uint64]:
    """One bit for each customer himself and for the ``memory`` nearest of those next to whom he can be visited; none for the depot."""
    usable = np.isfinite(relaxed.cost[1:, 1:])
    far = problem.travel.distances[np.ix_(relaxed.customers, relaxed.customers)]
    far = np.where(usable | usable.T, np.minimum(far, far.T), math.inf)
    np.fill_diagonal(far, -math.inf)
    near = np.argsort(far, axis=1, kind="stable")[:, : memory + 1]
    bits = np.zeros((len(far) + 1, (len(far) + 63) // 64), np.uint64)
    for i, others in enumerate(near.tolist(), start=1):
        for j in others:
            bits[i, j // 64] |= np.uint64(1 << (j % 64))
    return bits
