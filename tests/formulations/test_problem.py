"""What every problem can do, unless its family does it in its own way."""

from __future__ import annotations

import pytest

import waybound as wb
from waybound.formulations.problem import Problem


@pytest.mark.parametrize("name", ["figure-3-3", "cover-30"])
def test_a_problem_knows_no_reason_why_it_should_have_no_answer(name):
    assert list(wb.read(name).infeasibility_reasons()) == []


def test_facts_are_optional():
    assert Problem.facts(wb.read("figure-3-3")) == {}


def test_answers_are_written_as_json_unless_a_problem_says_more():
    problem = wb.read("cover-30")
    problem.check_answer_suffix(".json")
    for suffix in (".sol", ".txt", ""):
        with pytest.raises(
            wb.UsageError, match=r"answers to selection problems are written as \.json, \.csv, \.xlsx, not under the suffix"
        ):
            problem.check_answer_suffix(suffix)
    with pytest.raises(NotImplementedError, match=r"SubmodularSelection .* \.sol"):
        problem.answer_to_text(wb.Selection.of([0]), ".sol")


def test_text_that_is_no_json_is_refused_with_its_first_line():
    with pytest.raises(wb.InputError, match=r"expected JSON; found 'hello'") as caught:
        wb.read("cover-30").answer_from_text("hello\nworld\n")
    assert caught.value.line == 1
