"""Bound ``marginal-gains``: f of a set, and the best sum of gains over it that the constraint allows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.problem import Problem
from ....formulations.sata.feasibility import Openings, in_budgets
from ....formulations.sata.submodular_selection import SubmodularSelection
from ....formulations.stop import NEVER, Stop
from ....formulations.verified_bounds import verified_bound
from ....instances.sata.constraints import Knapsack, LimitRows, PartitionMatroid
from ....instances.sata.set_functions import Floats, ItemWeights
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from .growing_sets import WeightedSet, empty_set

WORK = 5_000_000
"""Entries of the function's data that are looked at in search of the best prefix (two prefixes at least): some milliseconds."""


def best_prefix(problem: SubmodularSelection, picks: Sequence[int], stop: Stop = NEVER) -> tuple[Evidence | None, int]:
    """The strongest evidence ``marginal-gains`` among prefixes of ``picks``, and how many gains were looked at; docs/selection.md#bounds.

    ``picks`` stand in the order in which a method took them, and need not be feasible. The empty prefix and the whole are always tried,
    others, evenly spaced, as far as ``WORK`` goes. There is no evidence for a user's function that is not declared monotone and submodular,
    or where the time was up before the first prefix.
    """
    f, n = problem.function, problem.num_elements
    if not (f.monotone and f.submodular):
        return None, 0
    weights, partition, rows = f.as_item_weights(), problem.constraint.as_partition(n), problem.constraint.rows(n)
    affordable = max(2, WORK // max(1, n**2 if weights is None else weights.entries))
    sizes = {0, len(picks), *np.linspace(0, len(picks), min(affordable, len(picks) + 1)).round().astype(int).tolist()}
    best: tuple[float, int] | None = None
    grown, done, looked = empty_set(f), 0, 0
    for size in sorted(sizes):
        if size > done:
            grown.add(picks[done:size])
        done = size
        gains = grown.gains(np.arange(n), stop)
        if stop.reached():
            break
        looked += n
        bound = grown.value + best_sum(partition, rows, gains)
        if best is None or bound < best[0]:
            best = (bound, size)
    if best is None:
        return None, looked
    chosen = [int(e) for e in picks[: best[1]]]
    over = "the empty set" if not chosen else f"{len(chosen)} chosen element{'s' if len(chosen) > 1 else ''}"
    by_user = "; the function is monotone and submodular as declared by the user" if weights is None else ""
    evidence = Evidence("marginal-gains", f"marginal gains over {over}{by_user}", best[0], {"prefix": chosen})
    return replace(evidence, value=verified_bound(problem, evidence)), looked


def best_sum(partition: PartitionMatroid | None, rows: LimitRows | None, gains: Floats) -> float:
    """Upper bound on the sums of ``gains`` that a constraint allows: the best sum itself for a partition, else that of the linear
    relaxation of the tightest row."""
    g = np.maximum(gains, 0.0)
    if partition is not None:
        limits, groups = partition.limits, partition.groups
        if len(limits) == 1:
            k = min(int(limits[0]), len(g))
            return float(np.partition(g, len(g) - k)[len(g) - k :].sum()) if k else 0.0
        if (limits == 1).all():
            largest = np.zeros(len(limits))
            np.maximum.at(largest, groups, g)
            return float(largest.sum())
        order = np.lexsort((-g, groups))
        group = groups[order]
        rank = np.arange(len(g)) - np.searchsorted(group, group)
        return float(g[order][rank < limits[group]].sum())
    budgets = () if rows is None else rows.budgets(len(g))
    return min((_fractional(*in_budgets(costs, budget), g) for costs, budget in budgets), default=float(g.sum()))


def _fractional(costs: Floats, budget: float, gains: Floats) -> float:
    paid = (costs > 0) & (costs <= budget)
    order = np.argsort(-gains[paid] / costs[paid], kind="stable")
    cost, worth = costs[paid][order], gains[paid][order]
    room = np.clip(budget - (np.cumsum(cost) - cost), 0.0, cost)
    return float(gains[costs == 0].sum() + (worth * (room / cost)).sum())


# -- the method for problems whose solver brings no such evidence -----------------------------------------------------


def _lacks(problem: SubmodularSelection) -> frozenset[str]:
    f = problem.function
    return frozenset() if f.monotone and f.submodular else frozenset({"a function that is declared monotone and submodular"})


KERNELS = ("waybound.solvers.bounds.sata.gain_kernels",)


@bound_method("marginal-gains", of_family("selection", _lacks), order=1, kernels=KERNELS)
def marginal_gains_bound(problem: Problem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from a set picked almost greedily, with a falling threshold (Badanidiyuru and Vondrák 2014); of a user's function
    plainly, one call a round."""
    selection: SubmodularSelection = problem  # type: ignore[assignment]
    half = stop.within(0.5 * stop.seconds_left)
    weights, c = selection.function.as_item_weights(), selection.constraint
    partition, knapsack = c.as_partition(selection.num_elements), c.as_knapsack()
    if weights is None or (partition is None and knapsack is None):
        picks = _picked(selection, half)
    else:
        picks = _swept(weights, selection.num_elements, partition, knapsack, half)
    return best_prefix(selection, picks, stop)[0]


def _swept(weights: ItemWeights, n: int, partition: PartitionMatroid | None, knapsack: Knapsack | None, stop: Stop) -> list[int]:
    from .gain_kernels import sweep

    chosen = WeightedSet(weights)
    free: list[int] = []
    groups, room, costs, budget = np.zeros(n, np.int32), np.full(1, n, np.int64), np.ones(n), float(n)
    if partition is not None:
        groups = np.array(partition.groups, np.int32)
        room = np.minimum(partition.limits, np.bincount(groups, minlength=len(partition.limits))).astype(np.int64)
    elif knapsack is not None:
        # What costs next to nothing is taken at once, so that no gain per cost overflows.
        priced, limit = in_budgets(knapsack.costs, knapsack.budget)
        cheap = priced <= 1e-9 * limit
        free = np.nonzero(cheap)[0].tolist()
        chosen.add(free)
        costs, budget = np.where(cheap, 2.0 * limit + 1.0, priced), limit
    most = int(room.sum())
    picks: list[int] = sweep(stop.flag, costs, budget, groups, room, most, 1e-4, chosen.best, *chosen.arrays).tolist()
    return free + picks


def _picked(problem: SubmodularSelection, stop: Stop) -> list[int]:
    """Picks of a plain greedy, by gain per cost where there are costs, as far as the time goes."""
    c, n = problem.constraint, problem.num_elements
    chosen, openings, knapsack = empty_set(problem.function), Openings(c, n), c.as_knapsack()
    costs = np.ones(n) if knapsack is None else np.maximum(knapsack.costs, 1e-300)
    picks: list[int] = []
    while len(open_ := openings.open()):
        gains = chosen.gains(open_, stop)
        at = int(np.argmax(gains / costs[open_]))
        if stop.reached() or not gains[at] > 0:
            break
        picks.append(int(open_[at]))
        chosen.take(picks[-1], float(gains[at]))
        openings.take(picks[-1])
    return picks
