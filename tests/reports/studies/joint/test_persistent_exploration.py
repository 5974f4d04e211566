import pytest
from short_forms import short_form

from waybound.reports.studies.joint import persistent_exploration as study


@pytest.mark.slow
def test_the_short_study():
    report, html = short_form(study.persistent_exploration)
    loops = {row["method"]: row for row in report.observations if row["kind"] == "loop"}
    assert list(loops) == list(study.LOOPS) and loops["exact"]["lost"] == loops["exact"]["longer"] == 0.0
    assert all(0 <= row["gap"] <= 100 / 2.718281828 for row in loops.values())
    assert "keep a map up to date" in html


def test_one_parameter_changes_at_a_time():
    for name, how in study.RUNS.items():
        changed = {key for key in how if key not in ("heuristic", "policy")}
        assert len(changed) <= 1 or name in ("decay", "static"), name
    assert study.persistent_exploration.instances == 100


def test_lost_robots_and_unproved_plans_are_faults():
    row = {"seed": 1, "method": "exact", "robots_lost": 0.0, "unproved": 0.0}
    assert study.broken([row]) == []
    found = study.broken([{**row, "robots_lost": 1.0}, {**row, "unproved": 2.0}])
    assert [fault.message for fault in found] == [
        "seed 1, exact: 1 robots are lost",
        "seed 1, exact: 2 steps have a plan that is not proved",
    ]
