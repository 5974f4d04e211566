"""Evidence ``pair-cover``: robots and bins that meet all cheap pairs.

Every assignment has at most one pair for each of them among the pairs that they meet. Where they are fewer than the pairs asked for, one
pair at least is none of these, and the largest cost is that of the cheapest of the others at least; where there are no others, there is
no answer.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import CHECKERS


@CHECKERS.register("pair-cover")
def check_pair_cover(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound on the largest cost that any robots and bins prove; infinite where they prove that there is no answer.

    Parameters
    ----------
    problem : BinAssignment
    data : dict
        ``robots``, ``bins``: lists of numbers from 0.

    Raises
    ------
    InputError
        If the lists hold anything else.

    Notes
    -----
    Source: König (1931); docs/formulations/bin-assignment.md#evidence. Nothing is added up, so nothing is rounded.
    """
    if problem.family != "bin-assignment":
        raise InputError("robots and bins that meet pairs are evidence for bin-assignment problems", found=problem.problem)
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
    made = np.zeros(count, dtype=bool)
    made[listed] = True
    return made
