import math

import pandas as pd
import pytest
from short_forms import short_form

from waybound.reports.missions.routing import fire_monitoring as mission
from waybound.reports.studies.routing import fire_monitoring as study


@pytest.mark.slow
def test_the_short_study():
    report, html = short_form(study.fire_monitoring)
    moving = [row for row in report.observations if row["kind"] == "0.25"]
    assert [row["method"] for row in moving] == [*study.PAIR] * 2
    assert all(len(row["curve"]) == 40 // study.EVERY for row in moving)
    bounds = [row for row in report.observations if row["kind"] == "bound"]
    assert all(0 < row["straight"] <= row["patrol"] for row in bounds)
    assert "weighted greedy returns to the hotspots" in html


def test_the_thresholds_are_the_sources():
    assert study.THRESHOLDS == (0.25, 0.35, 0.45) and study.fire_monitoring.instances == 100


def test_a_patrol_or_bound_that_takes_too_long_is_told_as_none(monkeypatch):
    monkeypatch.setattr(mission, "LABELS", 3)
    assert all(math.isnan(value) for value in study.optimum(1, 40).values())


def made_up(final, straight=90.0):
    rows = [
        {"kind": "still", "method": method, "seed": 1, "final": value}
        for method, value in zip(("exact patrol", "weighted-greedy"), final, strict=True)
    ]
    return pd.DataFrame([*rows, {"kind": "bound", "method": "best", "seed": 1, "patrol": 100.0, "straight": straight}])


def test_broken_bounds_are_faults():
    tables = [made_up((100.0, 120.0)), made_up((101.0, 120.0)), made_up((100.0, 80.0)), made_up((100.0, 95.0))]
    assert [[fault.kind for fault in study.broken_bounds(table)] for table in tables] == [[], ["answer"], ["bound"], []]
    lost = study.still_means(made_up((100.0, 120.0)))
    assert lost[1]["above the best patrol"] == pytest.approx(20.0) and math.isnan(lost[1]["above the best patrol_half"])
