"""Objectives are composed of terms by weights and in order of priority."""

from __future__ import annotations

import math

import pytest

from waybound.formulations.routing.objective import Composable, Makespan, Objective, Reward, TotalCost, Vehicles, Weighted
from waybound.instances.errors import UsageError


def test_the_sense_of_a_level_is_that_of_its_first_term():
    assert Objective.of(TotalCost()).senses == ("min",)
    assert Reward().then(Makespan()).senses == ("max", "min")
    assert Objective.of(Reward() - 0.5 * TotalCost()).senses == ("max",)
    assert Objective.of(-1.0 * Reward() + TotalCost()).senses == ("min",)


def test_weights_spread_over_sums_and_differences():
    assert (2 * (TotalCost() + 3 * Vehicles())).terms == ((2.0, TotalCost()), (6.0, Vehicles()))
    assert (TotalCost() - (Vehicles() + 2 * Makespan())).terms == ((1.0, TotalCost()), (-1.0, Vehicles()), (-2.0, Makespan()))


def test_then_appends_levels_in_order():
    objective = Vehicles().then(TotalCost()).then(Makespan())
    assert [str(level) for level in objective.levels()] == ["vehicles", "total-cost", "makespan"]
    assert objective.is_only(Vehicles, TotalCost, Makespan)
    assert not objective.is_only(Vehicles)
    assert not Objective.of(2.0 * TotalCost()).is_only(TotalCost)


def test_names_make_an_objective():
    assert Objective.named(("vehicles", "total-cost")) == Vehicles().then(TotalCost())
    with pytest.raises(UsageError, match="unknown objective term 'profit'"):
        Objective.named(("profit",))
    with pytest.raises(UsageError, match="at least one term"):
        Objective.named(())


def test_text_tells_weights_apart_that_differ_in_their_last_digits():
    near = 0.1 + 1e-12
    assert str(Objective.of(0.1 * TotalCost())) == "0.1*total-cost"
    assert str(Objective.of(near * TotalCost())) != str(Objective.of(0.1 * TotalCost()))
    assert str(Objective.of(TotalCost() - 2 * Vehicles())) == "total-cost - 2*vehicles"


@pytest.mark.parametrize("weight", [0.0, math.nan, math.inf])
def test_a_weight_must_be_finite_and_not_zero(weight):
    with pytest.raises(UsageError, match="weight of total-cost"):
        weight * TotalCost()


def test_levels_are_not_lost_in_a_sum():
    with pytest.raises(UsageError, match="cannot be added"):
        TotalCost() + Vehicles().then(TotalCost())  # type: ignore[operator]
    with pytest.raises(UsageError):
        Weighted(())


def test_a_composable_says_its_levels():
    with pytest.raises(TypeError):
        Composable()  # type: ignore[abstract]


@pytest.mark.parametrize(
    "aim", [TotalCost() + Vehicles() * 3, Reward() - 0.25 * Makespan(), (-2 * Makespan()).then(TotalCost() - Reward())]
)
def test_what_is_printed_reads_back_the_same(aim):
    objective = Objective.of(aim)
    assert Objective.named(tuple(str(level) for level in objective.levels())) == objective


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("reward - profit", "unknown objective term 'profit'"),
        ("x*reward", "weight of reward must be a number, not 'x'"),
        ("0*reward", "not zero"),
    ],
)
def test_a_sum_that_cannot_be_read_is_refused(text, message):
    with pytest.raises(UsageError, match=message):
        Objective.named((text,))
