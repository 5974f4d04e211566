import math
from pathlib import Path

import pytest
from campaign_cases import outcome, planned

from waybound.reports.campaigns.counting import counted
from waybound.reports.campaigns.frames import results
from waybound.reports.campaigns.primal_integrals import primal_integrals
from waybound.reports.campaigns.results_file import ResultsFile


def test_each_run_is_measured_up_to_its_limit_against_the_best_that_is_known(tmp_path: Path) -> None:
    path = tmp_path / "r.sqlite"
    history = [[0.5, "solve", None, [1.0], "claimed", "x"], [1.0, "solve", [10.0], None, None, "x"], [3.0, "check", [5.0], None, None, "x"]]
    with ResultsFile(path) as file:
        file.add(planned("a", "x", time_limit=10.0), outcome(5.0, history))
        file.add(planned("a", "y", time_limit=10.0), outcome(1.0, history, faults=1, checked=0))
        file.add(planned("b", "x", time_limit=10.0), outcome(None, status="unknown"))
        file.add(planned("c", "x", time_limit=10.0), outcome(5.0, history, sense="max"))
    runs = counted(results(path), {("hash-c", planned().setting.reading): [(None, "max", 10.0)]})
    made = dict(zip(zip(runs["instance"], runs["method"], strict=True), primal_integrals(runs, path), strict=True))
    assert made["a", "x"] == pytest.approx(1.0 + 2.0 * 0.5) and made["a", "y"] == 10.0 and math.isnan(made["b", "x"])
    assert made["c", "x"] == pytest.approx(1.0 + 7.0 * 0.5)
