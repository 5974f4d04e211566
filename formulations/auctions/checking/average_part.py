"""Evidence ``average-part``: no partition makes its largest part smaller than the mean of what all parts must cost.

All m parts together cost the sum of all weights, and distances: spanning trees of all parts are a spanning forest of at most m trees, no
shorter than a minimum spanning tree of all tasks without its m - 1 longest edges; pairs within parts are at least as many as in parts of
equal size, and no shorter than the shortest of all pairs. And whatever part a task is in costs its weight, and the negative ones.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import CHECKERS

Floats = NDArray[np.float64]

_EPS = float(np.finfo(np.float64).eps)


@CHECKERS.register("average-part")
def check_average_part(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound on the largest part, or 0 for the difference of two; the data of the problem suffice, and none are read.

    Returns
    -------
    float
        Rounded downwards.

    Raises
    ------
    InputError
        For problems of another family.

    Notes
    -----
    Source: docs/formulations/balanced-partition.md#evidence.
    """
    if problem.family != "balanced-partition":
        raise InputError("the average part is evidence for balanced-partition problems", found=problem.problem)
    if problem.objective == "min-difference":
        return 0.0
    instance = problem.instance
    weights, parts = np.asarray(instance.weights), int(instance.num_robots)
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
    """Edges of a minimum spanning tree of all tasks (Prim 1957) but the longest, so many that ``trees`` trees are left."""
    near, left = between[0].copy(), np.arange(len(between)) > 0
    taken = []
    for _ in range(len(between) - 1):
        node = int(np.where(left, near, math.inf).argmin())
        taken.append(float(near[node]))
        left[node] = False
        near = np.minimum(near, between[node])
    return sorted(taken)[: max(0, len(between) - trees)]


def _pairs(between: Floats, parts: int) -> list[float]:
    """The shortest pairs, as many as parts of equal size hold."""
    small, larger = divmod(len(between), parts)
    count = larger * (small + 1) * small // 2 + (parts - larger) * small * (small - 1) // 2
    every = between[np.triu_indices(len(between), 1)]
    shortest: list[float] = (np.partition(every, count)[:count] if count < len(every) else every).tolist()
    return shortest
