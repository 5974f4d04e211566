import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from campaign_cases import outcome, planned
from coded import coded

from waybound import UsageError, results
from waybound.reports.campaigns.counting import counted
from waybound.reports.campaigns.paired_tests import against, paired, paired_table, relative
from waybound.reports.campaigns.results_file import ResultsFile


def test_the_interval_is_students_and_covers_a_mean_of_noise() -> None:
    noise = np.random.default_rng(1).normal(0.0, 1.0, 50)
    made = paired(noise)
    assert made.low < 0.0 < made.high and made.mean == pytest.approx(noise.mean()) and made.p_value > 0.05
    half = 2.0095752 * noise.std(ddof=1) / math.sqrt(50)  # the quantile of Student's t, 49 degrees of freedom
    assert (made.low, made.high) == pytest.approx((made.mean - half, made.mean + half), rel=1e-6)
    assert paired(noise + 2.0).low > 0.0 and paired(noise + 2.0).p_value < 1e-6


def test_without_noise_the_interval_is_a_point_and_of_one_pair_nothing_is_known() -> None:
    assert (paired([0.1] * 4).low, paired([0.1] * 4).high) == (0.1, 0.1)
    assert paired([0.0] * 4).p_value == 1.0 and paired([0.0] * 4).high == 0.0
    assert (paired([0.1]).low, paired([0.1]).high) == (-math.inf, math.inf)


def test_methods_are_compared_on_what_both_answered_with_instances_as_pairs(tmp_path: Path) -> None:
    with ResultsFile(tmp_path / "r.sqlite") as file:
        for name, sense, worse in (("a", "min", 1.1), ("b", "max", 0.8)):
            for seed in (1, 2, 3):
                file.add(planned(name, seed=seed), outcome(10.0, sense=sense))
                file.add(planned(name, "other", seed), outcome(10.0 * worse if seed < 3 else None, sense=sense))
    runs = counted(results(tmp_path / "r.sqlite"))
    made = against(runs, "savings")
    assert made["method"].tolist() == ["other"] and made["pairs"].tolist() == [2]
    assert made["mean"].tolist() == [pytest.approx(0.15)]
    assert "+15 %" in paired_table(made, "savings").rows[0]
    with pytest.raises(UsageError, match="did you mean 'savings'", check=coded("unknown-name")):
        against(runs, "saving")


def test_what_was_nothing_is_compared_with_what_it_is_now() -> None:
    assert relative(pd.Series([5.0, 0.0, -0.001, 3.0]), pd.Series([0.0, 0.0, 0.0, 2.0])).tolist() == [1.0, 0.0, -1.0, 0.5]
    assert np.isnan(relative(pd.Series([np.nan, 1.0]), pd.Series([1.0, np.nan]))).all()
