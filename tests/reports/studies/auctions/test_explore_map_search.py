import pytest
from short_forms import short_form

from waybound.reports.studies.auctions import explore_map_search as study


@pytest.mark.slow
def test_the_short_study():
    report, _ = short_form(study.explore_map_search)
    loops = [row for row in report.observations if "method" in row]
    assert [row["method"] for row in loops] == [*study.LOOPS] and all(row["below"] >= -1e-4 for row in loops)
    assert {row["sweep"] for row in report.rows} == {*study.SWEEPS}
    assert {figure.name for figure in report.figures} == {"explore-map-search"}


def test_the_levels_are_the_sources():
    assert study.SWEEPS["robots"] == (2, 3, 4, 5) and [sum(w) for w in study.EMPHASES.values()] == pytest.approx([1.0] * 3)
    assert study.explore_map_search.instances == 100


def test_what_must_not_be_is_a_fault():
    row = {"method": "relays", "seed": 1, "utility": 2.0, "bound": 2.0, "silent": 1.0, "silence": 1, "steps": 8, "budget": 8}
    changes = ({}, {"utility": 2.1}, {"silent": 2.0}, {"steps": 7}, {"contradictions": 1})
    kinds = [[fault.where for fault in study.broken([{**row, **change}])] for change in changes]
    assert kinds == [[], ["bound"], ["contact"], ["budget"], ["bound"]]
