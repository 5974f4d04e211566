"""Figures of the study on uncertain graphs."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from waybound.reports.missions.risk import _uncertain_graph_figures as figures
from waybound.reports.missions.risk.uncertain_graph_study import METHODS


@pytest.fixture
def walks():
    rng = np.random.default_rng(1)
    rows = [
        {"level": level, "method": method, "excess": e} for level in (5.0, "trees") for method in METHODS for e in rng.exponential(2.0, 20)
    ]
    return pd.DataFrame(rows)


@pytest.mark.slow
def test_methods_without_excess_are_drawn_too(tmp_path, walks):
    figures.histograms(walks.assign(excess=0.0), tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 1000


def test_a_walk_is_that_of_the_policy(tmp_path):
    world = figures._walked("a-star", 1, 2, vertices=15)
    assert world.metrics()["arrived"] == 1.0
    assert set(METHODS) < set(figures.COLOURS)
