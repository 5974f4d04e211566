from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from waybound.reports.missions.risk import uncertain_graph_study as study


@pytest.mark.long
def test_the_short_study_writes_tables_and_figures(tmp_path, capsys):
    assert study.main(["--out", str(tmp_path / "made"), "--short"]) == 0
    text = capsys.readouterr().out
    names = {path.name for path in (tmp_path / "made").iterdir()}
    both = {
        f"{what}{name}{suffix}"
        for name in ("roadmaps", "rasters")
        for what, suffix in (("", ".csv"), ("", ".png"), ("walks_", ".csv"), ("histograms_", ".png"))
    }
    assert names == both | {"walks.png", "summary.md"}
    assert (tmp_path / "made" / "summary.md").read_text() == text
    pictures = [path.read_bytes() for path in (tmp_path / "made").glob("*.png")]
    assert len(pictures) == 5 and all(picture.startswith(b"\x89PNG") for picture in pictures)
    walks = pd.read_csv(tmp_path / "made" / "walks_roadmaps.csv")
    assert walks.groupby(["graph", "draw"]).size().tolist() == [len(study.METHODS)] * 6
    assert walks["excess"].min() >= -1e-9
    assert walks.groupby(["graph", "draw"])["hindsight"].nunique().tolist() == [1] * 6  # the same costs for all
    table = pd.read_csv(tmp_path / "made" / "roadmaps.csv").set_index("method")
    assert table.loc["greedy", "mean"] == pytest.approx(walks[walks["method"] == "greedy"]["excess"].mean())
    assert table.loc["rags", "rags_above"] == 0.0


def test_the_sizes_are_the_sources():
    size = study.Size()
    assert (size.variances, size.graphs, size.draws) == ((5.0, 10.0, 20.0), 20, 100)


def test_trends_are_read_off_the_table_whatever_it_says():
    rows = [
        {"level": 5.0, "method": method, "q95": q95, "rags_above": above, "error": 0.1}
        for method, q95, above in (
            ("rags", 1.0, 0.0),
            ("a-star", 2.0, -0.3),
            ("greedy", 9.0, -5.0),
            ("d-star-lite", 0.5, 0.3),
            ("rags-unobserved", 2.0, 0.1),
        )
    ]
    said = dict(study.trends(pd.DataFrame(rows)))
    assert said["rags below A* in the mean"] == "5.0 yes (-0.30 +- 0.10 points)"
    assert said["rags below D* Lite"].startswith("5.0 no")
    assert said["observing helps rags"].startswith("5.0 undecided")
    assert said["rags' upper tail, the 95 % quantile, beside A*'s"] == "5.0 1.00 against 2.00"


@pytest.mark.long
def test_what_can_be_asserted_of_the_policies():
    """At least 100 graphs of 10 paired draws: rags with observed edges below A*, far below greedy; nothing about D* Lite."""
    table = study.excess_table(study.plays((20.0,), "variance", 100, 10)).set_index("method")
    assert table.loc["a-star", "rags_above"] < 0.0
    assert table.loc["greedy", "rags_above"] < -5.0


@pytest.fixture
def walks():
    rng = np.random.default_rng(1)
    rows = [
        {"level": level, "method": method, "excess": e}
        for level in (5.0, "trees")
        for method in study.METHODS
        for e in rng.exponential(2.0, 20)
    ]
    return pd.DataFrame(rows)


@pytest.mark.slow
def test_methods_without_excess_are_drawn_too(tmp_path, walks):
    study.draw_histograms(walks.assign(excess=0.0), tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 1000


def test_a_walk_is_that_of_the_policy(tmp_path):
    world = study._walked("a-star", 1, 2, vertices=15)
    assert world.metrics()["arrived"] == 1.0
    assert set(study.METHODS) < set(study.COLOURS)
