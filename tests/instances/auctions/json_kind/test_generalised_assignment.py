"""Generalised assignments in JSON."""

from __future__ import annotations

import math

import pytest

from waybound.instances.auctions.generalised_assignment import GeneralisedAssignmentInstance
from waybound.instances.auctions.json_kind.generalised_assignment import decode, encode
from waybound.instances.errors import InputError

COSTS = GeneralisedAssignmentInstance([[1.0, math.inf], [2.5, 3.0]], [[1.0, 2.0], [3.0, 4.0]], [5.0, 6.0], job_names=("x", "y"))


def test_forbidden_pairs_are_null_and_the_key_says_what_values_mean() -> None:
    data = encode(COSTS)
    assert data["cost"] == [[1, None], [2.5, 3]] and data["agents"] == {"count": 2, "capacity": [5, 6]}
    assert decode(data).digest() == COSTS.digest() and decode(data).job_names == ("x", "y")
    profits = GeneralisedAssignmentInstance([[1.0, -math.inf]], [[1.0, 2.0]], [5.0], "profit")
    assert encode(profits)["profit"] == [[1, None]] and decode(encode(profits)).digest() == profits.digest()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"cost": [[1, 2]]}, "cost has a wrong length; expected 2; found 1"),
        ({"cost": [[1, 2], [3]]}, r"cost\[1\] has a wrong length"),
        ({"profit": [[1, 2], [3, 4]]}, "either costs or profits"),
        ({"consumption": [[1, 2], [3, None]]}, r"consumption\[1\]"),
        ({"problem": "tsp"}, "problem is none of generalised assignments"),
        ({"agents": {"count": 2}}, "lacks the key 'capacity'"),
    ],
)
def test_what_is_wrong_is_named(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        decode({**encode(COSTS), **change})
