"""Figures of the study on information gathering."""

from __future__ import annotations

import pandas as pd
import pytest

from waybound.reports.missions.auctions import _gathering_figures as figures
from waybound.reports.missions.auctions.information_gathering_study import METHODS, METRICS


@pytest.mark.slow
def test_three_metrics_are_drawn(tmp_path):
    rows = [
        {"robots": m, "method": method, **{f"{name}{end}": 1.0 for name in METRICS for end in ("", "_half", "_above", "_above_half")}}
        for m in (2, 3) for method in METHODS
    ]  # fmt: skip
    figures.metrics(pd.DataFrame(rows), tmp_path / "figure.png")
    assert (tmp_path / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert set(figures.COLOURS) == set(METHODS)
    assert set(figures.TITLES) == set(METRICS)
