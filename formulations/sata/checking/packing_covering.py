"""Evidence ``packing-covering-duals``: prices of packing and covering rows, multiplied out against the matrices.

For y, z >= 0, scaled by the best t that makes ``C'y <= t A'z``, and any x >= 0::

    A x <= 1:  min_j (C x)_j <= y'C x / sum y <= t z'A x / sum y <= t sum z / sum y            (sense ``max``)
    C x >= 1:  max_i (A x)_i >= z'A x / sum z >= y'C x / (t sum z) >= sum y / (t sum z)        (sense ``min``)

with t = max over the variables v of (C'y)_v / (A'z)_v. A variable that covers for nothing, (A'z)_v = 0 < (C'y)_v, leaves no bound.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.number_arrays import Floats, Integers
from ...checking.evidence_numbers import numbers
from ...evidence import checker

_EPS = float(np.finfo(np.float64).eps)
_TINY = 5e-324


@checker("packing-covering-duals", "max-min", "prices of packing and covering rows are", of="max-min LPs", needs="packing")
def check_packing_covering_duals(problem: Any, data: Mapping[str, Any]) -> float:
    """Bound on a max-min or min-max linear program that any prices of its rows prove.

    ``data`` holds ``covering``, y, one number a row of C, and ``packing``, z, one number a row of A; negative ones count as 0. The bound is
    infinity (``max``) or minus infinity (``min``) where nothing is proved. All sums are of nonnegative terms, so that their relative error
    is that of their roundings; what falls below the smallest number counts against the bound.

    Source: linear programming duality; docs/formulations/bottleneck.md#packing-covering-duals.
    """
    a, c = problem.packing, problem.covering
    y = _scaled(numbers(data, "covering", c.rows))
    z = _scaled(numbers(data, "packing", a.rows))
    nothing = math.inf if problem.sense == "max" else -math.inf
    if not y.any() or (problem.sense == "min" and not z.any()):
        return nothing
    with np.errstate(over="ignore", divide="ignore", invalid="ignore", under="ignore"):
        worth, terms = _transposed(c, y)
        price, others = _transposed(a, z)
        used = np.nonzero(terms)[0]
        rate = (worth + terms * _TINY)[used] / np.maximum(price - others * _TINY, 0.0)[used]
        t = float(rate.max(initial=0.0))
        dearest, least = (z, y) if problem.sense == "max" else (y, z)
        ratio = math.fsum(dearest) / math.fsum(least)
        slack = 1.0 + (int(terms.max(initial=0)) + int(others.max(initial=0)) + 16) * _EPS
        bound = t * ratio * slack + (_TINY if len(used) else 0.0) if problem.sense == "max" else ratio / t / slack if t > 0 else -math.inf
    return bound if math.isfinite(bound) else nothing


def _scaled(values: Floats) -> Floats:
    """Nonnegative prices of which the largest is 1, which guards the products against overflow."""
    prices = np.maximum(values, 0.0)
    largest = float(prices.max(initial=0.0))
    with np.errstate(over="ignore", under="ignore"):
        return prices / largest if largest > 0 else prices


def _transposed(matrix: Any, prices: Floats) -> tuple[Floats, Integers]:
    """For each variable the sum of its coefficients times the prices of their rows, and how many prices are positive."""
    row = np.repeat(np.arange(matrix.rows), np.diff(matrix.indptr))
    mine = prices[row]
    worth = np.bincount(matrix.indices, matrix.data * mine, minlength=matrix.columns).astype(np.float64)
    return worth, np.bincount(matrix.indices, mine > 0, minlength=matrix.columns).astype(np.int64)
