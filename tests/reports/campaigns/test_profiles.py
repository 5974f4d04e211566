from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from campaign_cases import outcome, planned
from coded import coded

from waybound import UsageError, results
from waybound.reports.campaigns.counting import counted
from waybound.reports.campaigns.profiles import profile, write_profile
from waybound.reports.campaigns.results_file import ResultsFile


@pytest.fixture
def runs(tmp_path: Path) -> Any:
    with ResultsFile(tmp_path / "r.sqlite") as file:
        file.add(planned("a", "x"), outcome(10.0, status="optimal", seconds=1.0))
        file.add(planned("a", "y"), outcome(12.0, seconds=4.0))
        file.add(planned("b", "x"), outcome(None, status="unknown"))
        file.add(planned("b", "y"), outcome(5.0, status="optimal", seconds=2.0))
        file.add(planned("b", "z"), outcome(1.0, faults=1, checked=0, status="optimal"))
    return counted(results(tmp_path / "r.sqlite"), {("hash-b", planned().setting.reading): [(None, "min", 4.0)]})


def test_quality_is_measured_against_the_best_that_is_known(runs: Any) -> None:
    made = profile(runs, "objective")
    assert list(made.columns) == ["x", "y", "z"]
    assert made.index.tolist() == pytest.approx([1.0, 1.2, 1.25])
    assert made["x"].tolist() == [0.5, 0.5, 0.5] and made["y"].tolist() == [0.0, 0.5, 1.0] and made["z"].tolist() == [0.0] * 3


def test_time_counts_only_with_an_optimum(runs: Any) -> None:
    assert profile(runs, "seconds").loc[1.0].to_dict() == {"x": 0.5, "y": 0.5, "z": 0.0}


def test_another_measure_does_not_exist(runs: Any) -> None:
    with pytest.raises(UsageError, match="did you mean 'seconds'", check=coded("unknown-name")):
        profile(runs, "second")


def test_profiles_are_written_as_a_table_or_a_picture(runs: Any, tmp_path: Path) -> None:
    made = profile(runs)
    write_profile(made, "objective", tmp_path / "p.csv")
    assert pd.read_csv(tmp_path / "p.csv", index_col="factor").equals(made)
    write_profile(made, "objective", tmp_path / "p.svg")
    assert "<svg" in (tmp_path / "p.svg").read_text()[:600]
