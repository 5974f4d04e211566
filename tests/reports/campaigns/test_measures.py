import math

import numpy as np
import pandas as pd
import pytest

from waybound.reports.campaigns.measures import performance_profile, primal_gap, primal_integral, shifted_geometric_mean


def test_a_shifted_geometric_mean_is_the_geometric_one_without_a_shift_and_less_moved_by_extremes_with_one() -> None:
    assert shifted_geometric_mean([1.0, 100.0], 0.0) == pytest.approx(10.0)
    assert shifted_geometric_mean([0.0, 3.0]) == pytest.approx(1.0)
    assert shifted_geometric_mean([1e-6, 1e-2], 1.0) == pytest.approx(5e-3, rel=1e-2)
    assert math.isnan(shifted_geometric_mean([]))


def test_a_profile_tells_the_share_of_cases_within_each_factor_of_the_best() -> None:
    costs = pd.DataFrame({"a": [1.0, 4.0, np.nan, np.nan], "b": [2.0, 2.0, 5.0, np.nan]})
    made = performance_profile(costs)
    assert made.index.tolist() == [1.0, 2.0]
    assert made["a"].tolist() == [0.25, 0.5] and made["b"].tolist() == [0.5, 0.75]
    assert performance_profile(costs, [1.5])["b"].tolist() == [0.5]


def test_costs_of_nothing_are_equal_and_empty_profiles_are_empty() -> None:
    assert performance_profile(pd.DataFrame({"a": [0.0], "b": [0.0]}))["a"].tolist() == [1.0]
    assert performance_profile(pd.DataFrame({"a": [], "b": []}, dtype=float)).empty


def test_primal_gaps_are_those_of_the_source() -> None:
    assert primal_gap([10.0, 5.0, 0.0, -5.0], 5.0).tolist() == [0.5, 0.0, 1.0, 1.0]
    assert primal_gap([0.0], 0.0).tolist() == [0.0]


def test_a_primal_integral_sums_the_gap_over_time() -> None:
    assert primal_integral([1.0, 3.0], [10.0, 5.0], 5.0, 10.0) == pytest.approx(1.0 + 0.5 * 2.0)
    assert primal_integral([], [], 5.0, 10.0) == 10.0
    assert primal_integral([20.0], [5.0], 5.0, 10.0) == 10.0
