"""The choice that decided elements leave, worked out for the checkers from the constraint's rows.

With the elements of T taken and those of D dropped, a bound that adds up one number w_e >= 0 for each chosen element is

    sum of w_e over T  +  the best sum over a set of the others that the constraint allows beside T

and the second is that of the constraint with its limits less what T uses.
"""

import math
from typing import Any

import numpy as np

from ....instances.number_arrays import Floats
from ...tolerance import room

_EPS = float(np.finfo(np.float64).eps)


def split(problem: Any, worth: Floats) -> tuple[Floats, Floats]:
    """``worth`` of the taken elements, and of all elements with 0 for every one that is decided."""
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
    partition = problem.constraint.as_partition(problem.num_elements)
    if partition is not None:
        used = np.bincount(partition.groups[problem.taken], minlength=len(partition.limits))
        return bool((used > partition.limits).any())
    return any(spent(problem, costs) > room(costs, limit) * (1.0 + 4 * _EPS) for costs, limit in budgets(problem) or ())


def budgets(problem: Any) -> list[tuple[Floats, float]] | None:
    """Costs of all elements and the limit, for each of the constraint's rows; None where it is known by what it allows only."""
    n = problem.num_elements
    rows = problem.constraint.rows(n)
    if rows is None:
        return None
    pairs = []
    for row, limit in enumerate(rows.limit.tolist()):
        costs, mine = np.zeros(n), rows.row == row
        costs[rows.element[mine]] = rows.coefficient[mine]
        pairs.append((costs, limit))
    return pairs


def best_of_groups(problem: Any, worth: Floats) -> Floats | None:
    """The largest ``worth`` in each group, of as many elements as there is room for beside the taken ones; None for other constraints."""
    partition = problem.constraint.as_partition(len(worth))
    if partition is None:
        return None
    limits = partition.limits - np.bincount(partition.groups[problem.taken], minlength=len(partition.limits))
    order = np.lexsort((-worth, partition.groups))
    groups = partition.groups[order]
    rank = np.arange(len(order)) - np.searchsorted(groups, groups)
    return np.asarray(worth[order[rank < limits[groups]]], dtype=np.float64)
