"""``waybound bench``. Its runs are done in this process here; ``tests/reports/campaigns`` has those of their own."""

import csv
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import Here, campaign_file, outcome

from waybound.reports.campaigns import running


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> Here:
    """Workers that make outcomes up: values 10 and 20 by seed."""
    workers = Here(lambda task: outcome(10.0 * task.seed, status="optimal"))
    monkeypatch.setattr(running, "workers_at", lambda cluster, jobs: workers)
    return workers


def test_what_is_missing_is_run_and_the_rest_is_told(run: Any, json_of: Any, made_up: Here, tmp_path: Path) -> None:
    asked = campaign_file(tmp_path)
    before = json_of("bench", asked, "--status")
    assert (before["planned"], before["done"], before["ran"], before["methods"]) == (2, 0, 0, [])
    assert not (tmp_path / "r.sqlite").exists()
    (tmp_path / "r.sqlite").touch()  # as a kill at once leaves it
    assert json_of("bench", asked, "--status")["done"] == 0
    result = run("bench", asked, code=0)
    assert "2 of 2 runs are done, 2 of them now" in result.stdout and "savings" in result.stdout
    again = json_of("bench", asked)
    assert (again["done"], again["ran"], again["missing"], made_up.done) == (2, 0, 0, 2)
    assert again["methods"][0]["method"] == "savings" and again["results"] == str(tmp_path / "r.sqlite")


def test_rows_are_exported_of_the_campaign_or_of_a_whole_results_file(run: Any, made_up: Here, tmp_path: Path) -> None:
    run("bench", campaign_file(tmp_path, seeds=[1, 2, 3]), code=0)
    out = tmp_path / "x.csv"
    run("bench", campaign_file(tmp_path), "--status", "--export", out, code=0)
    with out.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [(row["instance"], row["solver"], row["seed"], row["objective"], row["status"]) for row in rows] == [
        ("demo-tiny", "savings", "1", "10.0", "optimal"), ("demo-tiny", "savings", "2", "20.0", "optimal"),
    ]  # fmt: skip
    run("bench", tmp_path / "r.sqlite", "--export", out, code=0)
    assert len(out.read_text().splitlines()) == 4


def test_profiles_and_paired_tests_are_made_of_them(run: Any, json_of: Any, made_up: Here, tmp_path: Path) -> None:
    asked = campaign_file(tmp_path, heuristics=["savings", "insertion"])
    result = run("bench", asked, "--profile", tmp_path / "p.csv", "--measure", "seconds", "--against", "savings", code=0)
    assert (tmp_path / "p.csv").read_text().splitlines() == ["factor,insertion,savings", "1.0,1.0,1.0"]
    assert "Objective, against savings" in result.stdout
    assert json_of("bench", asked, "--against", "savings")["tests"][0]["mean"] == 0.0


def test_errors_are_noted_and_done_again_if_asked(run: Any, json_of: Any, made_up: Here, tmp_path: Path) -> None:
    made_up.of = lambda task: outcome(None, status="error", error_code="unsupported")
    asked = campaign_file(tmp_path)
    assert "2 runs ended in an error (column reason); --again does them once more" in run("bench", asked, code=0).stderr
    made_up.of = lambda task: outcome()
    assert json_of("bench", asked, "--again")["errors"] == 0


def test_a_failed_check_is_5(run: Any, made_up: Here, tmp_path: Path) -> None:
    made_up.of = lambda task: outcome(faults=1, checked=0, error_code="check-failed")
    assert "2 runs failed a check, and are not counted" in run("bench", campaign_file(tmp_path), code=5).stdout


def test_what_was_done_before_an_interrupt_is_kept(run: Any, json_of: Any, made_up: Here, tmp_path: Path) -> None:
    def interrupted(task: Any) -> Any:
        if task.seed == 2:
            raise KeyboardInterrupt
        return outcome()

    made_up.of = interrupted
    assert "interrupted" in run("bench", campaign_file(tmp_path), code=130).stderr
    assert json_of("bench", campaign_file(tmp_path), "--status")["done"] == 1


def test_what_cannot_be_done_is_one_line_and_leaves_what_is_there(refused: Any, run: Any, made_up: Here, tmp_path: Path) -> None:
    assert "did you mean 'demo-campaign'" in refused("bench", "demo-campain")
    assert "did you mean 'solvers'" in refused("bench", campaign_file(tmp_path, solver=["highs"]))
    assert "did you mean 'highs'" in refused("bench", campaign_file(tmp_path, solvers=["higs"]))
    assert "no such file" in refused("bench", campaign_file(tmp_path, instances=["gone.txt"]))
    assert "no such file" in refused("bench", tmp_path / "gone.toml")
    assert "there are no results yet" in refused("bench", campaign_file(tmp_path), "--status", "--export", tmp_path / "x.csv")
    assert "must be one of .csv, .parquet" in refused("bench", campaign_file(tmp_path), "--export", tmp_path / "x.txt")
    assert "--status runs nothing" in refused("bench", campaign_file(tmp_path), "--status", "--again")
    assert "--jobs must be a whole number" in refused("bench", campaign_file(tmp_path), "--jobs", 0)
    run("bench", campaign_file(tmp_path), "-q", code=0)
    before = (tmp_path / "r.sqlite").read_bytes()
    assert "there is no method 'x'" in refused("bench", campaign_file(tmp_path), "--against", "x")
    assert "nothing is run; name its campaign file" in refused("bench", tmp_path / "r.sqlite", "--again")
    assert (tmp_path / "r.sqlite").read_bytes() == before
    (tmp_path / "r.sqlite").write_bytes(before[:2000])
    assert "damaged" in refused("bench", campaign_file(tmp_path))


def test_the_bundled_campaign_is_found_and_its_results_come_to_where_the_user_is(
    json_of: Any, made_up: Here, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    told = json_of("bench", "demo-campaign")
    assert told["done"] == told["planned"] == 30 and (tmp_path / "demo-campaign.sqlite").exists()


def test_a_campaign_and_a_results_file_have_a_page(run: Any, made_up: Here, tmp_path: Path) -> None:
    asked, page = campaign_file(tmp_path, heuristics=["savings", "insertion"]), tmp_path / "p.html"
    run("bench", asked, "--page", page, "--against", "savings", code=0)
    assert "<title>c</title>" in page.read_text() and "Objective, against savings" in page.read_text()
    run("bench", tmp_path / "r.sqlite", "--page", page, code=0)
    assert "<title>r</title>" in page.read_text() and "All 4 runs" in page.read_text()


def test_a_page_that_could_not_be_written_is_refused_before_a_run(refused: Any, made_up: Here, tmp_path: Path) -> None:
    asked = campaign_file(tmp_path)
    for path, says in ((tmp_path / "none" / "p.html", "there is no folder"), (tmp_path / "p.pdf", "suffix must be one of .html")):
        assert says in refused("bench", asked, "--page", path)
    assert "there are no results yet" in refused("bench", asked, "--status", "--page", tmp_path / "p.html")
    assert made_up.done == 0
