"""Joint assignments for tests: random ones, and their optima by enumeration."""

import math

import numpy as np
from truth.auctions import ErrandTruth

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
    return float(ErrandTruth(problem).best[0])


WORKED = JointAssignment.from_arrays([[1, 2], [2, 5]], [[1, 4], [1, 6]], [[3, 0], [0, 9]], [0, 2])
"""By bins 1 and 2, over requests 2 and 1, in 4 and 2 steps. Bins for themselves would be given the other way round, which takes 8."""
