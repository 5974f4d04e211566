import pytest
from short_forms import short_form

from waybound.reports.studies.routing import hotspot_identification as study


@pytest.mark.slow
def test_the_short_study():
    report, html = short_form(study.hotspot_identification)
    assert [row["method"] for row in report.rows] == [*study.METHODS]
    loops = [row for row in report.observations if row["kind"] == "loop"]
    assert [row["method"] for row in loops] == [*study.LOOPS] * 2
    assert all(row["below"] >= -1e-6 for row in loops)
    assert "greedy routes among the arms" in html


def test_the_printed_table_has_a_number_for_each_method_of_the_source():
    assert len(study.PRINTED) == len(study.METHODS) and study.PRINTED[-1] is None
    printed = dict(zip(study.METHODS, study.PRINTED, strict=True))
    assert printed["future window increasing"] == "71.60" and printed["block UCL"] == "35.13" and printed["flat 70 m increasing"] == "66.93"
    for name in study.BOUNDS:  # the source's reliable order, by the printed numbers
        if name.startswith("current"):
            assert float(printed[name]) < float(printed[name.replace("current", "future")])
        if "window" not in name:
            assert float(printed[name]) < float(printed[name.replace(" ", " window ", 1)])
        assert float(printed[name]) > float(printed["block UCL"])


def test_broken_bounds_are_faults():
    row = {"kind": "loop", "method": "exact", "seed": 1, "point": 90.0, "arm": 80.0, "left": 1.0, "collected": 9.0, "bound": 9.0}
    changes = ({}, {"left": -1.0}, {"point": 101.0}, {"collected": 9.1}, {"proved": False})
    assert [[fault.kind for fault in study.broken_bounds([{**row, **change}])] for change in changes] == [
        [], ["answer"], ["answer"], ["bound"], ["bound"],
    ]  # fmt: skip
