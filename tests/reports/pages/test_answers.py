import dataclasses
import re
from pathlib import Path

import pytest
from outside_family import Jobs, LeastWaiting, register

import waybound as wb
from waybound.formulations.evaluation import Check, Violation
from waybound.reports.pages.answers import answer_page, certificate_blocks
from waybound.reports.pages.rendering import Rendering


@pytest.fixture(scope="module")
def solution() -> wb.Solution:
    return wb.solve(wb.read("demo-c25"), "pyvrp", iterations=30, bound_time=1)


def words(text: str) -> str:
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", text))


def test_the_page_tells_what_the_solution_tells(solution: wb.Solution) -> None:
    text = words(solution.to_html())
    for told in ("demo-c25", "vrptw, min", "by pyvrp", "feasible: all 7 checks hold", "recomputed from the data", "verified: "):
        assert told in text
    assert solution.certificate.instance_hash in text and "Course of the search" in text and "25 customers" in text


def test_the_same_solution_is_the_same_page_and_the_file_holds_it(solution: wb.Solution, tmp_path: Path) -> None:
    text = solution.to_html(tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text(encoding="utf-8") == text == solution.to_html()
    with pytest.raises(wb.InputError, match="no folder"):
        solution.to_html(tmp_path / "b" / "a.html")
    assert [one.name for one in tmp_path.iterdir()] == ["a.html"]


def test_without_an_answer_the_page_says_why() -> None:
    text = words(wb.solve(wb.read("demo-tiny", capacity=9), "highs", time_limit=5).to_html())
    assert "infeasible, verified" in text and "answer none" in text


def test_what_is_broken_is_listed(solution: wb.Solution) -> None:
    broken = dataclasses.replace(
        solution.certificate, feasible=False, checks=(Check("load", False, 3, 2.0), Check("fleet", True, 0, 0.0)),
        violations=(Violation("load", "<b>vehicle 1 is too full</b>", 2.0),),
    )  # fmt: skip
    text = str(Rendering().blocks(certificate_blocks(broken)))
    assert "broken" in text and "&lt;b&gt;vehicle 1 is too full" in text and "<b>" not in text


def test_answers_of_a_new_family_have_a_page(registered) -> None:  # type: ignore[no-untyped-def]
    register(registered)
    made = wb.solve(LeastWaiting(Jobs({"a<b>": 4, "b": 1})), heuristic="shortest-first", bound_time=0)
    text = answer_page(made).html()
    assert "a&lt;b&gt;" in text and "<b>" not in text
