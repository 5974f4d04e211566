import numpy as np
import pytest
from hypothesis import given, strategies as st
from selection_problems import CONSTRAINTS, OWN_CONSTRAINTS, Apart, Budgets, random_problem
from truth.families import every_set, excess_of

from waybound.formulations.sata.feasibility import Openings, allowed, spendable, with_each
from waybound.instances.sata.constraints import Knapsack

ANY = st.sampled_from((*CONSTRAINTS, *OWN_CONSTRAINTS))


@given(st.integers(0, 10**6), ANY)
def test_sets_are_allowed_as_the_definition_says(seed: int, kind: str) -> None:
    problem = random_problem(np.random.default_rng(seed), "coverage", kind, 7)
    sets = list(every_set(problem))
    masks = np.array([np.isin(np.arange(problem.num_elements), s) for s in sets])
    assert allowed(problem.constraint, masks).tolist() == [excess_of(problem, s) is not None for s in sets]


@given(st.integers(0, 10**6), ANY)
def test_what_is_open_is_what_may_join(seed: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, "coverage", kind, 8)
    openings, chosen = Openings(problem.constraint, problem.num_elements), []
    while True:
        outside = [e for e in range(problem.num_elements) if e not in chosen]
        right = [e for e in outside if excess_of(problem, tuple(sorted((*chosen, e)))) is not None]
        assert openings.open().tolist() == right == [e for e in outside if openings.fits(e)]
        if not right:
            break
        chosen.append(int(rng.choice(right)))
        openings.take(chosen[-1])


def test_a_budget_leaves_room_for_the_rounding_of_sums_and_no_more() -> None:
    tenths = Knapsack(np.array([0.1, 0.1, 0.1, 1e-6]), 0.3)
    assert Openings(tenths, 4).take_in_order([0, 1, 2, 3]) == [0, 1, 2]
    assert spendable(Knapsack(np.ones(1), 1e12).rows(1))[0] == 1e12
    assert spendable(Budgets(np.array([[0.5, 0.0], [1.0, 2.0]]), np.array([1.0, 2.0])).rows(2)).tolist() == pytest.approx([1.0, 2.0])
    assert allowed(tenths, np.array([[True, True, True, False], [True, True, True, True]])).tolist() == [True, False]


def test_many_sets_are_asked_for_a_part_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("waybound.formulations.sata.feasibility.CHUNK", 12)
    parts = [(part, masks.sum(axis=1).tolist()) for part, masks in with_each(np.array([True, False, False, False]), np.arange(1, 4))]
    assert parts == [(slice(0, 3), [2, 2, 2])]
    monkeypatch.setattr("waybound.formulations.sata.feasibility.CHUNK", 4)
    assert len(list(with_each(np.zeros(4, dtype=bool), np.arange(4)))) == 4
    assert Openings(Apart(), 5).open().tolist() == [0, 1, 2, 3, 4]
