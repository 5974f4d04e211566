"""Greedy picking, by whichever evaluation is asked for or measures fastest."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.sata.feasibility import Openings
from ....formulations.sata.submodular_selection import SubmodularSelection
from ....formulations.stop import Stop
from ....instances.errors import UsageError
from ....instances.sata.set_functions import AT_ITEM, IN_MATRIX, Floats, ItemWeights, SetFunction
from ....solvers.bounds.sata.growing_sets import GrowingSet, WeightedSet, empty_set, first_of_largest, rounding
from .limits import Limits

EVALUATIONS = ("auto", "plain", "lazy", "incremental")

THIN = 0.5
"""Share of positive weights up to which gains are kept up to date faster than they are evaluated lazily (measured; see the benchmark)."""


@dataclass(frozen=True)
class Picked:
    """The picks of a greedy in the order of choice, and how it went.

    ``plain_evaluations`` are those that a plain greedy takes on the way to these picks; ``evaluation`` is ``plain``, ``lazy`` or
    ``incremental``; ``ended`` is ``full`` (no room is left), ``eps`` (what is left gains less) or ``stopped``.
    """

    elements: list[int]
    gains: list[float]
    evaluations: int
    plain_evaluations: int
    evaluation: str
    ended: str


def check_threshold(eps: Any) -> None:
    """Raise UsageError unless ``eps`` is a finite number of at least 0."""
    if isinstance(eps, bool) or not isinstance(eps, int | float) or not (eps >= 0 and math.isfinite(eps)):
        raise UsageError(f"eps must be a finite number of at least 0, not {eps!r}", "out-of-range")


def pick(problem: SubmodularSelection, stop: Stop, *, evaluation: str = "auto", eps: float = 0.0, base: Sequence[int] = ()) -> Picked:
    """The best element that there is room for, again and again, until the largest gain is below ``eps``; ties go to the smallest index.

    ``evaluation``: every gain in every round (``plain``), only those that may be the largest, by their gains of earlier rounds (``lazy``),
    all gains kept up to date (``incremental``: coverage and sparse facility location), or ``auto``, the fastest of those. Gains of
    functions that are known by their values only are differences, and tie where these differ by rounding.
    """
    weights, limits = problem.function.as_item_weights(), Limits.if_any(problem)
    compiled = weights is not None and limits is not None
    how = _chosen_evaluation(problem.function, weights if compiled else None, evaluation)
    if weights is None or limits is None:
        return _asked(problem, how, eps, base, stop)
    room, free = limits.without(base), np.ones(problem.num_elements, dtype=bool)
    free[list(base)] = False
    open_ = np.bincount(limits.groups[free], minlength=len(limits.room))
    most = int(np.minimum(room, open_).sum())
    picks, gains, count = _compiled(weights, how, (stop.flag, free, limits.groups, room.copy(), most, eps), base)
    elements = picks.tolist()
    ended = "full" if len(elements) == most else "stopped" if stop.reached() else "eps"
    return Picked(elements, gains.tolist(), count, limits.plain_evaluations(elements, base), how, ended)


def _chosen_evaluation(f: SetFunction, compiled: ItemWeights | None, evaluation: str) -> str:
    if evaluation not in EVALUATIONS:
        raise UsageError(f"evaluation must be one of {', '.join(EVALUATIONS)}, not {evaluation!r}", "unknown-name")
    sparse = compiled if compiled is not None and compiled.layout != IN_MATRIX else None
    if evaluation == "incremental" and sparse is None:
        raise UsageError("incremental evaluation is for coverage and sparse facility location; choose plain or lazy")
    if evaluation != "auto":
        return evaluation
    if sparse is not None and (sparse.layout == AT_ITEM or sparse.entries <= THIN * f.num_elements * sparse.num_items):
        return "incremental"
    return "lazy" if f.submodular else "plain"


def _compiled(weights: ItemWeights, how: str, state: tuple[Any, ...], base: Sequence[int]) -> tuple[NDArray[np.int64], Floats, int]:
    from ....formulations.transpose_kernels import transpose
    from . import loops_kernels as loops

    chosen = WeightedSet(weights)
    chosen.add(base)
    if how != "incremental":
        return getattr(loops, how)(*state, chosen.best, *weights.arrays)  # type: ignore[no-any-return]
    # How often a gain can change: an item of a coverage once, one of a facility location with each pick.
    changes = int(np.diff(weights.indptr).max(initial=0)) * (1 if weights.layout == AT_ITEM else state[4])
    of_entry = weights.weights[:0] if weights.layout == AT_ITEM else weights.weights
    items = transpose(state[0], weights.num_items, weights.indptr, weights.indices, of_entry)
    return loops.incremental(*state, chosen.best, *items, changes, *weights.arrays)  # type: ignore[no-any-return]


def _asked(problem: SubmodularSelection, how: str, eps: float, base: Sequence[int], stop: Stop) -> Picked:
    """Picks for any function and constraint: in each round the constraint is asked what is open, and the function for gains."""
    chosen, openings = empty_set(problem.function), Openings(problem.constraint, problem.num_elements)
    if len(openings.take_in_order(base)) < len(base):
        raise UsageError("the elements of base break the constraint already")
    if base:
        chosen.add(base)
    picks: list[int] = []
    gains: list[float] = []
    known, plain, ended = np.full(problem.num_elements, np.inf), 0, "full"
    while len(open_ := openings.open()):
        element, gain = _lazy_round(chosen, open_, known, stop) if how == "lazy" else chosen.best_of(open_, stop)
        if element < 0 or gain < eps - rounding(chosen.value, 0.0):
            ended = "stopped" if element < 0 else "eps"
            break
        plain += len(open_)
        chosen.take(element, gain)
        openings.take(element)
        picks.append(element)
        gains.append(gain)
    return Picked(picks, gains, chosen.evaluations, plain, how, ended)


def _lazy_round(chosen: GrowingSet, elements: NDArray[np.int64], known: NDArray[np.float64], stop: Stop) -> tuple[int, float]:
    """The best of ``left``, whose gains are at most ``known``; in calls of 1, 2, 4, ... sets, so that few do where many must be asked."""
    rest = elements[np.lexsort((elements, -known[elements]))]
    size = 1 if np.isfinite(known[rest[0]]) else len(rest)
    asked = rest[:0]
    best, gain = -1, -np.inf
    while True:
        # A gain of an earlier round may be below what it bounds by the rounding of either.
        doubt = 2 * rounding(chosen.value, gain) if len(asked) else 0.0
        rest = rest[(known[rest] > gain) | ((known[rest] >= gain - doubt) & (rest < best))]
        if not len(rest):
            return best, gain
        some, rest, size = rest[:size], rest[size:], 2 * size
        known[some] = chosen.gains(some, stop)
        if stop.reached():
            return -1, 0.0
        asked = np.sort(np.concatenate([asked, some]))
        best, gain = first_of_largest(asked, known[asked], chosen.value)
