import math
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from campaign_cases import outcome, planned

from waybound.reports.campaigns.counting import counted
from waybound.reports.campaigns.frames import results
from waybound.reports.campaigns.results_file import ResultsFile


def frame(folder: Path, *runs: tuple[Any, Any]) -> pd.DataFrame:
    path = folder / "r.sqlite"
    with ResultsFile(path) as file:
        for run, made in runs:
            file.add(run, made)
    return results(path)


def test_an_answer_that_failed_a_check_counts_for_nobody(tmp_path: Path) -> None:
    made = counted(frame(
        tmp_path, (planned(), outcome(10.0, verified_bound=8.0)), (planned(seed=2), outcome(1.0, faults=1, checked=0, verified_bound=99.0)),
        (planned(method="b"), outcome(None, status="unknown")),
    ))  # fmt: skip
    assert made.set_index(["method", "seed"])["counts"].to_dict() == {("b", 1): False, ("savings", 1): True, ("savings", 2): False}
    assert set(made["best"]) == {10.0} and set(made["best_bound"]) == {8.0}
    assert made["gap_to_bound"].dropna().tolist() == [pytest.approx(0.2)]


def test_the_best_is_the_greatest_where_it_is_maximised_and_bounds_are_shared(tmp_path: Path) -> None:
    up = {"sense": "max"}
    made = counted(
        frame(
            tmp_path, (planned(), outcome(10.0, verified_bound=20.0, **up)), (planned(method="b"), outcome(8.0, verified_bound=12.0, **up))
        )
    )
    assert set(made["best"]) == {10.0} and set(made["best_bound"]) == {12.0}
    assert dict(zip(made["method"], made["gap_to_best"], strict=True)) == {"b": pytest.approx(0.2), "savings": 0.0}


def test_cases_that_are_read_otherwise_are_never_compared(tmp_path: Path) -> None:
    made = counted(frame(tmp_path, (planned(convention="exact"), outcome(10.0)), (planned(convention="trunc1"), outcome(9.0))))
    assert made["case"].nunique() == 2 and made["gap_to_best"].tolist() == [0.0, 0.0]


def test_best_known_values_are_those_of_the_convention_and_a_better_answer_has_a_negative_gap(tmp_path: Path) -> None:
    rows = frame(tmp_path, (planned(), outcome(9.0)))
    known = {("hash-a", planned().setting.reading): [("exact", "min", 10.0), ("trunc1", "min", 5.0)]}
    assert counted(rows, known)["gap_to_known"].tolist() == [pytest.approx(-0.1)]
    assert math.isnan(counted(rows)["gap_to_known"][0]) and math.isnan(counted(rows, {("other", ""): []})["known"][0])


def test_a_method_with_several_limits_is_several_methods(tmp_path: Path) -> None:
    made = counted(
        frame(tmp_path, (planned(time_limit=1.0), outcome()), (planned(time_limit=2.0), outcome()), (planned(method="b"), outcome()))
    )
    assert set(made["who"]) == {"b", "savings, time limit 1", "savings, time limit 2"}
