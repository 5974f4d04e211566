"""The study of partition against auction, in its short form."""

from __future__ import annotations

import pandas as pd
import pytest

from waybound.reports.missions.auctions import information_gathering_study as study


@pytest.mark.slow
def test_the_short_study_writes_tables_and_figures(tmp_path, capsys):
    assert study.main(["--out", str(tmp_path / "made"), "--short"]) == 0
    text = capsys.readouterr().out
    assert {path.name for path in (tmp_path / "made").iterdir()} == {"means.csv", "runs.csv", "gathering.png", "summary.md"}
    assert (tmp_path / "made" / "summary.md").read_text() == text
    runs = pd.read_csv(tmp_path / "made" / "runs.csv")
    assert runs.groupby(["robots", "seed"]).size().tolist() == [len(study.METHODS)] * 4
    table = pd.read_csv(tmp_path / "made" / "means.csv").set_index(["robots", "method"])
    own = runs[runs["robots"] == 3].pivot_table(index="seed", columns="method", values="loss")
    method = "partition, look-ahead 3"
    assert table.loc[(3, method), "loss_above"] == pytest.approx((own[method] - own["auction"]).mean())
    assert table.loc[(3, "auction"), "gain_above"] == 0.0


def test_the_sizes_are_the_sources():
    size = study.Size()
    assert (size.robots, size.steps) == ((2, 3, 4, 5), 1000)


@pytest.mark.slow
def test_three_metrics_are_drawn(tmp_path):
    rows = [
        {"robots": m, "method": method, **{f"{name}{end}": 1.0 for name in study.METRICS for end in ("", "_half", "_above", "_above_half")}}
        for m in (2, 3) for method in study.METHODS
    ]  # fmt: skip
    study.metrics_figure(pd.DataFrame(rows), tmp_path / "figure.png")
    assert (tmp_path / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert set(study.COLOURS) == set(study.METHODS)
    assert set(study.TITLES) == set(study.METRICS)
