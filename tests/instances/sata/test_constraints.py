from typing import Any

import numpy as np
import pytest
from file_cases import refused
from hypothesis import given, strategies as st
from selection_problems import CONSTRAINTS, OWN_CONSTRAINTS, random_problem
from truth.families import every_set, excess_of

from waybound.instances.instance import digest
from waybound.instances.sata.constraints import Cardinality, Knapsack, PartitionMatroid


def test_one_limit_holds_for_all_groups_or_each_has_its_own() -> None:
    assert PartitionMatroid.of([0, 2, 0]).limits.tolist() == [1, 1, 1]
    assert PartitionMatroid.of([0, 2, 0], 5).limits.tolist() == [5, 5, 5]
    assert PartitionMatroid.of([0, 1, 0], [2, 0, 7]).limits.tolist() == [2, 0, 7]


@given(st.integers(0, 10**6), st.sampled_from((*CONSTRAINTS, *OWN_CONSTRAINTS)))
def test_every_view_of_a_constraint_says_the_same(seed: int, kind: str) -> None:
    problem = random_problem(np.random.default_rng(seed), "coverage", kind, 7)
    c, n = problem.constraint, problem.num_elements
    partition, knapsack, rows = c.as_partition(n), c.as_knapsack(), c.rows(n)
    assert (rows is None) == (kind == "own-oracle")
    for chosen in every_set(problem):
        elements = np.array(chosen, dtype=np.int64)
        mask = np.isin(np.arange(n), elements)[None, :]
        right = excess_of(problem, chosen) == 0
        assert bool(c.allows(mask)[0]) == right
        assert bool((c.excess(elements, n)[0] <= 0).all()) == right
        for view in (partition, knapsack):
            assert view is None or bool((view.excess(elements, n)[0] <= 0).all()) == right
        if rows is not None:
            assert rows.totals(mask)[0] == pytest.approx([costs[elements].sum() for costs, _ in rows.budgets(n)])


def test_groups_may_have_names() -> None:
    robots = PartitionMatroid(np.array([0, 1, 1]), np.array([1, 1]), "robot", ["ann", "bob"].__getitem__)  # type: ignore[arg-type]
    amounts, message = robots.excess(np.array([1, 2]), 3)
    assert (amounts.tolist(), message(0)) == ([1.0], "2 elements of robot bob are chosen, 1 allowed")
    rows = robots.rows(3)
    assert [rows.label_of(k) for k in range(2)] == ["robot ann", "robot bob"]
    assert digest(*robots.parts()) == digest(*PartitionMatroid.of([0, 1, 1]).parts())


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Cardinality(0), "must be a whole number of at least 1; found 0"),
        (lambda: Cardinality(2.0), "must be a whole number of at least 1; found 2.0"),
        (lambda: Cardinality(True), "must be a whole number"),
        (lambda: Cardinality("3"), "must be a whole number of at least 1; found '3'"),
        (lambda: PartitionMatroid([0, 2], [1, 1]), "the group of element 2 does not exist; expected 0 to 1; found 2"),
        (lambda: PartitionMatroid([0, -1], [1, 1]), "the group of element 2 does not exist"),
        (lambda: PartitionMatroid([0], [-1]), "the limit of group 0 must not be negative; found -1"),
        (lambda: PartitionMatroid.of([0, 10**9]), "there are 1000000001 groups, but only 2 elements"),
        (lambda: PartitionMatroid.of([0.5]), "groups must be a list of whole numbers"),
        (lambda: Knapsack([1, -1], 3), "the cost of element 2 must be finite and not negative"),
        (lambda: Knapsack([1, np.nan], 3), "the cost of element 2"),
        (lambda: Knapsack([1], -1), "the budget must be a finite number, not negative; found -1"),
        (lambda: Knapsack([1], np.inf), "the budget must be a finite number"),
        (lambda: Knapsack([1], "much"), "budget must hold numbers"),
    ],
)  # fmt: skip
def test_bad_input_is_one_clear_line(make: Any, says: str) -> None:
    assert says in refused(make)


def test_they_show_themselves_in_one_line() -> None:
    assert all(len(repr(c)) < 80 for c in (PartitionMatroid.of(np.arange(500)), Knapsack(np.ones(500), 3), Cardinality(3)))
