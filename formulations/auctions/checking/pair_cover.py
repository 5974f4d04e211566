"""Evidence ``pair-cover``: robots and bins that cover all cheap pairs.

An assignment has at most one pair for each of them among the pairs that they cover. Where they are fewer than the pairs asked for, at least
one pair is not covered, and the largest cost is at least that of the cheapest such pair; where there are no such pairs, there is no answer.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import checker


@checker("pair-cover", "bin-assignment", "robots and bins that meet pairs are")
def check_pair_cover(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound on the largest cost, infinite where there is no answer; ``data`` lists ``robots`` and ``bins`` as numbers from 0.

    Source: König (1931); docs/formulations/bin-assignment.md#evidence. Nothing is added up, so nothing is rounded.
    """
    robots, bins = _marked(data, "robots", problem.num_robots), _marked(data, "bins", problem.num_bins)
    if int(robots.sum()) + int(bins.sum()) >= problem.pairs:
        return -math.inf
    met = np.repeat(robots, np.diff(problem.indptr)) | bins[problem.bins]
    if met.all():
        return math.inf
    return float(problem.cost[~met].min()) if problem.objective == "bottleneck" else -math.inf


def _marked(data: Mapping[str, Any], key: str, count: int) -> NDArray[np.bool_]:
    listed = data.get(key)
    if not isinstance(listed, list) or not all(type(k) is int and 0 <= k < count for k in listed):
        raise InputError(f"evidence needs a list of {key} as numbers from 0", expected=f"0 to {count - 1}")
    marks = np.zeros(count, dtype=bool)
    marks[listed] = True
    return marks
