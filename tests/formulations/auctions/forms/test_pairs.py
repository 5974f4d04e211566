"""What the forms of bin assignments share."""

from __future__ import annotations

import numpy as np
import pytest
from bin_assignments import worked

from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.auctions.forms._pairs import decoded, encoded, pair_rows
from waybound.instances.errors import InputError


def test_answers_and_vectors_stand_for_each_other() -> None:
    problem = worked("E")
    assert encoded(problem, (-1, 0, 1)).tolist() == [0, 0, 1, 0, 0, 1]
    assert decoded(problem, encoded(problem, (-1, 0, 1))) == (-1, 0, 1)
    with pytest.raises(InputError, match="a pair that is not allowed"):
        encoded(BinAssignment.from_matrix([[1.0, np.inf]]), (1,))


def test_who_is_all_asked_for_has_equations_and_else_the_pairs_are_counted() -> None:
    robots, bins = pair_rows(worked("F"))
    assert robots.lower.tolist() == [1, 1] and bins.lower.tolist() == [0, 0, 0]
    inf = np.inf
    few = pair_rows(BinAssignment.from_matrix([[1.0, inf], [2.0, inf]]))
    assert [block.name for block in few] == ["robot", "bin", "pairs"] and few[2].lower.tolist() == few[2].upper.tolist() == [1.0]
