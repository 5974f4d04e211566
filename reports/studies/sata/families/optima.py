"""Optima of small selection and max-min problems: by enumeration, or by a linear program whose duals are multiplied out."""

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .....formulations.evidence import Evidence
from .....formulations.problem import Problem
from .....formulations.sata.bottleneck_sata import BottleneckSATA
from .....formulations.sata.feasibility import allowed
from .....formulations.sata.max_min_lp import MaxMinLP
from .....formulations.sata.selections import Selection
from .....formulations.sata.submodular_selection import SubmodularSelection
from .....formulations.verified_bounds import verified_bound
from .....instances.errors import CheckFailedError, UsageError
from .....instances.number_arrays import Flags, Floats
from .....instances.sata.sensing_graph import SensingGraph
from ....ratios.optimum import OPTIMA, Optimum, attained, subsets

MOST_ELEMENTS = 16
"""Ground sets up to this size are enumerated: 65536 sets."""

MOST_SELECTIONS = 200_000
"""Combinations of robots' actions up to which they are enumerated."""

AGREE = 1e-6
"""Relative difference allowed between the primal and dual value of a linear program."""


# -- selections -------------------------------------------------------------------------------------------------------


def set_values(problem: SubmodularSelection) -> Floats:
    """f of every subset of the ground set, shape (2^elements,); bit e of the position is element e."""
    n, f = problem.num_elements, problem.function
    weights = f.as_item_weights()
    if weights is None:
        return f.values(subsets(n))
    worth = np.zeros((n, weights.num_items))
    element, item, weight = weights.edges()
    worth[element, item] = weight
    best = np.zeros((1, worth.shape[1]))
    for row in worth:  # the sets with one element more, beside those without it
        best = np.concatenate([best, np.maximum(best, row)])
    return np.asarray(best.sum(axis=1))


def allowed_sets(problem: SubmodularSelection) -> Flags:
    """Whether the constraint allows each subset, in the order of ``set_values``."""
    return allowed(problem.constraint, subsets(problem.num_elements))


@OPTIMA.register("selection")
def best_selection(problem: SubmodularSelection) -> Optimum:
    """The best subset that the constraint allows."""
    if problem.num_elements > MOST_ELEMENTS:
        raise UsageError(f"{problem.num_elements} elements are too many to enumerate; at most {MOST_ELEMENTS} are")
    values = np.where(allowed_sets(problem), set_values(problem), -math.inf)
    best = int(values.argmax())
    return attained(problem, Selection(tuple(e for e in range(problem.num_elements) if best >> e & 1)), "enumeration")


# -- robots and targets -----------------------------------------------------------------------------------------------


def best_actions(problem: BottleneckSATA) -> Optimum:
    """The best way to give each robot one action."""
    g = problem.graph
    starts, actions = g.by_robot
    own = [actions[starts[i] : starts[i + 1]].tolist() for i in range(g.num_robots) if starts[i] < starts[i + 1]]
    if math.prod(len(o) for o in own) > MOST_SELECTIONS:
        raise UsageError(f"{g.name} has too many robots to enumerate")
    chosen = np.array(list(itertools.product(*own)), dtype=np.int64).reshape(-1, len(own))
    worth = np.zeros((g.num_actions, g.num_targets))
    worth[g.action_of_edge, g.indices] = g.weights
    least = np.zeros((len(chosen), g.num_targets))
    for column in chosen.T:
        least += worth[column]
    return attained(problem, Selection.of(chosen[least.min(axis=1).argmax()]), "enumeration")


def _rows(g: SensingGraph) -> tuple[Floats, Floats]:
    """Packing rows of the robots and covering rows of the targets."""
    packing, covering = np.zeros((g.num_robots, g.num_actions)), np.zeros((g.num_targets, g.num_actions))
    packing[g.robot_of_action, np.arange(g.num_actions)] = 1.0
    covering[g.indices, g.action_of_edge] = g.weights
    return packing, covering


def best_shares(problem: BottleneckSATA) -> Optimum:
    """The optimum of the max-min LP (3.5) of Sung (2019)."""
    g = problem.graph
    packing, covering = _rows(g)
    x, y = _max_min(packing, covering)
    shares = x / np.maximum(packing @ x, 1.0)[g.robot_of_action]  # the solver keeps rows up to a tolerance only
    evidence = {"targets": list(range(g.num_targets)), "weights": y.tolist()}
    best = attained(problem, shares, "linear program")
    _agree(problem, best.value, verified_bound(problem, Evidence("target-weights", "linear program", math.nan, evidence)))
    return best


def least_coverage(g: SensingGraph, largest: Sequence[int] = ()) -> float:
    """The optimum of the max-min LP of shares, of which those of the actions ``largest`` are no smaller than others of their robots."""
    packing, covering = _rows(g)
    ahead = [(other, one) for one in largest for other in np.nonzero(g.robot_of_action == g.robot_of_action[one])[0] if other != one]
    order = np.zeros((len(ahead), g.num_actions))
    for row, (other, one) in zip(order, ahead, strict=True):
        row[other], row[one] = 1.0, -1.0
    x, _ = _max_min(packing, covering, order)
    return float((covering @ x).min(initial=math.inf))


def best_vector(problem: MaxMinLP) -> Optimum:
    """The optimum of a general max-min LP."""
    packing, covering = problem.packing.scipy.toarray(), problem.covering.scipy.toarray()
    x, y = _max_min(packing, covering)
    values = x / max(1.0, float((packing @ x).max()))
    best = attained(problem, values, "linear program")
    # By duality the optimum of covering is that of: min sum z, A'z >= C'y, sum y = 1. Solved for z alone with y fixed, it bounds.
    from scipy.optimize import linprog

    total = float(y.sum())
    if total > 0:
        other: Any = linprog(np.ones(len(packing)), A_ub=-packing.T, b_ub=-(covering.T @ (y / total)), method="highs")
        _agree(problem, best.value, float(other.fun))
    return best


def _max_min(packing: Floats, covering: Floats, order: Floats | None = None) -> tuple[Floats, Floats]:
    """A point that maximises the least entry of ``covering x`` subject to ``packing x <= 1`` and ``order x <= 0``, and its dual weights of
    the covering rows."""
    from scipy.optimize import linprog

    n = covering.shape[1]
    scale = float(covering.max(initial=0.0)) or 1.0  # tolerances are absolute
    below = np.zeros((0, n)) if order is None else order
    rows = np.concatenate([packing, -covering / scale, below])
    rows = np.column_stack([rows, np.repeat([0.0, 1.0, 0.0], [len(packing), len(covering), len(below)])])
    right = np.repeat([1.0, 0.0], [len(packing), len(covering) + len(below)])
    cost = np.zeros(n + 1)
    cost[n] = -1.0
    options: Any = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    solved: Any = linprog(cost, A_ub=rows, b_ub=right, method="highs-ds", options=options)
    if solved.status != 0:
        raise CheckFailedError(f"the linear program of the optimum was not solved: {solved.message}")
    return np.maximum(solved.x[:n], 0.0), np.maximum(-solved.ineqlin.marginals[len(packing) : len(packing) + len(covering)], 0.0)


def _agree(problem: Problem, value: float, bound: float) -> None:
    """Raise CheckFailedError unless a value that some answer attains meets a bound; where nothing is covered, no weights bound it."""
    if not (value == 0.0 and math.isinf(bound)) and abs(bound - value) > AGREE * max(abs(value), abs(bound), 1e-9):
        raise CheckFailedError(f"the linear program of {problem.name} has an answer of {value!r} and a bound of {bound!r}")


@OPTIMA.register("max-min")
def best_max_min(problem: BottleneckSATA | MaxMinLP) -> Optimum:
    """The optimum of any of the problems of this family. Raises UsageError for a min-max LP, CheckFailedError if the two sides of a linear
    program disagree."""
    if isinstance(problem, BottleneckSATA):
        return best_shares(problem) if problem.fractional else best_actions(problem)
    if problem.sense != "max":
        raise UsageError(f"no optimum is known for {problem.problem} problems of sense {problem.sense}", "unsupported")
    return best_vector(problem)
