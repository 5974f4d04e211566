"""Objectives as text."""

from __future__ import annotations

import pytest
from draws import draws
from hypothesis import given, settings
from hypothesis import strategies as st

import waybound as wb
from waybound.formulations.routing.objective import TERMS, Objective, Weighted
from waybound.formulations.routing.objective_text import objective_from


@pytest.mark.parametrize(
    ("text", "expected", "senses"),
    [
        ("total-cost", wb.TotalCost(), ("min",)),
        ("vehicles then total-cost", wb.Vehicles().then(wb.TotalCost()), ("min", "min")),
        ("Vehicles, THEN total_cost", wb.Vehicles().then(wb.TotalCost()), ("min", "min")),
        ("total-cost - 2*reward", wb.TotalCost() - 2 * wb.Reward(), ("min",)),
        ("reward - .5 makespan", wb.Reward() - 0.5 * wb.Makespan(), ("max",)),
        ("-1 * reward + 1e2*vehicles", -1 * wb.Reward() + 100 * wb.Vehicles(), ("min",)),
    ],
)
def test_terms_weights_and_priorities(text: str, expected: object, senses: tuple[str, ...]) -> None:
    made = objective_from(text)
    assert made == Objective.of(expected)  # type: ignore[arg-type]
    assert made.senses == senses


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "a level is empty"),
        ("vehicles then", "a level is empty"),
        ("vehicles then then total-cost", "a level is empty"),
        ("total-costs", "did you mean 'total-cost'?"),
        ("TotalCost", "did you mean 'total-cost'?"),
        ("vehicle", "did you mean 'vehicles'?"),
        ("distance", "choose from total-cost"),
        ("reward-total-duration", "write blanks around - and +: reward - total-duration"),
        ("2*", "ends without a term"),
        ("vehicles +", "ends without a term"),
        ("vehicles vehicles", "not expected there"),
        ("vehicles + vehicles", "stands twice"),
        ("--vehicles", "not expected there"),
        ("vehicles * 2", "not expected there"),
        ("2 3*vehicles", "not expected there"),
        ("0*vehicles", "finite and not zero"),
        ("1e400*vehicles", "finite and not zero"),
        ("vehicles; total-cost", "not expected there"),
        ("vehicles\x1b[31m", "not expected there"),
    ],
)
def test_what_is_wrong_is_named_on_one_line(text: str, told: str) -> None:
    with pytest.raises(wb.UsageError) as refused:
        objective_from(text)
    assert told in str(refused.value)
    assert str(refused.value).isprintable()


WEIGHTS = st.floats(-1e6, 1e6, allow_nan=False).filter(lambda w: w != 0)
LEVELS = st.lists(st.tuples(WEIGHTS, st.sampled_from(sorted(TERMS))), min_size=1, max_size=4, unique_by=lambda pair: pair[1])


@settings(max_examples=draws(100), deadline=None)
@given(st.lists(LEVELS, min_size=1, max_size=3))
def test_what_an_objective_prints_reads_back(levels: list[list[tuple[float, str]]]) -> None:
    made = Objective(tuple(Weighted(tuple((w, TERMS[name]()) for w, name in level)) for level in levels))
    assert objective_from(str(made)) == made


@settings(max_examples=draws(100), deadline=None)
@given(st.text(alphabet="-+*.e01 ,thenvhiclsoa", max_size=30))
def test_any_text_is_an_objective_or_one_clear_error(text: str) -> None:
    try:
        made = objective_from(text)
    except wb.UsageError as error:
        assert "\n" not in str(error)
    else:
        assert objective_from(str(made)) == made


def test_files_constructors_and_frames_take_text() -> None:
    problem = wb.read("demo-tiny", objective="vehicles then total-cost")
    assert problem.senses == ("min", "min")
    same = wb.RoutingProblem(problem.sites, problem.travel, problem.fleet, objective="vehicles then total-cost")
    assert same.objective == problem.objective


def test_a_term_that_would_count_nothing_is_refused() -> None:
    with pytest.raises(wb.UsageError, match="no site of demo-tiny has any reward"):
        wb.read("demo-tiny", objective="total-cost - reward")


def test_other_families_have_no_such_setting() -> None:
    with pytest.raises(wb.UsageError, match="objective"):
        wb.read("sata-s3", objective="vehicles")
