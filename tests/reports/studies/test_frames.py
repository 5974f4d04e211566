"""Means of studies and their intervals; records and markdown are those of the tracking study."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from waybound.reports.missions._study_tables import mean_interval


def test_intervals_are_students():
    values = np.array([1.0, 4.0, 2.0, 8.0])
    mean, half = mean_interval(values)
    low, high = stats.t.interval(0.95, 3, loc=values.mean(), scale=stats.sem(values))
    assert (mean - half, mean + half) == pytest.approx((low, high))


def test_they_hold_the_mean_as_often_as_they_say():
    rng = np.random.default_rng(1)
    held = [abs(mean - 5.0) <= half for mean, half in (mean_interval(rng.normal(5.0, 2.0, 6)) for _ in range(2000))]
    assert np.mean(held) == pytest.approx(0.95, abs=0.02)


def test_one_value_has_none():
    assert mean_interval([3.0])[0] == 3.0
    assert math.isnan(mean_interval([3.0])[1])
