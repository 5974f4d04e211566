"""Bound ``item-prices``: the facility-location relaxation of a large problem by a primal-dual method, without a linear program.

Choices x of elements and prices p of items play

    min over p >= 0, max over x:   sum_j p_j + sum_e x_e sum_j max(0, c_ej - p_j),     0 <= x <= 1, groups within their limits,

whose value is that of the linear relaxation. Either side's best answer is a closed form: of x the sum of the largest worths of each group,
which is what the checker makes of the prices, of p the fractional credit of each item. Both are the method's own measure of its gap.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.evidence import Evidence
from ....formulations.problem import Problem
from ....formulations.sata.submodular_selection import SubmodularSelection
from ....formulations.stop import NEVER, Stop
from ....formulations.verified_bounds import verified_bound
from ....instances.sata.set_functions import IN_MATRIX, Floats
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from ..linear_relaxation import SMALL
from .marginal_gains import best_sum

GAP = 5e-7
"""Relative distance from the relaxation's value at which the prices are good enough: half of what is told apart from an optimum."""

ROUND = 50
"""Steps between two looks at the gap."""

FIRST_WEIGHT = 3.0
"""Length of the first steps of the choices, in parts of that which is as long as the prices' in their own units."""

FALL, PATIENCE = 0.5, 0.5
"""A restart comes once the gap has fallen by that factor, or after that share of all steps."""

NEGLIGIBLE = 2.0**-60
"""Part of the largest weight below which a weight is left out; the bound is at least the largest weight, and the checker counts all.
Weights of elements that no answer may choose, in groups of limit 0, are left out first."""


class PriceGame:
    """The two sides of the relaxation, their steps, and the best that they have come to.

    The primal-dual hybrid gradient method: prices go to their proximal point, a closed form, and choices follow their worths, extrapolated.
    Steps are as long as the diagonal preconditioners of Pock and Chambolle (2011) allow. Restarts, at the mean where that is better,
    weigh the sides' steps anew, as in PDLP (Applegate et al. 2021). ``prices`` are the best so far, ``bound`` is what they prove and
    ``value`` what the best fractional choices are worth, all in parts of ``unit``, a power of two.

    Source: Chambolle and Pock (2011) for linear couplings, Hamedani and Aybat (2021) for this one; docs/saddle.md#prices-of-items.
    """

    def __init__(self, problem: SubmodularSelection) -> None:
        weights, partition = problem.function.as_item_weights(), problem.constraint.as_partition(problem.num_elements)
        assert weights is not None and partition is not None
        groups, count = np.asarray(partition.groups), np.bincount(partition.groups, minlength=len(partition.limits))
        self._limits = np.minimum(partition.limits, count).astype(np.float64)
        element, item, weight = weights.edges()
        weight = np.where(self._limits[groups[element]] > 0.0, weight, 0.0)
        self.unit = float(np.ldexp(1.0, int(np.frexp(weight.max(initial=0.0))[1]) - 1))
        weight = weight / self.unit
        kept = weight > NEGLIGIBLE
        self._element, self._item, self._weight = element[kept], item[kept], weight[kept]
        self._n, self._m, self._partition = problem.num_elements, weights.num_items, partition
        falling = np.lexsort((-self._weight, self._item))
        of_item = np.bincount(self._item, minlength=self._m)
        self._falling = self._element[falling], self._weight[falling], np.repeat(_starts(of_item)[:-1], of_item)
        self._arrays = (
            _starts(np.bincount(self._element, minlength=self._n)), self._item.astype(np.int32), self._weight, _starts(of_item),
            self._falling[0].astype(np.int32), self._falling[1], _starts(count), np.argsort(groups, kind="stable").astype(np.int32),
            self._limits,
        )  # fmt: skip
        mean = np.bincount(self._item, self._weight, self._m) / np.maximum(of_item, 1)
        load, heaviest = np.bincount(self._element, mean[self._item], self._n), np.zeros(len(count))
        np.maximum.at(heaviest, groups, load)
        self._item_step = mean / np.maximum(of_item, 1)
        self._group_step = np.where(heaviest > 0.0, 1.0, 0.0) / np.where(heaviest > 0.0, heaviest, 1.0)
        self._groups, self._balance = groups, FIRST_WEIGHT
        self._chosen, self._prices = (self._limits / np.maximum(count, 1))[groups], np.zeros(self._m)
        self._thresholds, self._worth = np.zeros(len(count)), self._worths(self._prices)
        self._started, self._means = (self._chosen.copy(), self._prices.copy()), (np.zeros(self._n), np.zeros(self._m))
        self._since, self._last_gap = 0, np.inf
        self.steps, self.value, self.bound, self.prices = 0, 0.0, np.inf, self._prices
        self._look(self._chosen, self._prices)

    def run(self, stop: Stop, most: float = np.inf) -> None:
        """Play until the gap is ``GAP``, ``stop`` is reached, or ``most`` steps are made."""
        from .price_kernels import steps

        while not self.closed() and self.steps < most and not stop.reached():
            lengths = self._item_step / self._balance, self._group_step * self._balance
            self._since += steps(
                stop.flag, *self._arrays, *lengths, self._chosen, self._prices, self._worth, *self._means, self._thresholds, self._since,
                ROUND,
            )  # fmt: skip
            self.steps += ROUND
            here, mean = self._look(self._chosen, self._prices), self._look(*self._means)
            if min(here, mean) < FALL * self._last_gap or self._since > PATIENCE * self.steps:
                self._last_gap, self._since = min(here, mean), 0
                if mean < here:
                    self._chosen[:], self._prices[:] = self._means
                    self._worth = self._worths(self._prices)
                self._weigh(*self._started)
                self._started = self._chosen.copy(), self._prices.copy()

    def closed(self) -> bool:
        """Whether the prices prove as much as the relaxation can, but for ``GAP``."""
        return self.bound - self.value <= GAP * self.value

    def _look(self, chosen: Floats, prices: Floats) -> float:
        """Gap between what ``chosen`` is worth and ``prices`` prove; the best of both are kept."""
        bound, value = float(prices.sum()) + best_sum(self._partition, None, self._worths(prices)), self._credit(chosen)
        self.value = max(self.value, value)
        if bound < self.bound:
            self.bound, self.prices = bound, prices.copy()
        return bound - value

    def _worths(self, prices: Floats) -> Floats:
        return np.bincount(self._element, np.maximum(self._weight - prices[self._item], 0.0), self._n).astype(np.float64)

    def _credit(self, chosen: Floats) -> float:
        """Value of the relaxation for these choices: each item is credited from its largest weight down, one unit in all."""
        element, weight, first = self._falling
        share = chosen[element]
        before = np.concatenate([[0.0], np.cumsum(share)])
        return float(weight @ np.clip(1.0 - (before[:-1] - before[first]), 0.0, share))

    def _weigh(self, chosen: Floats, prices: Floats) -> None:
        """Weigh the sides' steps by how far either came since the last restart."""
        priced, heavy = self._item_step > 0.0, self._group_step[self._groups] > 0.0
        far = np.sqrt(np.sum((self._chosen - chosen)[heavy] ** 2 / self._group_step[self._groups][heavy]))
        wide = np.sqrt(np.sum((self._prices - prices)[priced] ** 2 / self._item_step[priced]))
        if far > 0.0 and wide > 0.0:
            self._balance = float(np.sqrt(self._balance * far / wide))


def _starts(counts: NDArray[np.integer[Any]]) -> NDArray[np.int32]:
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)


def evidence_of(problem: SubmodularSelection, game: PriceGame) -> Evidence:
    """The evidence of the best prices of a game, and what it proves."""
    reached = "the value of the linear relaxation" if game.closed() else "a bound on the linear relaxation"
    evidence = Evidence("item-prices", f"prices of items, {reached}", np.inf, {"prices": (game.prices * game.unit).tolist()})
    return replace(evidence, value=verified_bound(problem, evidence))


def _lacks(problem: SubmodularSelection) -> frozenset[str]:
    weights = problem.function.as_item_weights()
    if weights is None or weights.layout == IN_MATRIX:
        return frozenset({"a function that is not given by weights of single items"})
    if problem.constraint.as_partition(problem.num_elements) is None:
        return frozenset({"a constraint other than a limit for each group"})
    return frozenset({f"fewer than {SMALL} weights, which a linear program settles"}) if weights.entries <= SMALL else frozenset()


@bound_method(
    "item-prices", of_family("selection", _lacks), order=2, kernels=("waybound.solvers.bounds.sata.price_kernels",),
    replaces=lambda problem: frozenset() if problem.family != "selection" or _lacks(problem) else frozenset({"linear-relaxation"}),
)  # fmt: skip
def item_prices_bound(problem: Problem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence ``item-prices`` from a ``PriceGame``, the best that it has when ``stop`` is reached; None where that was before."""
    if stop.reached():
        return None
    selection: SubmodularSelection = problem  # type: ignore[assignment]
    game = PriceGame(selection)
    game.run(stop)
    return evidence_of(selection, game)
