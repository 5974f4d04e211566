"""The choice that decided elements leave, worked out for the checkers from the constraint's rows.

With the elements of T taken and those of D dropped, a bound that adds up one number w_e >= 0 for each chosen element is

    sum of w_e over T  +  the best sum over a set of the others that the constraint allows beside T

and the second is that of the constraint with its limits less what T uses.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...tolerance import room

Floats = NDArray[np.float64]

_EPS = float(np.finfo(np.float64).eps)


def split(problem: Any, worth: Floats) -> tuple[Floats, Floats]:
    """Numbers of the taken elements, and of all elements with 0 for every one that is decided."""
    undecided = worth.copy()
    undecided[problem.dropped] = 0.0
    undecided[problem.taken] = 0.0
    return worth[problem.taken], undecided


def spent(problem: Any, costs: Floats) -> float:
    """Cost of the taken elements, rounded downwards."""
    return math.fsum(costs[problem.taken]) * (1.0 - 2 * _EPS)


def contradicted(problem: Any) -> bool:
    """True if no set is left: an element is both taken and dropped, or more are taken than the constraint allows."""
    if not problem.decided:
        return False
    if len(np.intersect1d(problem.taken, problem.dropped)):
        return True
    n, constraint = problem.num_elements, problem.constraint
    partition, rows = constraint.as_partition(n), constraint.rows(n)
    if partition is not None:
        used = np.bincount(partition.groups[problem.taken], minlength=len(partition.limits))
        return bool((used > partition.limits).any())
    for row in range(0 if rows is None else len(rows.limit)):
        costs, mine = np.zeros(n), rows.row == row
        costs[rows.element[mine]] = rows.coefficient[mine]
        if spent(problem, costs) > room(costs, float(rows.limit[row])) * (1.0 + 4 * _EPS):
            return True
    return False
