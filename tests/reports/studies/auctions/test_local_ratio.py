import numpy as np
import pytest
from knapsack_assignments import enumerated

from waybound.reports.studies.auctions import local_ratio as families


def test_random_optima_are_those_of_exact_enumeration() -> None:
    for k in range(20):
        case = families.RANDOM_PROFITS.case(k, 3)
        if case.problem.num_jobs <= 6:
            assert case.optimum.value == pytest.approx(enumerated(case.problem))


def test_stolen_jobs_are_worth_nearly_two_a_pair() -> None:
    assert families.stolen(1).optimum.value == enumerated(families.stolen(1).problem) == pytest.approx(2.0)
    assert families.STOLEN_JOBS.size == 8 and np.isfinite(families.stolen(4).problem.instance.values).sum() == 12
