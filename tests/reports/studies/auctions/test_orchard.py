import numpy as np
import pandas as pd
import pytest

from waybound.reports.studies.auctions import orchard as study
from waybound.reports.studies.findings import NOT, SIGN


@pytest.mark.slow
def test_days_are_those_of_the_rules_and_no_rule_beats_the_bound():
    report = study.orchard(full=False)
    days = pd.DataFrame(report.observations)
    assert (days["steps"] >= days["least"]).all() and days["seed"].nunique() == report.asked == 3
    steps = pd.DataFrame(report.rows).set_index(["robots", "method"])
    own = days[(days["robots"] == 8) & (days["method"] == "auction+baseline")]["steps"]
    assert steps.loc[(8, "auction+baseline"), "steps"] == pytest.approx(own.mean())
    assert steps.loc[(8, "auction+baseline"), "steps_half"] == pytest.approx(4.302652729911275 * own.std() / np.sqrt(3))  # t of 2 degrees


@pytest.mark.slow
def test_no_rule_beats_the_optimum_of_a_small_day():
    for row in study.orchard_optimum(full=False).observations:
        assert row["status"] == "optimal" and all(row[method] >= row["optimum"] for method in study.METHODS)


def test_effects_are_taken_day_by_day():
    rows = [
        {"groups": 4, "robots": 2, "seed": seed, "method": method, "steps": 100 - 10 * k - seed, "returned": 10 * k}
        for seed in (1, 2, 3)
        for k, method in enumerate(study.METHODS)
    ]
    (row,) = study.effects_rows(pd.DataFrame(rows))
    assert row["both"] == pytest.approx(np.mean([100 * 30 / (100 - seed) for seed in (1, 2, 3)]))
    assert row["both wins"] == 1.0 and row["bins"] == 30


def test_runs_of_numbers_are_told_shortly():
    assert study.ranges([2, 3, 4, 7, 9, 10]) == "2-4, 7, 9-10"
    assert study.ranges([]) == "none"


def test_sizes_are_the_sources():
    assert (study.TEAMS, study.GROUPS, study.orchard.instances) == (tuple(range(2, 21)), (4, 8), 100)
    assert set(study.COLOURS) == set(study.METHODS)


def test_a_claim_is_refuted_by_the_teams_that_go_against_it():
    days = pd.DataFrame([{"groups": 4, "robots": 20, "method": "auction+proposed", "steps": 140.0}])
    effects = [
        {"groups": 4, "robots": m, **dict.fromkeys(study.EFFECTS, lead), **{f"{name}_half": 1.0 for name in study.EFFECTS},
         "bins": 5.0, "bins_half": 1.0}
        for m, lead in ((2, 3.0), (3, -3.0), (4, 0.5))
    ]  # fmt: skip
    found = {finding.what: finding for finding in study.findings(days, effects)}
    assert found["4 groups, auction and delivery together: steps"].verdict == NOT
    assert found["4 groups, auction and delivery together: steps"].ours == "better for 2 robots, worse for 3"
    assert found["4 groups, auction and delivery together: bins by step 150"].verdict == SIGN
    assert found["large teams finish 160 bins within 150 steps (text on Fig. 3.3)"].verdict == SIGN
