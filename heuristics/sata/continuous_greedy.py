"""Continuous greedy: climb on the expected value of a random set, then round without loss."""

import math

import numpy as np
from numpy.typing import NDArray

from ...formulations.evidence import Guarantee
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...formulations.stop import Stop
from ...instances.errors import UsageError
from ...instances.sata.set_functions import AT_ENTRY, AT_ITEM, IN_MATRIX, ItemWeights
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .greedy_steps.limits import FUNCTIONS, GROUPED, Limits
from .greedy_steps.outcomes import assumptions, concluded, rounded_down

SOURCE = (
    "Calinescu, Chekuri, Pál and Vondrák (2011), Maximizing a monotone submodular function subject to a matroid constraint; steps as in "
    "Badanidiyuru and Vondrák (2014), Fast algorithms for maximizing submodular functions; rounding by Ageev and Sviridenko (2004)"
)

MOST_STEPS = 1_000_000

SORTED = 1_000_000
"""Entries that are sorted at once: a tenth of a second."""

MOST_ENTRIES = 50_000_000
"""Positive weights of a matrix that are turned into sparse form; each takes about 30 bytes."""


@heuristic(
    "continuous-greedy", "selection", FUNCTIONS | GROUPED, "climb on the multilinear extension in closed form, then pipage rounding",
    "1 - (1 + 1/T)^-T with T steps (0.6302 for 100; 1 - 1/e in the limit) under a partition matroid or cardinality limit, "
    "for coverage and facility location; deterministic",
)  # fmt: skip
def continuous_greedy(problem: SubmodularSelection, context: Context, *, steps: int = 100) -> Outcome:
    """Raise the probabilities of the elements along the best bases, in ``steps`` equal steps (1 to 1,000,000), and round them by pipage.

    For coverage and facility location, whose expected value under independent draws has a closed form, so that nothing is sampled.
    Guaranteed ``f(S) >= (1 - (1 + 1/T)^-T) f(OPT)`` for T steps: 1/2 for T = 1, 0.6302 for T = 100, in the limit 1 - 1/e = 0.6321; without
    a guarantee where the time was up before the last step. Proved in docs/selection.md#what-is-proved-for-the-continuous-greedy.
    """
    if isinstance(steps, bool) or not isinstance(steps, int | np.integer) or not 1 <= steps <= MOST_STEPS:
        raise UsageError(f"steps must be a whole number from 1 to {MOST_STEPS:,}, not {steps!r}", "out-of-range")
    from .greedy_steps import multilinear_kernels as multilinear

    stop = context.begin()
    limits, given_weights = Limits.of(problem), problem.function.as_item_weights()
    assert given_weights is not None
    weights = _sparse(given_weights)
    if weights.layout == AT_ITEM:
        state, position = np.ones(weights.num_items), np.zeros(0, np.int64)
        by_item = np.zeros(1, np.int64), np.zeros(0, np.int32), np.zeros(0)
    else:
        position, by_item = _by_item(weights, stop)
        state = by_item[2].copy()  # the slope of an item's value when nothing is chosen
    count = np.zeros(problem.num_elements, np.int64)
    data = (state, position, *by_item, *weights.arrays[:4])
    bounds = np.full(problem.num_elements, np.inf)
    done = evaluations = 0
    while done < steps and not stop.reached():
        some = min(steps - done, max(1, int(2e5 // max(1, problem.num_elements))))
        evaluations += multilinear.climb(stop.flag, some, bounds, limits.groups, limits.room, limits.most, count, int(steps), data)
        done += 0 if stop.reached() else some
    expected = float(multilinear.value(stop.flag, count, int(steps), data))
    trades = 0 if stop.reached() else int(multilinear.pipage(stop.flag, *limits.members(), count, int(steps), data))
    if stop.reached():
        return _of_counts(problem, stop, limits, count, evaluations, done, int(steps))
    picks = np.nonzero(count == steps)[0].tolist()
    holds, _ = assumptions(problem)
    share = -math.expm1(-steps * math.log1p(1.0 / steps))
    loss = 1.0 - math.exp(-1.0) - share
    statement = f"f(S) >= (1 - (1 + 1/{steps})^-{steps}) f(OPT), that is {rounded_down(share)} f(OPT): "
    statement += f"1 - 1/e less {loss:.2g} for steps of 1/{steps}"
    guarantee = Guarantee(1.0 / share, statement, (*holds, f"{problem.constraint.name} constraint", f"all {steps} steps were made"), SOURCE)
    statistics = {"steps": int(steps), "evaluations": evaluations, "fractional_value": expected, "trades": trades}
    return concluded(problem, stop, picks, holds, guarantee, statistics, in_order=False)


def _by_item(
    weights: ItemWeights, stop: Stop
) -> tuple[NDArray[np.int64], tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.float64]]]:
    """The place of each entry in the transpose, and this with the elements of an item by falling weight; as far as the time goes."""
    from ...formulations.transpose_kernels import transpose

    items, everything = weights.num_items, np.arange(weights.entries, dtype=np.float64)
    starts, elements, entries = transpose(stop.flag, items, weights.indptr, weights.indices, everything)
    with np.errstate(invalid="ignore"):  # not filled where the time was up
        entries = entries.astype(np.int64)
    sorted_weights, position = np.empty(len(entries)), np.zeros(len(entries), np.int64)
    first = 0
    while first < items and not stop.reached():
        last = max(first + 1, int(np.searchsorted(starts, starts[first] + SORTED, side="right")) - 1)
        some = slice(int(starts[first]), int(starts[last]))
        values = weights.weights[entries[some]]
        order = np.lexsort((-values, np.repeat(np.arange(last - first), np.diff(starts[first : last + 1]))))
        elements[some], sorted_weights[some] = elements[some][order], values[order]
        position[entries[some][order]] = np.arange(some.start, some.stop)
        first = last
    return position, (starts, elements, sorted_weights)


def _of_counts(
    problem: SubmodularSelection, stop: Stop, limits: Limits, count: NDArray[np.int64], evaluations: int, done: int, steps: int
) -> Outcome:
    """The outcome where the time was up before the last step or trade: the elements of largest probability."""
    picks = limits.first(np.lexsort((np.arange(len(count)), -count))).tolist()
    statistics = {"steps": done, "evaluations": evaluations}
    message = f"{CUT_SHORT} after {done} of {steps} steps; the largest probabilities were taken"
    return concluded(problem, stop, picks, assumptions(problem)[0], None, statistics, message, whole=False, in_order=False)


def _sparse(weights: ItemWeights) -> ItemWeights:
    if weights.layout != IN_MATRIX:
        return weights
    entries = int(np.count_nonzero(weights.matrix))
    if entries > MOST_ENTRIES:
        raise UsageError(
            f"continuous-greedy keeps a number an entry: at most {MOST_ENTRIES:,} positive weights, not {entries:,}", "too-large"
        )
    element, item, weight = weights.edges()
    starts = np.searchsorted(element, np.arange(len(weights.matrix) + 1))
    return ItemWeights.sparse(AT_ENTRY, starts.astype(np.int32), item.astype(np.int32), weight, weights.num_items)
