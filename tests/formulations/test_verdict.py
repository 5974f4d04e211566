from dataclasses import replace

import pytest

import waybound as wb
from waybound.formulations.verdict import verdict_lines


def said(solution: wb.Solution) -> list[tuple[str, str]]:
    return [(line.label, line.text) for line in verdict_lines(solution)]


@pytest.fixture(scope="module")
def open_gap() -> wb.Solution:
    """An answer with a verified bound below it."""
    return wb.solve(wb.read("demo-tiny"), "highs", time_limit=20, bound_time=0.0)


def test_a_claimed_optimum_is_not_proved(open_gap: wb.Solution) -> None:
    assert open_gap.status == "optimal" and open_gap.bound_kind == "claimed"
    labels = [label for label, _ in said(open_gap)]
    assert labels == ["proved", "not proved", "claimed"]
    assert "highs's own word" in said(open_gap)[-1][1]


def test_an_open_gap_says_how_much_better_answers_may_be(open_gap: wb.Solution) -> None:
    bound = 0.9 * open_gap.objective
    made = replace(
        open_gap,
        status="feasible",
        bound=bound,
        bound_kind="verified",
        certificate=replace(open_gap.certificate, bound=bound, bound_source="duals"),
    )
    (_, answer), (bounded, below), (unproved, least) = said(made)
    assert "keeps every constraint" in answer
    assert bounded == "proved" and "no answer is below" in below and "duals" in below
    assert unproved == "not proved" and "by up to 10 %" in least


def test_a_bound_that_meets_the_answer_proves_it_the_least(open_gap: wb.Solution) -> None:
    made = replace(
        open_gap, bound_kind="verified", certificate=replace(open_gap.certificate, bound=open_gap.objective, bound_source="duals")
    )
    assert [label for label, _ in said(made)] == ["proved"] * 3


def test_where_nothing_was_found_nothing_is_proved(open_gap: wb.Solution) -> None:
    made = replace(open_gap, answer=None, objective=None, evaluation=None, status="infeasible", bound=None, bound_kind=None)
    (label, text), *_ = said(made)
    assert label == "not proved" and "highs says infeasible, which is no proof" in text


def test_a_verified_proof_that_there_is_no_answer_is_one_line(open_gap: wb.Solution) -> None:
    certificate = replace(open_gap.certificate, infeasible=True, bound_source="bin packing")
    made = replace(open_gap, answer=None, objective=None, evaluation=None, status="infeasible", certificate=certificate)
    assert said(made) == [("proved", "there is no answer (evidence: bin packing; checked without any solver)")]


def test_a_fault_stands_first(open_gap: wb.Solution) -> None:
    assert said(replace(open_gap, faults=("both cannot be right",)))[0] == ("fault", "both cannot be right")
