"""The orchard study, in its short form, and what it must show."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from waybound.reports.missions.auctions import orchard_study as study


@pytest.mark.long
def test_the_short_study_writes_tables_and_figures(tmp_path, capsys):
    assert study.main(["--out", str(tmp_path / "made"), "--short"]) == 0
    text = capsys.readouterr().out
    names = {path.name for path in (tmp_path / "made").iterdir()}
    assert names == {"steps.csv", "effects.csv", "auctions.csv", "small.csv", "days.csv", "small_days.csv", "orchard.png", "summary.md"}
    assert (tmp_path / "made" / "summary.md").read_text() == text
    days = pd.read_csv(tmp_path / "made" / "days.csv")
    assert (days["steps"] >= days["least"]).all()
    steps = pd.read_csv(tmp_path / "made" / "steps.csv").set_index(["robots", "method"])
    own = days[(days["robots"] == 8) & (days["method"] == "auction+baseline")]["steps"]
    assert steps.loc[(8, "auction+baseline"), "steps"] == pytest.approx(own.mean())
    assert steps.loc[(8, "auction+baseline"), "steps_half"] == pytest.approx(4.302652729911275 * own.std() / np.sqrt(3))  # t of 2 degrees
    small = pd.read_csv(tmp_path / "made" / "small_days.csv")
    assert (small["status"] == "optimal").all()
    for method in study.METHODS:
        assert (small[method] >= small["optimum"]).all()


def test_effects_are_taken_day_by_day():
    rows = [
        {"groups": 4, "robots": 2, "seed": seed, "method": method, "steps": 100 - 10 * k - seed}
        for seed in (1, 2, 3)
        for k, method in enumerate(study.METHODS)
    ]
    row = study.effects_table(pd.DataFrame(rows)).iloc[0]
    assert row["both"] == pytest.approx(np.mean([100 * 30 / (100 - seed) for seed in (1, 2, 3)]))
    assert row["both wins"] == 1.0


def test_runs_of_numbers_are_told_shortly():
    assert study._ranges([2, 3, 4, 7, 9, 10]) == "2-4, 7, 9-10"
    assert study._ranges([]) == "no"


def test_sizes_are_the_sources():
    size = study.Size()
    assert (size.robots, size.groups, size.days) == (tuple(range(2, 21)), (4, 8), 100)


@pytest.mark.slow
def test_one_row_a_number_of_groups_is_drawn(tmp_path):
    steps = pd.DataFrame(
        {"groups": g, "robots": m, "method": method, "least": 50, "steps": 400 / m, "steps_half": 3.0}
        for g in (4, 8) for m in (2, 3) for method in study.METHODS
    )  # fmt: skip
    effects = pd.DataFrame(
        {"groups": g, "robots": m, **dict.fromkeys(study.EFFECTS, 1.0), **{f"{name} half": 0.2 for name in study.EFFECTS}}
        for g in (4, 8) for m in (2, 3)
    )  # fmt: skip
    study.ablation_figure(steps, effects, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert set(study.COLOURS) == set(study.METHODS)
