"""Evidence ``average-part``: no partition makes its largest part smaller than the mean of what all parts must cost.

All m parts together cost the sum of all weights, and distances. Spanning trees of the parts are a forest of at most m trees, no shorter
than a minimum spanning tree of all tasks without its m - 1 longest edges. Pairs within parts are at least as many as in parts of equal
size, and no shorter than the shortest of all pairs. Besides, a part costs at least the weight of any task in it and all negative weights.

The difference of two parts: with fewer tasks than parts one part is empty, so it is at least the largest part. Without distances, where all
weights are multiples of g and their sum is no multiple of m g, not all parts are equal, and it is at least g. With weights of at least 0 it
is at least the heaviest task less the mean of what remains for the other parts.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.number_arrays import Floats
from ...checking.granularity import grain
from ...evidence import checker
from .task_allocation import smallest_forest

_EPS = float(np.finfo(np.float64).eps)


@checker("average-part", "balanced-partition", "the average part is")
def check_average_part(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound on the largest part, or on the difference of two, rounded downwards; it reads no evidence data.

    Source: docs/formulations/balanced-partition.md#evidence.
    """
    instance = problem.instance
    weights, parts = np.asarray(instance.weights), int(instance.num_robots)
    if problem.objective == "min-difference":
        if len(weights) < parts:
            return max(0.0, _largest_part(problem, weights, parts))
        return _difference(weights, parts) if problem.edges == "none" and parts > 1 else 0.0
    return _largest_part(problem, weights, parts)


def _difference(weights: Floats, parts: int) -> float:
    """A lower bound on the largest part less the smallest, without distances."""
    size = math.fsum(np.abs(weights))
    exact = bool((np.floor(weights) == weights).all()) and size < 2.0**53
    bound, unit = 0.0, grain(weights)
    if unit is not None and size < 2.0**40 * unit.size and int(np.rint(weights / unit.size).astype(np.int64).sum()) % parts:
        bound = unit.size
    if (weights >= 0.0).all():
        heaviest = float(weights.max())
        others = math.fsum([*weights.tolist(), -heaviest]) * (1.0 + 4.0 * _EPS) / (parts - 1)
        bound = max(bound, math.nextafter(heaviest - others * (1.0 + 4.0 * _EPS), -math.inf))
    return max(0.0, bound if exact else bound - 16.0 * _EPS * size)


def _largest_part(problem: Any, weights: Floats, parts: int) -> float:
    """A lower bound on the largest part."""
    instance = problem.instance
    between = np.asarray(instance.distances)[parts:]
    edges: list[float] = []
    if problem.edges != "none":
        edges = _forest(between, parts)
        if problem.edges == "clique":
            edges = max(edges, _pairs(between, parts), key=math.fsum)
    terms = [*weights.tolist(), *edges]
    mean = math.fsum(terms) / parts - 8.0 * _EPS * math.fsum(map(abs, terms))
    below = np.minimum(weights, 0.0)
    alone = float((weights - below).max()) + math.fsum(below.tolist()) - 8.0 * _EPS * math.fsum(np.abs(weights).tolist())
    return max(mean, alone)


def _forest(between: Floats, trees: int) -> list[float]:
    """The edges of a minimum spanning tree of all tasks without its longest ones, so that ``trees`` trees remain."""
    return sorted(smallest_forest(between[0, 1:], between[1:, 1:]))[: max(0, len(between) - trees)]


def _pairs(between: Floats, parts: int) -> list[float]:
    """The shortest pairs, as many as parts of equal size hold."""
    small, larger = divmod(len(between), parts)
    count = larger * (small + 1) * small // 2 + (parts - larger) * small * (small - 1) // 2
    every = between[np.triu_indices(len(between), 1)]
    shortest: list[float] = (np.partition(every, count)[:count] if count < len(every) else every).tolist()
    return shortest
