import numpy as np
import pandas as pd
import pytest

from waybound.reports.studies.auctions import information_gathering as study
from waybound.reports.studies.findings import NOT, SIGN, UNDECIDED


@pytest.fixture
def runs():
    """Eight runs of 4 and 5 robots: the partition gains 10 more with 4 robots, and 10 less with 5."""
    rng = np.random.default_rng(1)
    rows = []
    for robots, lead in ((4, 10.0), (5, -10.0)):
        for seed in range(8):
            base = 1000.0 * robots + 50.0 * rng.normal()
            for method in study.METHODS:
                gain = base + (lead + rng.normal() if method != "auction" else 0.0)
                rows.append({"robots": robots, "seed": seed, "method": method, "gain": gain, "idle": 5.0 + rng.normal(), "loss": 9.0})
    return pd.DataFrame(rows)


def test_leads_are_taken_run_by_run(runs):
    known = {(row["robots"], row["method"]): row for row in study.means(runs)}
    row = known[4, "partition, look-ahead 3"]
    assert row["gain_above"] == pytest.approx(10.0, abs=2.0) and row["gain_above_half"] < 3.0 < row["gain_half"]
    assert known[4, "auction"]["gain_above"] == 0.0 and row["runs"] == 8


def test_findings_say_what_the_runs_do(runs):
    found = {finding.what: finding for finding in study.findings(runs, study.means(runs))}
    assert found["4 robots, gain"].verdict == SIGN and found["5 robots, gain"].verdict == NOT
    assert found["4 robots, idle"].verdict == UNDECIDED
    assert found["gain of the partition"].verdict == SIGN
    assert found["4 robots, look-ahead of one against three"].verdict == SIGN
    assert found["auction, a fifth robot"].verdict == NOT  # 25 % more


def test_the_sizes_are_the_sources():
    assert (study.TEAMS, study.STEPS) == ((2, 3, 4, 5), 1000)
    assert set(study.COLOURS) == set(study.METHODS) and set(study.TITLES) == set(study.BETTER)
