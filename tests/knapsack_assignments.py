"""Generalised assignments for tests: random ones of every shape, and their optima by enumeration."""

import math
from typing import Any

import numpy as np
from truth.auctions import CapacityTruth

from waybound.formulations.auctions.generalised_assignment import GeneralisedAssignment


def random_assignment(rng: np.random.Generator, most: int = 5, scale: float = 1.0) -> GeneralisedAssignment:
    """Costs or profits, whole, decimal or not, of any sign, with some pairs forbidden, and room for all jobs or not."""
    m, n = int(rng.integers(1, 4)), int(rng.integers(1, most + 1))
    kind = int(rng.integers(4))
    values = rng.integers(0 if kind % 2 else -5, 20, (m, n)).astype(float)
    used = rng.integers(0, 7, (m, n)).astype(float)
    capacity = rng.integers(0, 14, m).astype(float)
    if kind == 2:
        used, capacity = used * 0.1, capacity * 0.1
    elif kind == 3:
        values, used = values + rng.random((m, n)), used * rng.random((m, n))
    objective = "profit" if rng.random() < 0.5 else "cost"
    values[rng.random((m, n)) < 0.15] = -math.inf if objective == "profit" else math.inf
    return GeneralisedAssignment.from_arrays(values * scale, used * scale, capacity * scale, objective)


def enumerated(problem: GeneralisedAssignment) -> float | None:
    """The best value of all assignments; None where there is none."""
    values = CapacityTruth(problem).lenient
    return None if values is None else float(values[0])


def worked(objective: str = "cost", **further: Any) -> GeneralisedAssignment:
    """Two agents, three jobs: as costs 6 is least (jobs 1 and 3 to the first agent), as profits 12 the most."""
    return GeneralisedAssignment.from_arrays(
        [[2.0, 6.0, 3.0], [4.0, 1.0, 6.0]], [[2.0, 3.0, 2.0], [3.0, 2.0, 4.0]], [4.0, 4.0], objective, **further
    )
