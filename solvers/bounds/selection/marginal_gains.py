"""Bound ``marginal-gains``: f of a set, and the best sum of gains over it that the constraint allows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.certificate import verified_bound
from ....formulations.evidence import Evidence
from ....formulations.stop import NEVER, Stop
from ....instances.selection.instance import (
    Cardinality,
    DenseFacilityLocation,
    FacilityLocation,
    Knapsack,
    PartitionMatroid,
    SetFunction,
)
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.selection.submodular_selection import SubmodularSelection

Floats = NDArray[np.float64]

WORK = 5_000_000
"""Entries of the function's data that are looked at in search of the best prefix (two prefixes at least): some milliseconds."""

CHUNK = 1 << 24
"""Bytes of masks that a user's function is given at once."""


def best_prefix(problem: SubmodularSelection, picks: Sequence[int], stop: Stop = NEVER) -> tuple[Evidence | None, int]:
    """The strongest evidence ``marginal-gains`` among prefixes of ``picks``, and how many gains were looked at.

    Parameters
    ----------
    problem : SubmodularSelection
    picks : sequence of int
        Elements in the order in which a method took them; they need not be feasible.
    stop : Stop

    Returns
    -------
    (Evidence or None, int)
        No evidence for a user's function that is not declared monotone and submodular, or where the time was up before the first prefix.

    Notes
    -----
    For monotone submodular f, any set S and any feasible O: f(O) <= f(S u O) <= f(S) + sum of the gains of O's elements over S
    (Nemhauser, Wolsey and Fisher 1978). The sum is bounded by the best one that the constraint allows: the largest gains under a
    cardinality limit, the largest of each group under a partition matroid, the fractional filling of a knapsack. The empty prefix and
    the whole are always tried, others, evenly spaced, as far as ``WORK`` goes.
    """
    if not declared(problem):
        return None, 0
    passes = len(picks) + 1
    f = problem.function
    entries = f.matrix.size if isinstance(f, DenseFacilityLocation) else len(getattr(f, "indices", ())) or problem.num_elements**2
    affordable = max(2, WORK // max(1, entries))
    tried = sorted({0, len(picks), *np.linspace(0, len(picks), min(affordable, passes)).round().astype(int).tolist()})
    best: tuple[float, int] | None = None
    looked = 0
    for size, value, gains in _prefixes(problem, picks, tried, stop):
        looked += len(gains)
        bound = value + best_sum(problem, gains)
        if best is None or bound < best[0]:
            best = (bound, size)
    if best is None:
        return None, looked
    chosen = [int(e) for e in picks[: best[1]]]
    made = Evidence("marginal-gains", source_of(problem, len(chosen)), best[0], {"prefix": chosen})
    return replace(made, value=verified_bound(problem, made)), looked


def declared(problem: SubmodularSelection) -> bool:
    """Whether the function is monotone and submodular: by its kind, or by what the user declares."""
    f = problem.function
    return f.name != "user" or (f.monotone and f.submodular)  # type: ignore[union-attr]


def source_of(problem: SubmodularSelection, size: int) -> str:
    """What the evidence rests on, in words."""
    over = "the empty set" if size == 0 else f"{size} chosen element{'s' if size > 1 else ''}"
    by_user = "; the function is monotone and submodular as declared by the user" if problem.function.name == "user" else ""
    return f"marginal gains over {over}{by_user}"


def _in_budgets(c: Knapsack) -> tuple[Floats, float]:
    """Costs and budget in a unit, a power of two, in which the budget is below 1."""
    exponent = np.frexp(c.budget)[1]
    with np.errstate(over="ignore"):
        return np.ldexp(c.costs, -exponent), float(np.ldexp(c.budget, -exponent))


def best_sum(problem: SubmodularSelection, gains: Floats) -> float:
    """The best sum of ``gains`` that the constraint allows; for a knapsack that of its linear relaxation."""
    c = problem.constraint
    g = np.maximum(gains, 0.0)
    if isinstance(c, Cardinality):
        k = min(c.limit, len(g))
        return float(np.partition(g, len(g) - k)[len(g) - k :].sum()) if k else 0.0
    if isinstance(c, PartitionMatroid):
        if (c.limits == 1).all():
            largest = np.zeros(len(c.limits))
            np.maximum.at(largest, c.groups, g)
            return float(largest.sum())
        order = np.lexsort((-g, c.groups))
        group = c.groups[order]
        rank = np.arange(len(g)) - np.searchsorted(group, group)
        return float(g[order][rank < c.limits[group]].sum())
    priced, budget = _in_budgets(c)
    paid = (priced > 0) & (priced <= budget)
    costs, worth = priced[paid], g[paid]
    order = np.argsort(-worth / costs, kind="stable")
    room = np.clip(budget - (np.cumsum(costs[order]) - costs[order]), 0.0, costs[order])
    return float(g[c.costs == 0].sum() + (worth[order] * (room / costs[order])).sum())


def _prefixes(problem: SubmodularSelection, picks: Sequence[int], sizes: Sequence[int], stop: Stop) -> Iterable[tuple[int, float, Floats]]:
    """Value of, and all gains over, the prefixes of the given ascending sizes, as far as the time goes."""
    f, n = problem.function, problem.num_elements
    if f.name == "user":
        inside = np.zeros(n, dtype=bool)
        for size in sizes:
            inside[list(picks[:size])] = True
            value = float(f.values(inside[None, :])[0])  # type: ignore[union-attr]
            gains = user_gains(f, inside, value, np.arange(n), stop)
            if stop.reached():
                return
            yield size, value, gains
        return
    from ._gains import as_arrays, gains_of, take

    arrays = as_arrays(f)  # type: ignore[arg-type]
    best, done, every = np.zeros(f.num_items), 0, np.arange(n)  # type: ignore[union-attr]
    for size in sizes:
        for e in picks[done:size]:
            take(e, best, *arrays)
        done = size
        gains = gains_of(stop.flag, every, best, *arrays)
        if stop.reached():
            return
        yield size, float(best.sum()), gains


def user_gains(function: Any, inside: NDArray[np.bool_], value: float, elements: NDArray[np.int64], stop: Stop = NEVER) -> Floats:
    """Gains of ``elements`` over the set ``inside`` of value ``value``, in as many calls as memory asks for; 0 once it has to end."""
    found = np.zeros(len(elements))
    step = max(1, CHUNK // max(1, len(inside)))
    for first in range(0, len(elements), step):
        if stop.reached():
            break
        some = elements[first : first + step]
        masks = np.repeat(inside[None, :], len(some), axis=0)
        masks[np.arange(len(some)), some] = True
        found[first : first + step] = function.values(masks) - value
    found[inside[elements]] = 0.0
    return found


# -- the method for problems whose solver brings no such evidence -----------------------------------------------------


def marginal_gains_bound(problem: Problem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from a set picked almost greedily.

    Parameters
    ----------
    problem : SubmodularSelection
    stop : Stop
    linear : unused
        No program is solved.

    Returns
    -------
    Evidence or None

    Notes
    -----
    The set is picked with a falling threshold (Badanidiyuru and Vondrák 2014). A user's function, one call a round, is picked plainly.
    """
    selection: SubmodularSelection = problem  # type: ignore[assignment]
    half = stop.within(0.5 * stop.seconds_left)
    picks = _user_picks(selection, half) if selection.function.name == "user" else _swept(selection, half)
    return best_prefix(selection, picks, stop)[0]


def _swept(problem: SubmodularSelection, stop: Stop) -> list[int]:
    from ._gains import as_arrays, sweep, take

    c, n = problem.constraint, problem.num_elements
    arrays = as_arrays(problem.function)  # type: ignore[arg-type]
    best = np.zeros(problem.function.num_items)  # type: ignore[union-attr]
    free: list[int] = []
    groups, room, costs, budget = np.zeros(n, np.int32), np.full(1, n, np.int64), np.ones(n), float(n)
    if isinstance(c, Cardinality):
        room[0] = min(c.limit, n)
    elif isinstance(c, PartitionMatroid):
        groups, room = np.array(c.groups, np.int32), np.minimum(c.limits, np.bincount(c.groups, minlength=len(c.limits))).astype(np.int64)
    elif isinstance(c, Knapsack):
        # What costs next to nothing is taken at once, so that no gain per cost overflows.
        priced, limit = _in_budgets(c)
        cheap = priced <= 1e-9 * limit
        free = np.nonzero(cheap)[0].tolist()
        for e in free:
            take(e, best, *arrays)
        costs, budget = np.where(cheap, 2.0 * limit + 1.0, priced), limit
    most = int(room.sum())
    picks: list[int] = sweep(stop.flag, costs, budget, groups, room, most, 1e-4, best, *arrays).tolist()
    return free + picks


def _user_picks(problem: SubmodularSelection, stop: Stop) -> list[int]:
    """Plain greedy, as far as the time goes."""
    f, c, n = problem.function, problem.constraint, problem.num_elements
    inside, value = np.zeros(n, dtype=bool), 0.0
    picks: list[int] = []
    spent = np.zeros(len(c.limits) if isinstance(c, PartitionMatroid) else 1)
    while not stop.reached():
        if isinstance(c, Cardinality):
            allowed = ~inside if len(picks) < c.limit else np.zeros(n, dtype=bool)
        elif isinstance(c, PartitionMatroid):
            allowed = ~inside & (spent < c.limits)[c.groups]
        else:
            allowed = ~inside & (spent[0] + c.costs <= c.budget)
        left = np.nonzero(allowed)[0]
        if not len(left):
            break
        gains = user_gains(f, inside, value, left, stop)
        rate = gains / np.maximum(c.costs[left], 1e-300) if isinstance(c, Knapsack) else gains
        at = int(np.argmax(rate))
        if not gains[at] > 0:
            break
        element = int(left[at])
        picks.append(element)
        inside[element], value = True, value + float(gains[at])
        spent[c.groups[element] if isinstance(c, PartitionMatroid) else 0] += c.costs[element] if isinstance(c, Knapsack) else 1.0
    return picks


def _missing(problem: Problem) -> frozenset[str]:
    if problem.family != "selection":
        return frozenset({f"{problem.family} problems"})
    return frozenset() if declared(problem) else frozenset({"a function that is declared monotone and submodular"})  # type: ignore[arg-type]


def _prepare() -> None:
    """Compile for the functions that can be met."""
    from ....formulations.selection.submodular_selection import SubmodularSelection

    one = np.array([0, 1], np.int32), np.zeros(1, np.int32)
    functions: list[SetFunction] = [FacilityLocation(*one, np.ones(1), 1)]
    functions += [DenseFacilityLocation(np.ones((1, 1), dtype)) for dtype in (np.float32, np.float64)]
    for function in functions:
        marginal_gains_bound(SubmodularSelection(function, Cardinality(1)))


BOUNDS.add("marginal-gains", BoundMethod("marginal-gains", _missing, marginal_gains_bound, order=0, prepare=_prepare))
