"""Evidence ``target-weights``: one weight per target, multiplied out against the robots' actions.

For weights y >= 0 of the targets and any way to use the robots, the worst-covered target is covered no better than the weighted
mean, and the mean no better than if every robot took the action that serves the mean best::

    min_j cover_j  <=  sum_j y_j cover_j / sum_j y_j  <=  sum_i max(0, max over actions m of i of sum_j c_mj y_j) / sum_j y_j

Weights may stand on a few targets only: only the robots that see those are then looked at. With whole actions the bound is lowered to
the next value that sums of the weights can take at all.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...checking.evidence_numbers import numbers
from ...checking.granularity import grain, lift
from ...evidence import checker

_EPS = float(np.finfo(np.float64).eps)
_TINY = 5e-324
_SMALLEST = 1e-290
"""Below it the rounding of a product or quotient may be larger than its relative error tells."""


@checker("target-weights", "max-min", "weights of targets are", of="bottleneck problems", needs="graph")
def check_target_weights(problem: Any, data: Mapping[str, Any]) -> float:
    """Upper bound on the bottleneck value, whole actions or shares, that any weights of targets prove.

    ``data`` holds ``targets``, numbers from 0, none twice, and ``weights``, one each, of which negative ones count as 0. The bound is
    infinite where no weight is positive, and minus infinity where decided actions leave no answer. The sums are rounded upwards.

    Source: linear programming duality for (3.5) of Sung (2019); docs/formulations/bottleneck.md#target-weights.
    """
    graph = problem.graph
    named = data["targets"]
    whole = isinstance(named, list | tuple) and not any(isinstance(t, bool) or not isinstance(t, int) for t in named)
    if not whole or (isinstance(data["weights"], list | tuple) and len(data["weights"]) != len(named)):
        raise InputError("targets and weights must be lists of one length, the targets whole numbers", "wrong-shape")
    targets, weights = np.array(named, dtype=np.int64), numbers(data, "weights", len(named))
    if targets.size and (targets.min() < 0 or targets.max() >= graph.num_targets or len(np.unique(targets)) != len(targets)):
        raise InputError("a target does not exist or stands twice", "unknown-name", expected=f"0 to {graph.num_targets - 1}")
    if problem.decided and _contradicted(problem):
        return -math.inf
    y = np.zeros(graph.num_targets)
    y[targets] = np.maximum(weights, 0.0)
    largest = float(y.max(initial=0.0))
    if largest <= 0.0:
        return math.inf
    y /= largest  # guards the products against overflow and against vanishing
    edges = np.nonzero(y[graph.indices])[0]
    actions = np.searchsorted(graph.indptr, edges, side="right") - 1
    with np.errstate(over="ignore", under="ignore"):
        products = graph.weights[edges] * y[graph.indices[edges]]
        products += np.where((products < _SMALLEST) & (graph.weights[edges] > 0), _TINY, 0.0)  # what underflow took
        worth = np.where(_open(problem), np.bincount(actions, products, minlength=graph.num_actions), 0.0)
    best = np.zeros(graph.num_robots)
    np.maximum.at(best, graph.robot_of_action, worth)
    try:
        total = math.fsum(best) / math.fsum(y)
    except OverflowError:
        return math.inf
    # Longest sum of products: one rounding a term and a product, and a few for the quotient.
    longest = int(np.diff(graph.indptr).max(initial=0))
    bound = total * (1.0 + (longest + 8) * _EPS) + (2 * _TINY if 0.0 < total < _SMALLEST else 0.0)
    # A sum of whole actions' weights is a multiple of what all weights are multiples of.
    return bound if problem.fractional else lift(bound, "max", grain(graph.weights))


def _contradicted(problem: Any) -> bool:
    """True if an action is both taken and dropped, or a robot takes two."""
    robots = problem.graph.robot_of_action[problem.taken]
    return len(np.intersect1d(problem.taken, problem.dropped)) > 0 or len(np.unique(robots)) < len(robots)


def _open(problem: Any) -> NDArray[np.bool_]:
    """Actions that an answer may use: of a robot whose action is taken that one alone, else all that are not dropped."""
    owner = problem.graph.robot_of_action
    usable: NDArray[np.bool_] = ~np.isin(owner, owner[problem.taken])
    usable[problem.taken] = True
    usable[problem.dropped] = False
    return usable
