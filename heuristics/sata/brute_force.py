"""Brute force: all answers, on instances small enough for it."""

import itertools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ...formulations.evidence import Guarantee
from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.feasibility import allowed
from ...formulations.sata.selections import Selection
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...formulations.stop import Stop
from ...formulations.tolerance import room
from ...instances.errors import UsageError
from ...instances.number_arrays import Floats
from ...solvers.bounds.sata.growing_sets import WeightedSet
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .greedy_steps.limits import ANY_CONSTRAINT, ANY_FUNCTION, Limits, not_whole
from .greedy_steps.outcomes import assumptions, concluded, sentences

MOST_ANSWERS = 10_000_000
"""Answers that are enumerated at most."""

MOST_USER_SETS = 1_000_000
"""Sets that a user's function is asked for at most."""

MOST_NUMBERS = 50_000_000
"""Numbers that the enumeration keeps at most: one a choice and item."""

CHUNK = 4096
"""Sets that a user's function is given at once."""


@heuristic(
    "brute-force", ("selection", "max-min"), ANY_FUNCTION | ANY_CONSTRAINT | {"sensing", "whole-actions"},
    f"all answers of small instances (up to {MOST_ANSWERS:,}); a measure for the others", "optimal", refuses=not_whole,
)  # fmt: skip
def brute_force(problem: SubmodularSelection | BottleneckSATA, context: Context) -> Outcome:
    """Enumerate all answers, but for branches that a bound shows to be no better, and keep the first of the best.

    At most 10,000,000 answers, or 1,000,000 sets of a user's function (full sets where it is monotone); more raise UsageError. The
    statistics hold the number of answers that there are, and of those looked at. Evidence that others can check (marginal gains) need not
    meet the value.
    """
    stop = context.begin()
    if isinstance(problem, BottleneckSATA):
        return _bottleneck(problem, stop)
    c, n, weights = problem.constraint, problem.num_elements, problem.function.as_item_weights()
    limits, knapsack = Limits.if_any(problem), c.as_knapsack()
    if weights is None or (limits is None and knapsack is None):
        return _valued(problem, limits, stop)
    from .greedy_steps.enumeration_kernels import best_set

    total = 2**n if limits is None else _full_sets(limits)
    _refuse(total, MOST_ANSWERS)
    costs, budget = (np.zeros(n), 0.0) if knapsack is None else (np.array(knapsack.costs), room(knapsack.costs, knapsack.budget))
    slots = limits or Limits(np.zeros(n, np.int32), np.full(1, n, np.int64))
    single = WeightedSet(weights).gains(np.arange(n), stop)
    starts, members = slots.members()
    slot_group = np.repeat(np.arange(len(slots.room)), slots.room)
    _refuse_memory(len(slot_group), weights.num_items)
    rest = _rest(single, slots)
    tail = np.append(np.cumsum(single[members][::-1])[::-1], 0.0)
    _, best, looked, whole = best_set(
        stop.flag, slot_group, starts, members, _up(rest), costs, budget, _up(tail), limits is None, weights.num_items, *weights.arrays
    )
    statistics = {"answers": total, "enumerated": int(looked)}
    holds, _ = assumptions(problem)
    picks = best.tolist() if limits is None else _filled(best.tolist(), limits)
    guarantee, message = (_optimal(total, holds), "") if whole else (None, _cut(looked, "sets"))
    return concluded(problem, stop, picks, holds, guarantee, statistics, message, whole=bool(whole), in_order=False)


def _filled(picks: list[int], limits: Limits) -> list[int]:
    """The picks with elements that add nothing, so that every group is full (every robot acts)."""
    room, inside = limits.without(picks), set(picks)
    starts, members = limits.members()
    for g in np.nonzero(room)[0].tolist():
        spare = [e for e in members[starts[g] : starts[g + 1]].tolist() if e not in inside]
        picks = [*picks, *spare[: int(room[g])]]
    return picks


def _rest(single: Floats, limits: Limits) -> Floats:
    """Upper bound on what the slots from each on can add: the largest values of single elements, as many a group as there are slots."""
    starts, members = limits.members()
    rest, at = np.zeros(limits.most + 1), limits.most
    for g in range(len(limits.room) - 1, -1, -1):
        room = int(limits.room[g])
        largest = np.sort(single[members[starts[g] : starts[g + 1]]])[::-1][:room]
        rest[at - room : at] = rest[at] + np.cumsum(largest)[::-1]
        at -= room
    return rest


def _up(bounds: Floats) -> Floats:
    """Bounds that rounding does not make too small."""
    return np.asarray(bounds * (1.0 + 1e-12))


def _full_sets(limits: Limits) -> int:
    sizes = np.bincount(limits.groups, minlength=len(limits.room)).tolist()
    return math.prod(math.comb(size, room) for size, room in zip(sizes, limits.room.tolist(), strict=True))


def _refuse(total: int, most: int) -> None:
    if total > most:
        shown = f"{total:,}" if total < 10**15 else f"about 10^{int(math.log10(total))}"
        raise UsageError(
            f"brute-force enumerates at most {most:,} answers, this problem has {shown}; choose another heuristic or a solver", "too-large"
        )


def _refuse_memory(depth: int, width: int) -> None:
    if depth * width > MOST_NUMBERS:
        raise UsageError(
            f"brute-force keeps {depth:,} x {width:,} numbers here, more than {MOST_NUMBERS:,}; choose another heuristic", "too-large"
        )


def _optimal(total: int, assumed: tuple[str, ...]) -> Guarantee:
    everything = f"each of the {total:,} answers was looked at or excluded by a bound"
    return Guarantee(1.0, "f(S) = f(OPT)", (*assumed, everything), "exhaustive enumeration")


def _cut(looked: int, what: str) -> str:
    return f"{looked:,} {what} were looked at: {CUT_SHORT}"


def _bottleneck(problem: BottleneckSATA, stop: Stop) -> Outcome:
    from .greedy_steps.enumeration_kernels import best_bottleneck

    g = problem.graph
    starts, actions = g.by_robot
    total = math.prod(max(1, k) for k in np.diff(starts).tolist())
    _refuse(total, MOST_ANSWERS)
    _refuse_memory(g.num_robots + 1, g.num_targets)
    rest = np.zeros((g.num_robots + 1, g.num_targets))
    for robot in range(g.num_robots - 1, -1, -1):
        most = np.zeros(g.num_targets)
        for a in actions[starts[robot] : starts[robot + 1]].tolist():
            edges = slice(g.indptr[a], g.indptr[a + 1])
            most[g.indices[edges]] = np.maximum(most[g.indices[edges]], g.weights[edges])
        rest[robot] = rest[robot + 1] + most
    _, winner, looked, whole = best_bottleneck(stop.flag, starts, actions, g.indptr, g.indices, g.weights, _up(rest))
    statistics = {"answers": total, "enumerated": int(looked)}
    chosen = Selection(tuple(winner[winner >= 0].tolist()))
    if not whole:
        return Outcome(chosen, statistics=statistics, message=_cut(looked, "answers"), limit=stop.reached() or "time")
    return Outcome(chosen, _optimal(total, ("weights >= 0, so that every robot may act",)), statistics=statistics)


def _valued(problem: SubmodularSelection, limits: Limits | None, stop: Stop) -> Outcome:
    """Brute force by the values of sets: all that the constraint allows, or where it limits groups and the function is monotone the full
    ones."""
    f, n = problem.function, problem.num_elements
    if limits is None:
        total = 2**n
        _refuse(total, MOST_USER_SETS)
        sets: Iterator[Any] = itertools.chain.from_iterable(itertools.combinations(range(n), k) for k in range(n + 1))
    else:
        starts, members = limits.members()
        groups = [members[a:b].tolist() for a, b in itertools.pairwise(starts)]
        fewest = limits.room.tolist() if f.monotone else [0] * len(groups)
        sizes = [range(low, int(high) + 1) for low, high in zip(fewest, limits.room, strict=True)]
        total = math.prod(sum(math.comb(len(g), k) for k in r) for g, r in zip(groups, sizes, strict=True))
        _refuse(total, MOST_USER_SETS)
        choices = [[s for k in r for s in itertools.combinations(g, k)] for g, r in zip(groups, sizes, strict=True)]
        sets = (tuple(itertools.chain.from_iterable(parts)) for parts in itertools.product(*choices))
    best, picks, looked, whole = -math.inf, (), 0, True
    while some := list(itertools.islice(sets, CHUNK)):
        masks = np.zeros((len(some), n), dtype=bool)
        for row, members_of in zip(masks, some, strict=True):
            row[list(members_of)] = True
        if limits is None:
            fits = allowed(problem.constraint, masks)
            masks, some = masks[fits], list(itertools.compress(some, fits))
        if some:
            values = f.values(masks)
            looked += len(some)
            if values.max() > best:
                best, picks = float(values.max()), some[int(np.argmax(values))]
        if stop.reached():
            whole = next(sets, None) is None
            break
    holds, message = assumptions(problem)
    assumed = ("monotone as declared by the user: only full sets are tried",) if f.monotone and limits is not None else ()
    guarantee = _optimal(total, assumed) if whole else None
    outcome = concluded(problem, stop, picks, holds, None, {"answers": total, "enumerated": looked}, message, whole=whole, in_order=False)
    said = "" if whole else sentences(outcome.message, _cut(looked, "sets"))
    return Outcome(outcome.answer, guarantee, outcome.evidence, outcome.statistics, said, outcome.limit)
