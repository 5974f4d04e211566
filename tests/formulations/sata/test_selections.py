"""Answers of selection problems, and what judges them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from waybound.formulations.sata.selections import Selection, judge_elements
from waybound.instances.errors import UsageError


def test_any_whole_numbers_make_a_selection():
    made = Selection.of(np.array([3, 1]), winners=iter([0, -1]))
    assert (made.elements, made.winners, len(made), list(made)) == ((3, 1), (0, -1), 2, [3, 1])
    assert Selection.of([]) == Selection()


@pytest.mark.parametrize("elements", [["a"], 3, None, [[1]]])
def test_anything_else_does_not(elements):
    with pytest.raises(UsageError, match="a selection is a list of element numbers"):
        Selection.of(elements)


@given(st.lists(st.integers(-2, 6) | st.just(10**40), max_size=8))
def test_elements_that_exist_and_stand_once_pass(elements):
    chosen, (check, faults) = judge_elements(Selection.of(elements), 5, "elements", "element", str)
    assert chosen.tolist() == sorted({e for e in elements if 0 <= e < 5})
    bad = sum(not 0 <= e < 5 for e in elements) + sum(elements[:k].count(e) > 0 for k, e in enumerate(elements) if 0 <= e < 5)
    assert len(faults) == bad
    assert (check.passed, check.tested) == (bad == 0, len(elements))
