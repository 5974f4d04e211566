import pytest
from short_forms import short_form

from waybound.reports.studies.arrays import fleet_energy as study
from waybound.reports.studies.findings import REPRODUCED, SIGN


@pytest.mark.slow
def test_the_short_study():
    report, _ = short_form(study.fleet_energy)
    verdicts = {finding.what: finding.verdict for finding in report.findings}
    assert verdicts["demonstration: robots of a job for ever, 2 min of flight, 34 of charging"] == REPRODUCED
    assert verdicts["demonstration: a second job for ever of 30 robots"] == REPRODUCED
    assert verdicts["26 robots: supported jobs as estimates settle"] == SIGN
    assert verdicts["100 robots, ways counted: percent of the time places are watched, above 99.5"] == SIGN
    assert verdicts["100 robots: percent of the time places are watched, above 99.5"] != SIGN
    assert {row["part"] for row in report.rows} == {"schedule", "loop", "claim"}


def test_broken_schedules_are_faults():
    row = {"part": "schedule", "seed": 1, "method": "one by one", "takeoffs": 5, "alone": 0, "faults": "", "proved": True}
    best = {**row, "method": "fewest takeoffs"}
    for change, count in (
        ({}, 0),
        ({"faults": "robot 1 flies too long"}, 1),
        ({"proved": False}, 1),
        ({"takeoffs": 4}, 1),
        ({"alone": 1}, 0),
    ):
        assert len(study.broken_schedules([{**row, **change}, best])) == count


def test_small_fleets_are_the_same_for_a_seed():
    one, two = study.small_case(7), study.small_case(7)
    assert (one.travel == two.travel).all() and (one.ready == two.ready).all()
