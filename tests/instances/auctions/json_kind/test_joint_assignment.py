"""Joint assignments in JSON."""

from __future__ import annotations

import math

import numpy as np
import pytest

from waybound.instances.auctions.joint_assignment import JointAssignmentInstance
from waybound.instances.auctions.json_kind.joint_assignment import decode, encode
from waybound.instances.errors import InputError

MADE = JointAssignmentInstance([[1.0, math.inf]], [[2.0]], [[3.0, 4.0]], np.array([0.0, math.inf]), request_names=("x",))


def test_what_is_not_allowed_is_null() -> None:
    data = encode(MADE)
    assert data["to_bin"] == [[1, None]] and data["bins"] == {"count": 2, "filled": [0, None]} and data["requests"]["name"] == ["x"]
    assert decode(data).digest() == MADE.digest()
    none = JointAssignmentInstance([[1.0]], np.zeros((1, 0)), np.zeros((0, 1)))
    assert encode(none)["to_request"] == [[]] and decode(encode(none)).digest() == none.digest()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"to_bin": [[1]]}, r"to_bin\[0\] has a wrong length"),
        ({"between": [[1, None]]}, r"between\[0\]"),
        ({"problem": "tsp"}, "problem is none of joint assignments"),
        ({"robots": {"count": 1, "filled": [1]}}, "unknown key 'filled'"),
    ],
)
def test_what_is_wrong_is_named(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        decode({**encode(MADE), **change})
