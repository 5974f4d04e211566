import re
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import hundred_instances, outcome, planned

from waybound.reports.campaigns.counting import counted
from waybound.reports.campaigns.frames import results
from waybound.reports.campaigns.results_file import ResultsFile
from waybound.reports.pages.campaigns import campaign_page


def page_of(folder: Path, runs: Any, **asked: Any) -> str:
    path = folder / "r.sqlite"
    with ResultsFile(path) as file:
        file.add_all(runs)
    frame = counted(results(path))
    return campaign_page(frame, path, name="a <b>campaign</b>", planned=len(frame) + 1, **asked).html()


def words(text: str) -> str:
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", re.sub(r"<style>.*?</style>", "", text, flags=re.DOTALL)))


def test_the_page_tells_runs_methods_gaps_and_tests(tmp_path: Path) -> None:
    runs = [
        (planned("one", "x"), outcome(10.0, status="optimal", verified_bound=10.0, bound_kind="verified")),
        (planned("one", "y"), outcome(12.0)), (planned("two", "x"), outcome(10.0)), (planned("two", "y"), outcome(11.0)),
        (planned("two", "y", 2), outcome(9.0, faults=1, checked=0)),
        (planned("two", "x", 2), outcome(None, status="error", error_code="unsupported", reason="<i>lacks windows</i>")),
    ]  # fmt: skip
    text = page_of(tmp_path, runs, against="x")
    told = words(text)
    for one in (
        "2 methods on 2 instances", "6 of 7 are done", "4, each checked from the data", "1 verified, 0 claimed",
        "1 runs failed a check, and are not counted", "Performance profile: seconds", "Gap to the verified bound", "Objective, against x",
        "&lt;i&gt;lacks windows&lt;/i&gt;", "a &lt;b&gt;campaign&lt;/b&gt;",
    ):  # fmt: skip
        assert one in told, one
    assert re.search(r">two</td><td[^>]*>0</td><td[^>]*>10</td>", text), "y is 10 % above x on instance two"


def test_a_campaign_without_an_answer_has_a_page(tmp_path: Path) -> None:
    told = words(page_of(tmp_path, [(planned(), outcome(None, status="error", reason="no such file"))]))
    assert "No answer counts" in told and "no such file" in told


@pytest.mark.slow
def test_the_page_of_a_hundred_instances_is_small(tmp_path: Path) -> None:
    text = page_of(tmp_path, hundred_instances())
    assert len(text.encode()) < 5_000_000 and "All 3,000 runs" in text
