"""``waybound compare``."""

from pathlib import Path
from typing import Any

from campaign_cases import outcome, planned

from waybound.reports.campaigns.results_file import ResultsFile


def test_the_table_is_printed_and_files_are_written(run: Any, tmp_path: Path) -> None:
    out, plot, log = tmp_path / "a.csv", tmp_path / "a.png", tmp_path / "a.log"
    result = run(
        "compare",
        "demo-tiny",
        "--heuristic",
        "savings",
        "--heuristic",
        "local",
        "--bound-time",
        0,
        "--out",
        out,
        "--plot",
        plot,
        "--log",
        log,
        code=0,
    )
    assert "savings" in result.stdout and "every answer in the table was checked" in result.stdout
    assert out.read_text().startswith("method,objective,verified_bound,gap,seconds,status,remark")
    assert plot.read_bytes().startswith(b"\x89PNG") and "search by savings" in log.read_text()


def test_json_is_one_object(json_of: Any) -> None:
    data = json_of("compare", "demo-tiny", "--heuristic", "savings", "--bound-time", 0)
    assert data["runs"][0]["method"] == "savings" and data["runs"][0]["solution"]["answer"] is not None


def test_nothing_found_is_4(run: Any) -> None:
    run("compare", "demo-tiny", "--heuristic", "local", "--bound-time", 0, code=4)


def test_what_cannot_be_done_is_refused_before_anything_runs(refused: Any, tmp_path: Path) -> None:
    assert "--solver NAME, --heuristic NAME" in refused("compare", "demo-tiny")
    assert "no-such" in refused("compare", "demo-tiny", "--solver", "no-such")
    assert "must be one of .csv, .json" in refused("compare", "demo-tiny", "--solver", "highs", "--out", tmp_path / "a.txt")
    assert "did you mean 'vehicles'?" in refused("compare", "demo-tiny", "--solver", "highs", "--objective", "vehicle")
    assert "names the file of another output" in refused(
        "compare", "demo-tiny", "--solver", "highs", "--out", tmp_path / "a.csv", "--log", tmp_path / "a.csv"
    )


def test_two_results_files_are_compared_and_a_worse_one_is_1(run: Any, json_of: Any, refused: Any, tmp_path: Path) -> None:
    for name, value in (("a", 10.0), ("b", 11.0)):
        with ResultsFile(tmp_path / f"{name}.sqlite") as file:
            for seed in (1, 2, 3):
                file.add(planned(seed=seed), outcome(value))
    a, b, out = tmp_path / "a.sqlite", tmp_path / "b.sqlite", tmp_path / "o.csv"
    assert "nothing is worse beyond noise" in run("compare", a, a, code=0).stdout
    assert "worse beyond noise" in run("compare", a, b, "--out", out, code=1).stdout
    assert out.read_text().startswith("method,measure,pairs,change")
    assert json_of("compare", a, b, code=1)["worse"] is True and json_of("compare", b, a)["worse"] is False
    assert "no such results file" in refused("compare", a, tmp_path / "c.sqlite")
    assert "compared as they are" in refused("compare", a, b, "--solver", "highs")
