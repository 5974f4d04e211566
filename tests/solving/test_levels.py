"""Levels are bounded one after the other, and reported as far as they are closed."""

import math
from dataclasses import replace
from typing import Any

import pytest

import waybound as wb
from waybound.formulations.evidence import Evidence
from waybound.formulations.levels import LevelBound
from waybound.formulations.rendering import as_text, number
from waybound.formulations.solution import status_line
from waybound.formulations.verdict import verdict_lines
from waybound.solvers.backend import LevelClaim
from waybound.solving import levels
from waybound.solving.levels import bounds_of_levels
from waybound.solving.recording import Recorder


@pytest.fixture(scope="module")
def problem() -> Any:
    return wb.read("demo-tiny", objective="vehicles then total-cost")


@pytest.fixture(scope="module")
def evaluation(problem: Any) -> Any:
    return problem.evaluate(wb.solve(problem, "cpsat", bound_time=0.0).answer)


def proved(problem: Any, evaluation: Any, bound: float) -> list[LevelBound]:
    return [LevelBound(evaluation.values[:1], bound, Evidence("some", "some evidence", bound, {}))]


def bounds(problem: Any, evaluation: Any, proved: Any, claimed: Any) -> Any:
    return bounds_of_levels(problem.senses, evaluation, proved, claimed, "highs (a form)", evaluation.values[0], "verified", "loads")


@pytest.mark.slow
def test_verified_levels_stay_verified(problem: Any, evaluation: Any) -> None:
    made = bounds(problem, evaluation, proved(problem, evaluation, 300.0), {})
    assert made == ([2.0, 300.0], "verified", "loads, then some evidence")


def test_a_claim_counts_only_where_it_says_more(problem: Any, evaluation: Any) -> None:
    known = proved(problem, evaluation, 300.0)
    assert bounds(problem, evaluation, known, {1: LevelClaim(380.0, 350.0)})[:2] == ([2.0, 350.0], "claimed")
    assert bounds(problem, evaluation, known, {1: LevelClaim(380.0, 250.0)})[:2] == ([2.0, 300.0], "verified")
    assert bounds(problem, evaluation, known, {1: LevelClaim(380.0, -math.inf)})[:2] == ([2.0, 300.0], "verified")
    closed = proved(problem, evaluation, evaluation.values[1])
    assert bounds(problem, evaluation, closed, {1: LevelClaim(380.0, evaluation.values[1])})[:2] == (list(evaluation.values), "verified")


def test_after_an_open_level_nothing_is_said(problem: Any, evaluation: Any) -> None:
    made = bounds_of_levels(problem.senses, evaluation, proved(problem, evaluation, 300.0), {}, "highs", 1.0, "verified", "loads")
    assert made == ([1.0, None], "verified", "loads")


VERDICT = """\
cpsat
status  optimal: the verified bound meets the objective
proved  the answer keeps every constraint and is worth 2 then 384.7341401: 7 checks, redone from the data
proved  no answer is below 2 at level 1 (evidence: round trips shared by loads; checked without any solver)
proved  2 is the least at level 1: bound and answer meet
proved  no answer as good before is below {bound} at level 2 (evidence: column generation, 0 cuts; checked without any solver)
proved  384.7341401 is the least at level 2: bound and answer meet"""


@pytest.mark.slow
def test_levels_are_bounded_while_they_are_closed_and_then_all_is_proved(problem: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    real = levels.bounded

    def find(part: Any, seconds: float, **keywords: Any) -> Any:
        asked.append(part)
        return real(part, 600.0, **keywords)

    monkeypatch.setattr(levels, "bounded", find)
    monkeypatch.setattr("waybound.solving.bounding.BOUND_OVERTIME", 600.0)
    monkeypatch.setattr("waybound.solving.search.GRACE", 600.0)
    solution = wb.solve(problem, "cpsat", bound_time=20.0)
    (part,) = asked
    assert part.senses == ("min",) and part.fleet[0].count == 2
    assert solution.bound_kind == "verified" and solution.bound == pytest.approx([2.0, 384.7341401])
    assert (solution.status, solution.gap) == ("optimal", 0.0)
    assert "the verified bound meets the objective" in status_line(solution).text
    told = VERDICT.format(bound=number(solution.certificate.levels[0].bound))
    assert as_text("cpsat", [status_line(solution), *verdict_lines(solution)]) == told
    again = wb.check(problem, solution.answer, solution.certificate)
    assert again.levels[0].bound == solution.certificate.levels[0].bound


def test_a_first_level_that_is_open_leaves_the_rest_alone(problem: Any, evaluation: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from waybound.formulations.certificate import judged_only
    from waybound.solvers.linear_programs import LinearPrograms

    monkeypatch.setattr(levels, "bounded", lambda *a, **k: pytest.fail("not to be asked"))
    certificate = replace(judged_only(problem, evaluation), bound=1.0)
    assert levels.further_levels(problem, certificate, evaluation, 5.0, LinearPrograms(), Recorder(problem.senses), []) is certificate
