import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from waybound.reports.missions.auctions.orchard_days import choice_kernels as kernels


def matrices(count, most):
    rng = np.random.default_rng(7)
    for _ in range(count):
        shape = rng.integers(1, 7, 2)
        yield rng.integers(0, most, shape)


def total(costs, plan):
    chosen = [j for j in plan.tolist() if j >= 0]
    assert len(chosen) == len(set(chosen)) == min(costs.shape)
    return int(sum(costs[i, j] for i, j in enumerate(plan.tolist()) if j >= 0))


@pytest.mark.parametrize("most", [4, 1000])
def test_assignments_are_the_least(most):
    for costs in matrices(300, most):
        assert total(costs, kernels.assignment(costs)) == costs[linear_sum_assignment(costs)].sum()


@pytest.mark.parametrize("most", [4, 1000])
def test_the_deferred_auction_takes_the_cheapest_pairs_first(most):
    for costs in matrices(300, most):
        plan, robots, bins = np.full(len(costs), -1), set(), set()
        for _, i, j in sorted((int(costs[i, j]), i, j) for i in range(costs.shape[0]) for j in range(costs.shape[1])):
            if i not in robots and j not in bins:
                plan[i] = j
                robots.add(i)
                bins.add(j)
        assert kernels.deferred(costs).tolist() == plan.tolist()


@pytest.mark.parametrize(
    ("costs", "deferred", "immediate", "serial", "beaten"),
    [
        ([[2, 5, 9], [4, 3, 8], [7, 6, 4]], 9, 9, 9, False),
        ([[4, 6, 5], [4, 9, 5]], 9, 9, 9, False),
        ([[3, 7], [2, 6], [4, 5]], 7, 7, 9, False),
        ([[1, 2, 2], [1, 2, 2]], 3, 3, 3, False),
        ([[1, 2], [2, 5]], 6, 6, 6, True),
        ([[0, 1], [1, 100]], 100, 100, 100, True),
        ([[1, 4, 9], [2, 3, 9], [9, 5, 6]], 10, 15, 10, False),
        ([[10, 12, 19, 11], [5, 10, 7, 8], [12, 14, 13, 11], [8, 15, 11, 9]], 39, 39, 43, True),
        ([[9, 11, 332], [11, 31, 352], [180, 160, 161]], 201, 521, 201, True),
    ],
)
def test_auctions_of_the_reference(costs, deferred, immediate, serial, beaten):
    matrix = np.array(costs)
    assert total(matrix, kernels.deferred(matrix)) == deferred
    assert total(matrix, kernels.immediate(matrix)) == immediate
    assert total(matrix, kernels.serial(matrix, np.zeros_like(matrix))) == serial
    assert kernels.beaten(matrix, kernels.deferred(matrix)) == beaten


def test_only_what_is_beaten_is_called_so():
    for costs in matrices(300, 6):
        plan = kernels.deferred(costs)
        assert kernels.beaten(costs, plan) == (total(costs, plan) > costs[linear_sum_assignment(costs)].sum())
        assert not kernels.beaten(costs, kernels.assignment(costs))
