from typing import Any

import numpy as np
import pytest
from coded import coded

from waybound.instances.errors import UsageError
from waybound.instances.generating import generate


def made(seed: int = 1, **settings: Any) -> Any:
    return generate("coverage", seed, **settings)


def test_sets_hold_at_most_as_many_items_as_were_drawn() -> None:
    i = made(elements=200, items=50, per_element=12)
    sizes = np.diff(i.function.indptr)
    assert (i.function.num_elements, i.function.num_items) == (200, 50)
    assert sizes.max() <= 12 and sizes.min() >= 1
    expected = 50 * (1 - (1 - 1 / 50) ** 12)  # of different items among twelve draws
    assert sizes.mean() == pytest.approx(expected, abs=0.5)
    assert i.function.item_weights.min() >= 0.5 and i.function.item_weights.max() <= 2.0


def test_the_constraint_is_one_of_three() -> None:
    assert made(k=7).constraint.limit == 7
    groups = made(constraint="partition", elements=10, k=4).constraint
    assert groups.groups.tolist() == [0, 1, 2, 3, 0, 1, 2, 3, 0, 1]
    assert groups.limits.tolist() == [1, 1, 1, 1]
    sack = made(constraint="knapsack", elements=300, k=20).constraint
    assert sack.budget == 20.0
    assert sack.costs.min() >= 0.5 and sack.costs.max() <= 1.5


def test_the_constraint_changes_nothing_in_the_sets() -> None:
    first, second = (made(constraint=c).function for c in ("cardinality", "partition"))
    assert np.array_equal(first.indices, second.indices)


def test_more_draws_than_memory_allows_are_refused() -> None:
    with pytest.raises(UsageError, check=coded("too-large")):
        made(elements=10_000_000, per_element=100)
