"""Evidence ``errand-prices``: prices of bins and requests, and what fetching a bin and serving a request are worth.

With prices p_j, r_q >= 0, any worths s, t, and c_ijq the time of an errand (p_j and s missing without a bin, r_q and t without a request),
K bins fetched and D requests served take

    K s + D t - sum_j p_j - sum_q r_q + sum_i min(0, min_jq (c_ijq + p_j + r_q - s - t))

at least: each robot's errand is one of those, or none, and no bin or request is paid twice.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ...checking.granularity import grain, lift
from ...evidence import checker
from .job_prices import finite_numbers, is_finite

_EPS = float(np.finfo(np.float64).eps)


@checker("errand-prices", "joint-assignment", "prices of errands are")
def check_errand_prices(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound on the sum of times that any prices prove, rounded up to the next sum of times that there can be.

    ``data`` holds ``bins`` and ``requests``, one price each (negative ones count as 0), and the worths ``pickup`` and ``delivery``.

    Source: Lagrangean duality, Burkard, Dell'Amico and Martello (2009), section 10.2; docs/formulations/joint-assignment.md#evidence.
    """
    instance = problem.instance
    bins, requests = (
        np.maximum(finite_numbers(data, key, count, f"prices of {key}"), 0.0)
        for key, count in (("bins", instance.num_bins), ("requests", instance.num_requests))
    )
    worths = [data.get("pickup"), data.get("delivery")]
    if not all(map(is_finite, worths)):
        raise InputError("evidence needs the numbers pickup and delivery")
    s, t = (float(worth) for worth in worths)  # type: ignore[arg-type]
    least: list[float] = []
    with np.errstate(over="ignore", invalid="ignore"):
        size = abs(s) + abs(t) + float(bins.max(initial=0.0)) + float(requests.max(initial=0.0))
        for to_bin, to_request in zip(instance.to_bin, instance.to_request, strict=True):
            usable = np.where(np.isfinite(to_bin) & np.isfinite(instance.filled), 0.0, math.inf)
            alone = np.maximum(to_bin, instance.filled) + usable + (bins - s)
            some = [0.0, alone.min(), (to_request + (requests - t)).min(initial=math.inf)]
            if instance.num_requests:
                both = np.maximum(to_request[:, None] + instance.between, instance.filled) + usable + (requests - t)[:, None] + (bins - s)
                some.append(both.min())
            least.append(float(min(some)))
        parts = [instance.to_bin, instance.to_request, instance.between, instance.filled]
        finite = [part[np.isfinite(part)] for part in parts]
        size += sum(float(part.max(initial=0.0)) for part in finite)
        terms = [problem.pickups * s, problem.deliveries * t, *(-bins).tolist(), *(-requests).tolist(), *least]
        try:
            total = math.fsum([*terms, -8.0 * _EPS * (len(least) + 2) * size - 4.0 * _EPS * math.fsum(map(abs, terms))])
        except (OverflowError, ValueError):
            return -math.inf
    return lift(total, "min", grain(np.concatenate(finite))) if math.isfinite(total) else -math.inf
