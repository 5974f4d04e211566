"""Figures of the tracking study hold the numbers of its tables."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from waybound.reports.missions.sata import _tracking_figures as figures


@pytest.fixture
def kept(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The figures that were saved, as objects."""
    made: list[Any] = []
    save = figures._save
    monkeypatch.setattr(figures, "_save", lambda figure, path: (made.append(figure), save(figure, path)))
    return made


def heights(ax: Any) -> list[float]:
    return [round(float(patch.get_height()), 6) for patch in ax.patches]


def test_bars_are_the_means_of_each_method_and_number_of_targets(kept: list[Any], tmp_path: Path) -> None:
    columns = {f"{key}_{what}": [1.0 + k + (what == "std") / 10 for k in range(4)] for key in "abc" for what in ("mean", "std")}
    table = pd.DataFrame({"targets": [10, 10, 5, 5], "method": ["greedy", "random"] * 2, **columns})
    figures.parker(table, tmp_path / "parker.png")
    (figure,) = kept
    assert [ax.get_title(loc="left")[:3] for ax in figure.axes] == ["(a)", "(b)", "(c)"]
    for ax in figure.axes:
        assert heights(ax) == [3.0, 1.0, 4.0, 2.0]  # greedy at 5 and 10 targets, then random
        assert [label.get_text() for label in ax.get_xticklabels()] == ["5", "10"]
    assert (tmp_path / "parker.png").read_bytes().startswith(b"\x89PNG")


def test_estimates_stand_over_what_came_true(kept: list[Any], tmp_path: Path) -> None:
    logs = pd.DataFrame({
        "method": ["binary", "binary", "inverse-distance"], "estimated_targets": [3, 4, 5], "actual_targets": [2, 4, 5],
        "estimated_value": [2.0, 4.0, 8.0], "actual_value": [1.0, 4.0, 4.0],
    })  # fmt: skip
    figures.weights(logs, tmp_path / "weights.png")
    counts, values = kept[0].axes
    assert [line.get_xydata().tolist() for line in counts.lines[:2]] == [[[2, 3], [4, 4]], [[5, 5]]]
    assert [line.get_xydata().tolist() for line in values.lines[:2]] == [[[0.25, 0.5], [1.0, 1.0]], [[0.5, 1.0]]]


def test_methods_without_candidates_have_no_share_but_what_they_observed(kept: list[Any], tmp_path: Path) -> None:
    table = pd.DataFrame({
        "method": ["local", "stay"], "share_estimated": [0.8, None], "share_actual": [0.6, None], "observed": [5.0, 3.0],
        "observed_std": [0.5, 0.1],
    })  # fmt: skip
    figures.bottleneck(table, tmp_path / "bottleneck.png")
    shares, observed = kept[0].axes
    assert heights(shares) == [0.8, 0.6] and heights(observed) == [5.0, 3.0]
    assert [label.get_text() for label in observed.get_xticklabels()] == ["local", "stay"]


def test_every_method_of_the_study_has_a_colour() -> None:
    from waybound.reports.missions.sata import tracking_study as study

    assert set(study.PARKER) <= set(figures.COLOURS)
