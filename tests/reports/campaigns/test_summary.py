import math
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import outcome, planned

import waybound as wb
from waybound.reports.campaigns.counting import counted
from waybound.reports.campaigns.frames import results
from waybound.reports.campaigns.results_file import ResultsFile
from waybound.reports.campaigns.summary import Summary, primal_integrals, summary_of, summary_table


def summary(folder: Path, *runs: Any) -> Summary:
    path = folder / "r.sqlite"
    with ResultsFile(path) as file:
        for run, made in runs:
            file.add(run, made)
    return summary_of(counted(results(path)), path)


def test_the_summary_of_real_runs_knows_the_best_known_value(done: Any) -> None:
    made = summary_of(counted(wb.results(done.results), done.campaign.best_known_values()), done.results)
    by = {one.method: one for one in made.methods}
    assert by["savings"].answers == 2 and by["savings"].gap_to_known == pytest.approx(0.0905521, rel=1e-5)
    assert by["local h=1"].errors == 2 and by["local h=1"].gap_to_best is None
    assert by["savings"].primal_integral is not None and made.failed_checks == 0
    table = summary_table(made)
    assert "to bound" not in [column.name for column in table.columns] and len(table.rows) == 3


def test_means_are_over_the_cases_that_all_methods_answered(tmp_path: Path) -> None:
    made = summary(
        tmp_path, (planned("a", "x"), outcome(10.0)), (planned("a", "y"), outcome(11.0)), (planned("b", "x"), outcome(10.0)),
        (planned("b", "y"), outcome(None, status="unknown")),
    )  # fmt: skip
    assert [(one.method, one.answers, one.gap_to_best) for one in made.methods] == [("x", 2, 0.0), ("y", 1, pytest.approx(0.1))]
    assert "means are over 1 of 2 cases (instance and seed) that all methods answered" in made.notes


def test_what_makes_a_comparison_unfair_is_noted(tmp_path: Path) -> None:
    made = summary(
        tmp_path, (planned("a", "x", time_limit=1.0), outcome(10.0, levels="{}")), (planned("a", "y"), outcome(1.0, faults=1, checked=0)),
    )  # fmt: skip
    told = " ".join(made.notes)
    assert "no case was answered by all methods (of 1)" in told and "limits differ between methods" in told
    assert "first level alone" in told and "1 runs failed a check" in told and made.failed_checks == 1


def test_proofs_and_claims_are_told_apart(tmp_path: Path) -> None:
    made = summary(
        tmp_path, (planned("a", "x"), outcome(status="optimal", bound_kind="verified")),
        (planned("b", "x"), outcome(status="optimal", bound_kind="claimed")),
    )  # fmt: skip
    assert (made.methods[0].proved, made.methods[0].claimed) == (1, 1)


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
