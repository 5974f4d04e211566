"""Costs of assignments in JSON."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.instances.auctions.assignment import AssignmentInstance
from waybound.instances.auctions.json_kind.assignment import decode, encode
from waybound.instances.errors import InputError


def test_many_pairs_are_a_matrix_with_null_and_few_are_lists() -> None:
    dense = AssignmentInstance.from_matrix([[1.0, np.inf], [2.5, 3.0]], filled=np.array([0.0, np.inf]), bin_names=("x", "y"))
    data = encode(dense)
    assert data["cost"] == [[1, None], [2.5, 3]] and data["bins"] == {"count": 2, "name": ["x", "y"], "filled": [0, None]}
    assert decode(data).digest() == dense.digest()
    sparse = AssignmentInstance.from_pairs(3, 3, [0, 2], [1, 2], [1.0, 2.0])
    assert encode(sparse)["pairs"] == {"robot": [0, 2], "bin": [1, 2], "cost": [1, 2]}
    assert decode(encode(sparse)).digest() == sparse.digest()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"cost": None}, "cost must be a list"),
        ({"cost": [[1, 2]]}, "cost has a wrong length; expected 2; found 1"),
        ({"cost": [[1, 2], [3]]}, r"cost\[1\] has a wrong length"),
        ({"pairs": {"robot": [], "bin": [], "cost": []}}, "costs stand in one of two ways"),
        ({"problem": "tsp"}, "problem is none of assignments"),
        ({"robots": {"count": 0}}, "robots.count must be a whole number"),
        ({"robots": {"count": 2, "x": [1, 2]}}, "one coordinate alone"),
    ],
)
def test_what_is_wrong_is_named(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        decode({**encode(AssignmentInstance.from_matrix([[1.0, 2.0], [3.0, 4.0]])), **change})
