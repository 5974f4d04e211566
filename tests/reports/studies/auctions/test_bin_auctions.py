import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from waybound.reports.studies.auctions import bin_auctions as families

FAMILIES = [families.TRAVEL, families.FEWER_ROBOTS, families.ARBITRARY, families.SERIAL_LINES, families.GREEDY_LINES]


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_optima_are_attained_and_no_better_answer_is_known(family: families.Family) -> None:
    for k in range(min(20, family.count(20))):
        case = family.case(k, 3)
        assert case.optimum is not None
        costs = case.problem.matrix()
        assert case.optimum.value == pytest.approx(costs[linear_sum_assignment(costs)].sum(), abs=1e-9)


def test_costs_of_travel_keep_the_quadrangle_inequality() -> None:
    for k in range(30):
        costs = families.TRAVEL.case(k, 5).problem.matrix()
        n, m = costs.shape
        i, k_, j, l = np.ix_(range(n), range(n), range(m), range(m))  # noqa: E741
        assert (costs[i, j] <= costs[i, l] + costs[k_, l] + costs[k_, j] + 1e-9).all()
