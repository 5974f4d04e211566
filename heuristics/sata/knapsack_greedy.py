"""Knapsack greedy: gain per cost, begun afresh from every small set."""

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...formulations.evidence import Guarantee
from ...formulations.sata.feasibility import in_budgets
from ...formulations.sata.selections import Selection
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...formulations.stop import Stop
from ...formulations.tolerance import room
from ...instances.errors import UsageError
from ...instances.sata.set_functions import Floats, ItemWeights
from ...solvers.bounds.sata.growing_sets import GrowingSet, ValuedSet, WeightedSet
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .greedy_steps.limits import ANY_FUNCTION
from .greedy_steps.outcomes import assumptions, concluded, rounded_down, sentences

WORK, USER_WORK = 300_000_000, 300_000
"""Entries of the data, or sets of a user's function, up to which ``enumerate`` is deepened by itself: about a second."""


LEAST_COST = 1e-250
"""In parts of the budget: for smaller ones gains per cost may overflow, and nothing is guaranteed."""


HALF = 0.5 * (1.0 - math.exp(-1.0))
FULL = 1.0 - math.exp(-1.0)
PROVED = {
    0: (HALF, "((1 - 1/e) / 2)", "Khuller, Moss and Naor (1999), The budgeted maximum coverage problem; Leskovec et al. (2007), "
        "Cost-effective outbreak detection in networks, for every monotone submodular function"),
    2: (FULL, "(1 - 1/e)", "Kulik, Schwartz and Shachnai (2021), A refined analysis of submodular greedy"),
    3: (FULL, "(1 - 1/e)", "Sviridenko (2004), A note on maximizing a submodular set function subject to a knapsack constraint"),
}  # fmt: skip
PROVED[1] = PROVED[0]


@heuristic(
    "knapsack-greedy", "selection", ANY_FUNCTION | {"constraint:knapsack"},
    "gain per cost, from every starting set of up to three elements",
    "1 - 1/e from starting sets of 3 (Sviridenko) or 2 elements, (1 - 1/e)/2 from 1 or 0, for monotone submodular functions",
)  # fmt: skip
def knapsack_greedy(problem: SubmodularSelection, context: Context, *, enumerate: int | None = None) -> Outcome:  # noqa: A002
    """Fill the knapsack by gain per cost, from every starting set of up to ``enumerate`` elements (0 to 3); the best filling wins.

    By default the starting sets are as large as takes about a second (3 up to some hundred elements). ``PROVED`` holds what is guaranteed
    by their size; after the time limit, by that of the sizes that were finished. With 0 the best single element is the second candidate.
    Sharper analyses of 0 (0.405, Tang et al. 2021) are not drawn on; nor is the 0.6174 of Feldman, Nutov and Shoham (2023) for one element,
    which is proved for a variant. Elements without cost are taken at once; those that do not fit are passed over. Ties go to the smallest
    index.
    """
    if enumerate is not None and (isinstance(enumerate, bool) or not isinstance(enumerate, int | np.integer) or not 0 <= enumerate <= 3):
        raise UsageError(f"enumerate must be 0, 1, 2 or 3, not {enumerate!r}", "out-of-range")
    c = problem.constraint.as_knapsack()
    assert c is not None
    costs, budget = in_budgets(c.costs, room(c.costs, c.budget))
    usable = np.nonzero((costs > 0) & (costs <= budget))[0]
    weights = problem.function.as_item_weights()
    depth = _affordable(weights, len(usable)) if enumerate is None else int(enumerate)
    stop = context.begin()
    free = np.nonzero(c.costs == 0)[0].tolist()
    filling = (
        _ValuedFilling(ValuedSet(problem.function), free, costs, budget, stop) if weights is None
        else _WeightedFilling(WeightedSet(weights), free, costs, budget, stop)
    )  # fmt: skip
    best, picks = filling.after(np.zeros(0, np.int64), -1, 0, -1.0)
    if len(usable):
        best, picks = filling.single(usable, best, picks)
    starts, finished, begun_whole = 1, 0, not stop.reached()
    for size in range(1, depth + 1):
        for begun, lo, hi in _starts(usable, size, len(c.costs)):
            value, filled = filling.after(begun, lo, hi, best)
            starts += int(np.searchsorted(usable, hi) - np.searchsorted(usable, lo))
            if len(filled):
                best, picks = value, filled
                context.publish(Selection((*free, *picks), in_order=True))
            if stop.reached():
                break
        else:
            finished = size
            continue
        break
    holds, message = assumptions(problem)
    if not begun_whole:
        message = sentences(message, f"ended before the first filling: {CUT_SHORT}")
    elif finished < depth:
        message = sentences(message, f"the time was up among the starting sets of {finished + 1} elements")
    guarantee: Guarantee | None = None
    if holds and begun_whole and (not len(usable) or costs[usable].min() > LEAST_COST):
        share, words, source = PROVED[finished]
        statement = f"f(S) >= {words} f(OPT), that is {rounded_down(share)} f(OPT)"
        guarantee = Guarantee(1.0 / share, statement, (*holds, f"knapsack; all starting sets of up to {finished} elements"), source)
    statistics = {"enumerate": finished, "starts": starts}
    whole = begun_whole and finished == depth
    return concluded(problem, stop, [*free, *picks], holds, guarantee, statistics, message, whole=whole)


def _affordable(weights: ItemWeights | None, n: int) -> int:
    entries, limit = (n, USER_WORK) if weights is None else (weights.entries, WORK)
    return max((q for q in range(4) if sum(math.comb(n, i) for i in range(q + 1)) * (entries + n) <= limit), default=0)


def _starts(usable: NDArray[np.int64], size: int, n: int) -> Iterator[tuple[NDArray[np.int64], int, int]]:
    """All sets of ``size`` elements, as ascending ones to begin with and a range for the last."""
    if size == 1:
        for lo in range(0, n, 64):
            yield np.zeros(0, np.int64), lo, min(n, lo + 64)
    else:
        for begun in itertools.combinations(usable.tolist(), size - 1):
            yield np.array(begun, np.int64), begun[-1] + 1, n


class _Filling(ABC):
    """Fillings of a knapsack beside the elements ``free``."""

    def __init__(self, begun: GrowingSet, free: list[int], costs: Floats, budget: float, stop: Stop) -> None:
        self.free, self.costs, self.budget, self.stop = free, costs, budget, stop
        if free:
            begun.add(free)
        self.begun = begun

    def single(self, usable: NDArray[np.int64], most: float, picks: list[int]) -> tuple[float, list[int]]:
        """The best single element, if it is worth more than ``most``, the value of ``picks``."""
        element, gain = self.begun.best_of(usable, self.stop)
        return (self.begun.value + gain, [element]) if element >= 0 and self.begun.value + gain > most else (most, picks)

    @abstractmethod
    def after(self, begun: NDArray[np.int64], lo: int, hi: int, most: float) -> tuple[float, list[int]]:
        """The best filling that starts with ``begun`` and an element from ``lo`` to ``hi``; see ``fill_after``."""


class _WeightedFilling(_Filling):
    """Fillings for functions given by the weights of items."""

    begun: WeightedSet

    def after(self, begun: NDArray[np.int64], lo: int, hi: int, most: float) -> tuple[float, list[int]]:
        from .greedy_steps.filling_kernels import fill_after

        value, picks = fill_after(self.stop.flag, begun, lo, hi, most, self.begun.best, self.costs, self.budget, *self.begun.arrays)
        return float(value), picks.tolist()


class _ValuedFilling(_Filling):
    """Fillings for a function known by its values, all gains of a round in one call."""

    begun: ValuedSet

    def after(self, begun: NDArray[np.int64], lo: int, hi: int, most: float) -> tuple[float, list[int]]:
        winner: list[int] = []
        for e in range(lo, hi):
            if self.stop.reached():
                break
            picks = [*begun.tolist(), *([e] if e >= 0 else [])]
            budget = self.budget - math.fsum(self.costs[picks])
            if budget < 0 or (e >= 0 and self.costs[e] == 0):
                continue
            chosen = ValuedSet(self.begun.function)
            if self.free or picks:
                chosen.add([*self.free, *picks])
            while len(able := np.nonzero((self.costs > 0) & (self.costs <= budget) & ~chosen.inside)[0]):
                gains = chosen.gains(able, self.stop)
                at = int(np.argmax(gains / self.costs[able]))
                if not gains[at] > 0:
                    break
                chosen.take(int(able[at]), float(gains[at]))
                picks.append(int(able[at]))
                budget -= float(self.costs[able[at]])
            if chosen.value > most:
                most, winner = chosen.value, picks
        return most, winner
