import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from coded import coded

import waybound as wb
from waybound.instances.errors import MissingPackageError, UsageError
from waybound.reports.campaigns import frames


def test_there_is_one_row_a_run_with_the_columns_that_are_promised(done: Any) -> None:
    frame = wb.results(done.results)
    assert list(frame.columns[:8]) == ["instance", "solver", "seed", "objective", "bound", "bound_kind", "status", "seconds"]
    assert frame[["method", "seed"]].to_numpy().tolist() == [[m, s] for m in ("local h=1", "local h=2", "savings") for s in (1, 2)]
    by_savings = frame[frame["solver"] == "savings"]
    assert by_savings["objective"].tolist() == pytest.approx([436.2208418118675] * 2) and by_savings["checked"].all()
    assert set(by_savings["status"]) == {"feasible"} and set(frame["error_code"].dropna()) == {"unsupported"}
    assert json.loads(frame["versions"][5])["waybound"] == wb.__version__ and json.loads(frame["machine"][5])["cores"] >= 1
    assert (by_savings["run_seconds"] >= by_savings["seconds"]).all()


def test_the_whole_answer_its_certificate_and_its_history_are_kept(done: Any) -> None:
    problem = wb.read("demo-tiny", convention="exact")
    for text in frames.documents(done.results, "solution")["solution"]:
        assert wb.judge(problem, json.loads(text)["answer"]).feasible
    for text in frames.documents(done.results, "certificate")["certificate"]:
        assert json.loads(text)["kind"] == "certificate" and json.loads(text)["objective"] == pytest.approx(436.2208418118675)
    with pytest.raises(UsageError, match="did you mean 'history'", check=coded("unknown-name")):
        frames.documents(done.results, "histori")
    assert all(json.loads(text)[-1][1] == "check" for text in frames.documents(done.results, "history")["history"])


def test_some_columns_are_enough_and_others_do_not_exist(done: Any) -> None:
    assert list(wb.results(done.results, ["seed", "status"]).columns) == ["seed", "status"]
    with pytest.raises(UsageError, match=r"no column 'sed'.*did you mean 'seed'", check=coded("unknown-name")):
        wb.results(done.results, ["sed"])
    with pytest.raises(UsageError, check=coded("missing")):
        wb.results(done.results, [])


def test_rows_of_some_runs_can_be_told_from_the_others(done: Any) -> None:
    keys = {run.key for run in done.campaign.runs if run.seed == 2}
    assert set(frames.of_runs(wb.results(done.results), keys)["seed"]) == {2}


def test_a_csv_file_holds_them_all(done: Any, tmp_path: Path) -> None:
    frame = wb.results(done.results)
    frames.export(frame, tmp_path / "x.csv")
    again = pd.read_csv(tmp_path / "x.csv")
    assert list(again.columns) == list(frame.columns) and again["objective"].equals(frame["objective"])


def test_parquet_says_which_package_it_needs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(frames, "find_spec", lambda name: None)
    with pytest.raises(MissingPackageError, match=r"pip install 'waybound\[parquet\]'"):
        frames.check_export(tmp_path / "x.parquet")


def test_parquet_holds_what_the_frame_does(done: Any, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    frame = wb.results(done.results)
    frames.export(frame, tmp_path / "x.parquet")
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "x.parquet"), frame, check_dtype=False)


def test_a_further_form_of_export_is_one_entry(done: Any, tmp_path: Path) -> None:
    frame = wb.results(done.results)
    with frames.EXPORTERS.temporary(".count", frames.Exporter(lambda frame: str(len(frame)))):
        frames.export(frame, tmp_path / "x.count")
    assert (tmp_path / "x.count").read_text() == str(len(frame))
    with pytest.raises(UsageError, match=r"unknown suffix of exports '.count'; choose from .csv, .parquet"):
        frames.export(frame, tmp_path / "x.count")
