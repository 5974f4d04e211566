"""The tracking study, in its short form."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from waybound.reports.missions.sata import tracking_study as study


@pytest.mark.long
def test_the_short_study_writes_tables_figures_and_an_animation(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(study, "SHORT", replace(study.SHORT, targets=(5, 10), instances=2, steps=3, gazebo_steps=3, local_steps=2))
    assert study.main(["--out", str(tmp_path / "made"), "--short"]) == 0
    text = capsys.readouterr().out
    names = {path.name for path in (tmp_path / "made").iterdir()}
    logs = {f"log_{name}.csv" for name in ("single_steps", "long_runs", "gazebo_greedy", "gazebo_local")}
    assert names == logs | {
        "parker.csv", "weights.csv", "bottleneck.csv", "parker.png", "weights.png", "bottleneck.png", "tracking.gif", "summary.md",
    }  # fmt: skip
    assert (tmp_path / "made" / "summary.md").read_text() == text
    assert text.count("greedy above force vectors") == 3
    long = pd.read_csv(tmp_path / "made" / "log_long_runs.csv")
    assert long.groupby(["targets", "method", "seed"]).size().tolist() == [3] * (2 * len(study.PARKER) * 2)
    table = pd.read_csv(tmp_path / "made" / "parker.csv").set_index(["targets", "method"])
    own = long[(long["targets"] == 10) & (long["method"] == "greedy")]
    assert table.loc[(10, "greedy"), "c_mean"] == pytest.approx(own.groupby("seed")["observed"].mean().mean())
    assert table.loc[(10, "force-vector"), ["a_lead", "c_lead", "a_kept_lead"]].tolist() == [0, 0, 0]


def test_the_sizes_are_the_sources():
    size = study.Size()
    assert (size.targets, size.instances, size.steps, size.trials) == ((10, 20, 30), 200, 200, 10)
    assert size.gazebo_steps == 180 // 8


def parker(greedy, force, error=0.1):
    rows = []
    for k, count in enumerate((10, 20)):
        for method, mean in (("greedy", greedy[k]), ("force-vector", force[k])):
            row = {"targets": count, "method": method, "c_mean": mean}
            for key in ("a_kept", "a", "c"):
                row |= {f"{key}_lead": mean - force[k], f"{key}_lead_error": error}
            rows.append(row)
    return pd.DataFrame(rows)


def test_trends_are_read_off_the_tables_whatever_they_say():
    weights = pd.DataFrame({"weights": list(study.WEIGHTS), "value_error": [0.1, 0.05, 0.1, 0.2]})
    said = dict(study.trends(parker([9.0, 15.0], [8.0, 15.1]), weights))
    assert "10 targets yes" in said["greedy above force vectors, time averages"]
    assert "20 targets undecided" in said["greedy above force vectors, time averages"]
    assert said["greedy grows with the number of targets"] == "yes"
    assert said["inverse-distance estimates differ more from the actual"].startswith("no (5.00% against 10.00%)")
    assert said["inverse-distance estimates differ more from the actual, noisy"].startswith("yes")
    said = dict(study.trends(parker([9.0, 8.0], [9.5, 15.0]), weights))
    assert "10 targets no" in said["greedy above force vectors, single steps"]
    assert said["greedy grows with the number of targets"] == "no"


def test_leads_are_paired_by_seed():
    values = pd.DataFrame({"seed": [1, 2, 1, 2], "method": ["a", "a", "b", "b"], "observed": [5.0, 9.0, 4.0, 6.0]})
    lead, error = study.paired_lead(values, "observed", "a", "b")
    assert (lead, error) == (2.0, pytest.approx(1.0))
    assert math.isnan(study.paired_lead(values[values["seed"] == 1], "observed", "a", "b")[1])


def test_relative_errors_leave_out_steps_without_an_actual_value():
    log = pd.DataFrame(
        {
            "method": "binary", "estimated_targets": [2.0, 1.0], "actual_targets": [4.0, 0.0], "estimated_value": [3.0, 1.0],
            "actual_value": [2.0, 0.0], "observed": [5.0, 5.0],
        }
    )  # fmt: skip
    (row,) = study.weights_table(log).to_dict("records")
    assert (row["targets_error"], row["value_error"]) == (0.5, 0.5)


def test_markdown_shows_four_digits_and_a_dash_for_nothing():
    text = study.markdown(pd.DataFrame({"a": [1.23456, math.nan], "b": ["x", "y"]}))
    assert text == "| a | b |\n| --- | --- |\n| 1.235 | x |\n| - | y |\n"


def test_a_folder_that_cannot_be_made_is_one_line_and_exit_2(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert study.main(["--out", str(tmp_path / "file" / "in"), "--short"]) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert len(told.strip().splitlines()) == 1


def test_an_interrupt_ends_the_study_and_leaves_no_half_table(tmp_path, capsys, monkeypatch):
    import waybound
    from waybound import run

    def interrupted(*given, **named):
        log = run(*given, **named)
        log.attrs["limit"] = "interrupt"
        return log

    monkeypatch.setattr(waybound, "run", interrupted)
    assert study.main(["--out", str(tmp_path / "made"), "--short"]) == 130
    assert "interrupted" in capsys.readouterr().err
    assert list((tmp_path / "made").iterdir()) == []


# -- figures -------------------------------------------------------------------------------------------------------------


@pytest.fixture
def kept(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The figures that were saved, as objects."""
    made: list[Any] = []
    save = study._save
    monkeypatch.setattr(study, "_save", lambda figure, path: (made.append(figure), save(figure, path)))
    return made


def heights(ax: Any) -> list[float]:
    return [round(float(patch.get_height()), 6) for patch in ax.patches]


def test_bars_are_the_means_of_each_method_and_number_of_targets(kept: list[Any], tmp_path: Path) -> None:
    columns = {f"{key}_{what}": [1.0 + k + (what == "std") / 10 for k in range(4)] for key in "abc" for what in ("mean", "std")}
    table = pd.DataFrame({"targets": [10, 10, 5, 5], "method": ["greedy", "random"] * 2, **columns})
    study.draw_parker(table, tmp_path / "parker.png")
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
    study.draw_weights(logs, tmp_path / "weights.png")
    counts, values = kept[0].axes
    assert [line.get_xydata().tolist() for line in counts.lines[:2]] == [[[2, 3], [4, 4]], [[5, 5]]]
    assert [line.get_xydata().tolist() for line in values.lines[:2]] == [[[0.25, 0.5], [1.0, 1.0]], [[0.5, 1.0]]]


def test_methods_without_candidates_have_no_share_but_what_they_observed(kept: list[Any], tmp_path: Path) -> None:
    table = pd.DataFrame({
        "method": ["local", "stay"], "share_estimated": [0.8, None], "share_actual": [0.6, None], "observed": [5.0, 3.0],
        "observed_std": [0.5, 0.1],
    })  # fmt: skip
    study.draw_bottleneck(table, tmp_path / "bottleneck.png")
    shares, observed = kept[0].axes
    assert heights(shares) == [0.8, 0.6] and heights(observed) == [5.0, 3.0]
    assert [label.get_text() for label in observed.get_xticklabels()] == ["local", "stay"]


def test_every_method_of_the_study_has_a_colour() -> None:
    assert set(study.PARKER) <= set(study.COLOURS)
