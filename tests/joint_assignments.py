"""Joint assignments for tests: random ones, and their optima by enumeration."""

from __future__ import annotations

import itertools
import math

import numpy as np

from waybound.formulations.auctions.joint_assignment import JointAssignment


def random_joint(rng: np.random.Generator, scale: float = 1.0) -> JointAssignment:
    """Up to three robots and bins and two requests, whole or not, some pairs forbidden."""
    n, m, q = int(rng.integers(1, 4)), int(rng.integers(1, 4)), int(rng.integers(0, 3))
    to_bin, to_request, between, filled = (rng.integers(0, 12, shape).astype(float) for shape in ((n, m), (n, q), (q, m), (m,)))
    if rng.random() < 0.3:
        to_bin = to_bin * 0.37
    to_bin[rng.random((n, m)) < 0.2] = math.inf
    to_request[rng.random((n, q)) < 0.2] = math.inf
    filled[rng.random(m) < 0.1] = math.inf
    return JointAssignment.from_arrays(to_bin * scale, to_request * scale, between * scale, filled * scale)


def enumerated(problem: JointAssignment) -> float:
    """The least sum of times of all errands that have the most bins and requests."""
    given, n, m, q = problem.instance, problem.num_robots, problem.num_bins, problem.num_requests
    found: dict[tuple[int, int], float] = {}
    for errands in itertools.product(itertools.product(range(-1, m), range(-1, q)), repeat=n):
        bins, requests = ([one[k] for one in errands if one[k] >= 0] for k in (0, 1))
        if len(set(bins)) < len(bins) or len(set(requests)) < len(requests):
            continue
        times = []
        for i, (j, k) in enumerate(errands):
            way = given.to_request[i, k] if k >= 0 else 0.0
            if j >= 0:
                far = way + given.between[k, j] if k >= 0 else given.to_bin[i, j]
                way = max(far, given.filled[j], given.to_bin[i, j] if math.isinf(given.to_bin[i, j]) else 0.0)
            times.append(way)
        total = math.fsum(times)
        if math.isfinite(total):
            key = len(bins), len(requests)
            found[key] = min(found.get(key, math.inf), total)
    return found[max(found)]


WORKED = JointAssignment.from_arrays([[1, 2], [2, 5]], [[1, 4], [1, 6]], [[3, 0], [0, 9]], [0, 2])
"""By bins 1 and 2, over requests 2 and 1, in 4 and 2 steps. Bins for themselves would be given the other way round, which takes 8."""
