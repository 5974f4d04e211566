"""Evidence ``state-space``: a Lagrangian bound from one price per site, over the best walk of each type of vehicle at these prices.

Routes are relaxed to walks from the start to the end of the vehicle that never return straight to where they came from (no i-j-i), and on
which one resource is counted in whole steps and within its limits, by dynamic programming over steps and sites. The limits of other
resources may be priced as well (``shares``): each route keeps them, so that a multiple of what it leaves over is no cost.
docs/formulations/routing.md#state-space.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ...checking.evidence_numbers import number, numbers
from ...checking.granularity import lift
from ...stop import current_stop
from ..problem import RoutingProblem
from .known_features import EPS, RESOURCES, Floats, refuse_unknown_resources, routing_evidence
from .vehicle_moves import Terms, VehicleMoves, alike, constants, needed_routes, relaxed_terms, value_grain, worth_of_visits

COUNTED = (*RESOURCES, "order")

STEPS = 20_000
"""Most steps into which the resource of one vehicle is divided."""

WORK = 2_000_000_000
"""Moves times the levels at which each can end, in one proof at most, some 5 s; a tenth of them in memory."""

_NEAR = 1e-9
"""Part of a step: a weight that is short of whole steps by no more counts as whole, and limits are widened as much for each move."""


@routing_evidence("state-space")
def check_state_space(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the first level of the objective that any prices of visits prove; maxima count by the farthest round trip.

    ``data``: ``prices``, one number per site (entries of depots are ignored); ``resource``, which is counted (also ``order``, the number of
    moves); ``step``, a positive number of its units; ``shares``, optional: non-negative prices by the name of another resource. Nothing
    is proved where there are too many steps, or no walk at all.

    Source: Christofides, Mingozzi, Toth (1981), "State-space relaxation procedures"; Houck, Picard, Queyranne, Vemuganti (1980) for walks
    without i-j-i.
    """
    prices, step, name = numbers(data, "prices", len(problem.sites)), number(data, "step"), data.get("resource")
    stated = data.get("shares", {})
    refuse_unknown_resources([str(name), *(stated if isinstance(stated, Mapping) else [repr(stated)])], COUNTED, f"{name} {stated}")
    if not step > 0:
        raise InputError("evidence 'step' must be positive", "out-of-range", found=str(step))
    shares = {str(r): max(0.0, number(stated, r)) for r in stated if r != name}
    relaxed, terms = relaxed_terms(problem)
    if terms is None:
        return -math.inf
    with np.errstate(over="ignore", invalid="ignore"):
        bound = _bound(relaxed, terms, prices[problem.sites.customers], str(name), step, shares)
    return lift(bound, "min", value_grain(problem, terms)) if bound > -math.inf else -math.inf


def _bound(problem: RoutingProblem, terms: Terms, prices: Floats, name: str, step: float, shares: dict[str, float]) -> float:
    sites, customers = problem.sites, problem.sites.customers
    required = sites.required[customers]
    parts = [*worth_of_visits(problem, prices).tolist(), *constants(problem, terms)]
    n, size, work = len(customers), 0.0, WORK
    slots: list[tuple[float, int]] = []
    for vehicle, count in alike(problem).items():
        moves = VehicleMoves.of(problem, vehicle, terms, prices, shares)
        if name not in moves.resources:
            return -math.inf
        walk = _least_walk(moves, name, step, work)
        if walk is None:
            return -math.inf
        least, spent = walk
        work -= spent
        size = max(size, moves.size)
        slots.append((least, min(n, count)))
    fewest = max(problem.min_vehicles, int(needed_routes(problem, required)))
    most = n
    worth, free = 0.0, most
    for least, count in sorted(slots):
        used = min(count, free) if least < 0 else min(count, max(0, fewest - (most - free)))
        if used and not math.isfinite(least):
            return -math.inf
        worth += used * least if used else 0.0
        free -= used
    if most - free < fewest:
        return -math.inf
    size += float(np.abs(prices).max()) + max((abs(x) for x in parts), default=0.0)
    # Each route is added up from its first move on, so that no sum is larger than nodes sizes; there are n routes at most.
    error = 16.0 * EPS * (n + 2) ** 2 * size
    return math.fsum([*parts, worth, -error]) if math.isfinite(64.0 * (n + 2) ** 2 * size) else -math.inf


def _least_walk(moves: VehicleMoves, name: str, step: float, work: int) -> tuple[float, int] | None:
    """Least cost of a walk, infinite if there is none, and the work it took; None where that would be too much."""
    from .state_space_kernels import least_walk

    r, nodes = moves.resources[name], len(moves.cost)
    reached = np.isfinite(r.lower) & np.isfinite(r.upper)
    usable = np.isfinite(moves.cost) & reached[:, None] & reached
    heads, tails = np.nonzero(usable.T)
    inner = (heads > 0) & (tails > 0)
    conceded = (nodes + 2) * _NEAR + r.slack / step
    top = (float(r.upper[reached].max(initial=r.start)) - r.start) / step + conceded
    if not top <= STEPS:
        return None
    weight = np.floor(np.where(usable, r.weight, 0.0) / step + _NEAR).astype(np.int64)
    idle = np.bincount(heads[inner & (weight[tails, heads] == 0)], minlength=nodes) > 0
    late = int(idle.sum())  # a customer is entered once, so that taking one step for none delays a route by so many at most
    weight[1:, 1:] = np.maximum(weight[1:, 1:], 1)
    lower = np.floor(np.where(reached, (r.lower - r.start) / step, 0.0) + _NEAR).astype(np.int64)
    upper = np.floor(np.where(reached, (r.upper - r.start) / step, -2.0 - late) + conceded).astype(np.int64) + late
    steps = int(upper.max()) + 1
    cells = int(np.maximum(0, upper - lower + 1)[heads[inner]].sum())
    if cells > work or nodes * steps * 20 > WORK // 4:
        return None
    starts = np.searchsorted(heads[inner], np.arange(nodes + 1))
    t, h = tails[inner], heads[inner]
    least = least_walk(
        current_stop().flag, starts, t, np.ascontiguousarray(moves.cost[t, h]), np.ascontiguousarray(weight[t, h]),
        np.where(usable[0], moves.cost[0], math.inf), weight[0], np.where(usable[:, 0], moves.cost[:, 0], math.inf),
        np.ascontiguousarray(weight[:, 0]), lower, upper,
    )  # fmt: skip
    return None if math.isnan(least) else (float(least), cells)
