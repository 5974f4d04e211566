"""Figures of the orchard study."""

from __future__ import annotations

import pandas as pd
import pytest

from waybound.reports.missions.auctions import _orchard_figures as figures
from waybound.reports.missions.auctions.orchard_study import METHODS


@pytest.mark.slow
def test_one_row_a_number_of_groups_is_drawn(tmp_path):
    steps = pd.DataFrame(
        {"groups": g, "robots": m, "method": method, "least": 50, "steps": 400 / m, "steps_half": 3.0}
        for g in (4, 8) for m in (2, 3) for method in METHODS
    )  # fmt: skip
    effects = pd.DataFrame(
        {"groups": g, "robots": m, **dict.fromkeys(figures.EFFECTS, 1.0), **{f"{name} half": 0.2 for name in figures.EFFECTS}}
        for g in (4, 8) for m in (2, 3)
    )  # fmt: skip
    figures.ablation(steps, effects, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert set(figures.COLOURS) == set(METHODS)
