import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from small_routing import plane, small

from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import NEVER
from waybound.solvers.bounds.routing.column_generation import ColumnGeneration
from waybound.solvers.bounds.routing.pricing import Pricer
from waybound.solvers.bounds.routing.route_levels import DONE, EXACT, FORGETFUL, NEARBY, SINGLE
from waybound.solvers.bounds.routing.set_partition import set_partition
from waybound.solvers.bounds.routing.subset_rows import SubsetRow

FEATURES = ("capacity", "time-windows", "service-times", "max-distance", "max-duration", "pickups")


def problem_of(feature: str, seed: int) -> RoutingProblem:
    """A small problem; with pickups, what is on board in between may be more than what is at either end."""
    if feature != "pickups":
        return small(feature, seed, "exact")
    problem = plane(seed, 5, 14.0)
    pickup = np.random.default_rng(seed).permutation(problem.sites.demand[problem.customers])
    return problem.altered(sites=replace(problem.sites, pickup=np.append(0.0, pickup)))


class Truth:
    """All walks of a small problem that keep its levels and come back to nobody whom they remember, and what they cost."""

    def __init__(self, pricer: Pricer, reduced: np.ndarray, near: np.ndarray, cuts: list[SubsetRow], fines: np.ndarray) -> None:
        self.ahead, self.reduced, self.near, self.cuts, self.fines = pricer.ends[0], reduced, near, cuts, fines
        self.walks: dict[tuple[int, ...], float] = {}
        self._extend((), self.ahead.start, 0.0, frozenset(), (0,) * len(cuts))

    def _extend(self, walk: tuple[int, ...], level: np.ndarray, cost: float, seen: frozenset[int], odd: tuple[int, ...]) -> None:
        last = walk[-1] if walk else 0
        for j in range(len(self.reduced)):
            if not math.isfinite(self.reduced[last, j]) or j in seen or (j == 0 and not walk):
                continue
            then = np.maximum(level + self.ahead.weight[:, last, j], self.ahead.lower[j])
            if (then > self.ahead.upper[j]).any():
                continue
            total = cost + self.reduced[last, j]
            if not self._fits_on_board((*walk, j)):
                continue
            if j == 0:
                self.walks[walk] = total
                continue
            flipped = []
            for cut, bit, fine in zip(self.cuts, odd, self.fines, strict=True):
                bit = bit if cut.memory[j] else 0
                if j in cut.customers:
                    total -= fine * bit
                    bit = 1 - bit
                flipped.append(bit)
            self._extend((*walk, j), then, total, frozenset(k for k in seen if self.near[j, k]) | {j}, tuple(flipped))

    def _fits_on_board(self, walk: tuple[int, ...]) -> bool:
        """Whether what is still to be delivered and what has been collected are never too much together."""
        for load, collected in enumerate(self.ahead.above.tolist()):
            if collected >= 0:
                delivered, taken = ([self.ahead.weight[r, i, j] for i, j in itertools.pairwise((0, *walk))] for r in (load, collected))
                if any(sum(delivered[k:]) + sum(taken[:k]) > self.ahead.upper[0, load] for k in range(len(walk) + 1)):
                    return False
        return True

    def over(self, i: int, j: int) -> float:
        return min((v for w, v in self.walks.items() if (i, j) in itertools.pairwise((0, *w, 0))), default=math.inf)


@pytest.mark.parametrize("feature", FEATURES)
@pytest.mark.parametrize("seed", range(draws(4)))
def test_the_cheapest_routes_are_found_and_the_cheapest_over_each_move(feature: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = problem_of(feature, seed)
    partition = set_partition(problem)
    assert partition is not None
    columns = ColumnGeneration(problem, partition, NEVER, lambda bound: False, 1)
    n, pricer = len(partition.row), columns.pricers[0]
    near = rng.random((n, n)) < 0.6
    near[1:, 1:] |= np.eye(n - 1, dtype=bool)
    cuts = []
    for _ in range(int(rng.integers(0, 4))):
        memory = rng.random(n) < 0.7
        customers = tuple(rng.choice(np.arange(1, n), min(3, n - 1), replace=False).tolist())
        memory[list(customers)] = True
        cuts.append(SubsetRow(customers, memory))
    fines = -rng.uniform(0.0, 10.0, len(cuts))
    reduced = columns.cost[0].copy()
    reduced[:, 1:] -= np.where(rng.random(n - 1) < 0.8, rng.uniform(0.0, 1.2, n - 1), 0.0) * columns.dearest
    pricer.restrict(np.isfinite(reduced), near, cuts)
    truth = Truth(pricer, reduced, near, cuts, fines)
    least = min(truth.walks.values(), default=math.inf)
    close = 1e-6 * columns.dearest
    for both, halfway in itertools.product((True, False), (0.2, 0.5, 0.9)):
        pricer.bidirectional, pricer.halfway = both, int(halfway * pricer.top[0])
        for below in (math.inf, 0.0):
            status, value, totals, routes = pricer.search(NEVER, reduced, fines, EXACT, 10, below)
            assert status == DONE
            assert value == pytest.approx(least, abs=close) and (totals[:-1] <= totals[1:]).all()
            for route, total in zip(routes, totals.tolist(), strict=True):
                assert truth.walks[tuple(route.tolist())] == pytest.approx(total, abs=close) and total < below
            assert len(routes) or least >= below or least == math.inf
    for how in (NEARBY, FORGETFUL, SINGLE):
        _, value, totals, routes = pricer.search(NEVER, reduced, fines, how, 10, 0.0)
        assert value >= least - close
        assert all(truth.walks[tuple(r.tolist())] == pytest.approx(t, abs=close) for r, t in zip(routes, totals.tolist(), strict=True))
    below = least + columns.dearest if math.isfinite(least) else 0.0
    costs = pricer.arc_costs(NEVER, reduced, fines, below)
    assert costs is not None
    for i, j in np.argwhere(np.isfinite(reduced)).tolist():
        if (i, j) != (0, 0):
            assert costs[i, j] == pytest.approx(min(below, truth.over(i, j)), abs=close), (i, j)
