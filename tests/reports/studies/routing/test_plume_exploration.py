import pytest
from short_forms import short_form

from waybound.reports.studies.routing import plume_exploration as study


@pytest.mark.slow
def test_the_short_study():
    report, html = short_form(study.plume_exploration)
    sweeps = [row for row in report.observations if "sweep" in row]
    assert all(row["shortest"] <= row["time"] <= row["longest"] for row in sweeps)
    loops = [row for row in report.observations if "method" in row]
    assert [row["method"] for row in loops] == [*study.LOOPS] * study.plume_exploration.setting(full=False).instances
    assert all(row["above"] >= -1e-6 for row in loops)
    assert "explore a plume of 60 cells" in html


def test_the_defaults_are_the_sources():
    assert {key: study.SWEEPS[key] for key in study.SWEEPS}["cells"][2] == 120
    assert 20 in study.SWEEPS["robots"] and 2.5 in study.SWEEPS["speed"] and study.plume_exploration.instances == 100


def test_broken_bounds_are_faults():
    row = {"sweep": "cells", "level": 5.0, "seed": 1, "time": 9.0, "finished": 1.0, "longest": 8.0, "shortest": 2.0}
    kinds = [study.broken_bounds([{**row, **change}]) for change in ({}, {"time": 8.0}, {"time": 1.0}, {"finished": 0.0})]
    assert [[fault.kind for fault in faults] for faults in kinds] == [["bound"], [], ["bound"], ["answer"]]
    loop = {"method": "depth-first", "seed": 1, "time": 9.0, "finished": 1.0, "hindsight": 4.0, "bound": 4.0, "proved_ratio": 2.0}
    assert [len(study.broken_bounds([{**loop, **change}])) for change in ({}, {"time": 8.0}, {"method": "exact"}, {"time": 3.9})] == [
        1, 0, 0, 1,
    ]  # fmt: skip
