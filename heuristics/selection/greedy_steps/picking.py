"""Greedy picking, by whichever evaluation is asked for or measures fastest."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.selection.submodular_selection import SubmodularSelection, UserFunction
from ....formulations.stop import Stop
from ....instances.errors import UsageError
from ....instances.selection.instance import Coverage, DenseFacilityLocation, FacilityLocation
from .limits import Limits
from .sets import UserSet

EVALUATIONS = ("auto", "plain", "lazy", "incremental")

THIN = 0.5
"""Share of positive weights up to which gains are kept up to date faster than they are evaluated lazily (measured; see the benchmark)."""


@dataclass(frozen=True)
class Picked:
    """What a greedy took, and how it went.

    Parameters
    ----------
    elements : list of int
        In the order of choice.
    gains : list of float
    evaluations : int
        Gains evaluated.
    evaluation : str
        ``plain, lazy`` or ``incremental``.
    ended : str
        ``full`` (no room is left), ``eps`` (what is left gains less) or ``stopped``.
    """

    elements: list[int]
    gains: list[float]
    evaluations: int
    evaluation: str
    ended: str


def check_threshold(eps: Any) -> None:
    """Raise UsageError unless ``eps`` is a gain that a greedy may stop at."""
    if isinstance(eps, bool) or not isinstance(eps, int | float) or not (eps >= 0 and math.isfinite(eps)):
        raise UsageError(f"eps must be a finite number of at least 0, not {eps!r}")


def pick(
    problem: SubmodularSelection, limits: Limits, stop: Stop, *, evaluation: str = "auto", eps: float = 0.0, base: Sequence[int] = ()
) -> Picked:
    """The best element that there is room for, again and again; ties go to the smallest index.

    Parameters
    ----------
    evaluation : str
        ``plain`` (every gain in every round), ``lazy`` (only those that may be the largest, by their gains of earlier rounds),
        ``incremental`` (all gains are kept up to date; coverage and sparse facility location), or ``auto``, the fastest of those.
    eps : float
        Ends where the largest gain is smaller.
    base : sequence of int
        Elements that are chosen already, and take room.
    """
    how = _chosen_evaluation(problem, evaluation)
    room, free = limits.without(base), np.ones(problem.num_elements, dtype=bool)
    free[list(base)] = False
    open_ = np.bincount(limits.groups[free], minlength=len(limits.room))
    most = int(np.minimum(room, open_).sum())
    f = problem.function
    if isinstance(f, UserFunction):
        elements, gains, count, stopped = _of_user(f, limits, room.copy(), free, most, eps, base, how == "lazy", stop)
    else:
        picks, found, count = _of_arrays(f, how, (stop.flag, free, limits.groups, room.copy(), most, eps), base)
        elements, gains, stopped = picks.tolist(), found.tolist(), bool(stop.reached())
    ended = "full" if len(elements) == most else "stopped" if stopped else "eps"
    return Picked(elements, gains, count, how, ended)


def _chosen_evaluation(problem: SubmodularSelection, evaluation: str) -> str:
    f = problem.function
    if evaluation not in EVALUATIONS:
        raise UsageError(f"evaluation must be one of {', '.join(EVALUATIONS)}, not {evaluation!r}")
    if evaluation == "incremental" and isinstance(f, UserFunction | DenseFacilityLocation):
        raise UsageError("incremental evaluation is for coverage and sparse facility location; choose plain or lazy")
    if evaluation != "auto":
        return evaluation
    if isinstance(f, UserFunction):
        return "lazy" if f.submodular else "plain"
    if isinstance(f, Coverage):
        return "incremental"
    if isinstance(f, FacilityLocation) and len(f.indices) <= THIN * f.num_elements * f.num_items:
        return "incremental"
    return "lazy"


def _of_arrays(
    f: Coverage | FacilityLocation | DenseFacilityLocation, how: str, state: tuple[Any, ...], base: Sequence[int]
) -> tuple[NDArray[np.int64], NDArray[np.float64], int]:
    from ....solvers.bounds.selection._gains import as_arrays, take
    from . import loops

    arrays = as_arrays(f)
    best = np.zeros(f.num_items)
    for e in base:
        take(e, best, *arrays)
    if how != "incremental":
        return getattr(loops, how)(*state, best, *arrays)  # type: ignore[no-any-return]
    assert not isinstance(f, DenseFacilityLocation)
    # How often a gain can change: an item of a coverage once, one of a facility location with each pick.
    changes = int(np.diff(f.indptr).max(initial=0)) * (1 if isinstance(f, Coverage) else state[4])
    return loops.incremental(*state, best, *loops.transpose(state[0], f.num_items, *arrays[:4]), changes, *arrays)  # type: ignore[no-any-return]


def _of_user(
    f: UserFunction, limits: Limits, room: NDArray[np.int64], free: NDArray[np.bool_], most: int, eps: float, base: Sequence[int],
    lazy: bool, stop: Stop,
) -> tuple[list[int], list[float], int, bool]:  # fmt: skip
    chosen = UserSet(f)
    if len(base):
        chosen.inside[list(base)] = True
        chosen.value = float(f.values(chosen.inside[None, :])[0])
    picks: list[int] = []
    gains: list[float] = []
    known = np.full(f.num_elements, np.inf)
    while len(picks) < most:
        left = np.nonzero(free & (room > 0)[limits.groups])[0]
        element, gain = _lazy_round(chosen, left, known, stop) if lazy else chosen.best_of(left, stop)
        if element < 0:
            return picks, gains, chosen.evaluations, True
        if gain < eps:
            break
        chosen.take(element, gain)
        picks.append(element)
        gains.append(gain)
        free[element] = False
        room[limits.groups[element]] -= 1
    return picks, gains, chosen.evaluations, False


def _lazy_round(chosen: UserSet, left: NDArray[np.int64], known: NDArray[np.float64], stop: Stop) -> tuple[int, float]:
    """The best of ``left``, whose gains are at most ``known``; in calls of 1, 2, 4, ... sets, so that few do where many must be asked."""
    order = left[np.lexsort((left, -known[left]))]
    best, gain, at, size = -1, -np.inf, 0, 1
    if not np.isfinite(known[order[0]]):
        size = len(order)
    while at < len(order) and (known[order[at]] > gain or (known[order[at]] == gain and order[at] < best)):
        some = order[at : at + size]
        known[some] = chosen.gains(some, stop)
        if stop.reached():
            return -1, 0.0
        for e, g in zip(some.tolist(), known[some].tolist(), strict=True):
            if g > gain or (g == gain and e < best):
                best, gain = e, g
        at, size = at + len(some), 2 * size
    return best, gain
