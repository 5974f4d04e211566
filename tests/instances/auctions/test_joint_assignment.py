import math
from typing import Any

import numpy as np
import pytest

from waybound.instances.auctions.joint_assignment import JointAssignmentInstance
from waybound.instances.errors import InputError


def test_bins_are_full_unless_said_and_there_may_be_no_requests() -> None:
    made = JointAssignmentInstance([[1.0, math.inf]], np.zeros((1, 0)), np.zeros((0, 2)))
    assert (made.num_robots, made.num_bins, made.num_requests) == (1, 2, 0)
    assert made.filled is not None and made.filled.tolist() == [0.0, 0.0]
    assert made.facts() == {"robots": 1, "bins": 2, "requests": 0, "bringing": 0, "not_yet_full": 0}
    named = JointAssignmentInstance([[1.0, math.inf]], np.zeros((1, 0)), np.zeros((0, 2)), bin_names=("a", "b"))
    assert named.digest() == made.digest() and named.name_of("bin", 1) == "b" and made.name_of("robot", 0) == "1"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"to_bin": [[1.0, 2.0], [3.0]]}, "to_bin must be a matrix of numbers"),
        ({"to_bin": [[1.0, -2.0]]}, "to_bin of robot 1 and bin 2 must be from 0"),
        ({"to_bin": [[1.0, math.nan]]}, "to_bin of robot 1 and bin 2"),
        ({"to_bin": np.zeros((0, 2))}, "there are no robots"),
        ({"to_request": [[1.0], [2.0]]}, "to_request has another shape; expected 1 x any"),
        ({"between": [[1.0, math.inf]]}, "between of request 1 and bin 2 must be from 0 to 1e"),
        ({"between": [[1.0]]}, "between has another shape"),
        ({"filled": [1.0]}, "one time of being filled a bin"),
        ({"filled": [1.0, -1.0]}, "filled of bin 2"),
        ({"filled": [1.0, -1.0], "bin_names": ("a", "b")}, "filled of bin b must be from 0"),
        ({"between": [[1.0, math.inf]], "bin_names": ("a", "b"), "request_names": ("q",)}, "between of request q and bin b must be"),
        ({"robot_names": ("a", "b")}, "robot"),
    ],
)
def test_what_is_wrong_is_named(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        JointAssignmentInstance(**{"to_bin": [[1.0, 2.0]], "to_request": [[1.0]], "between": [[1.0, 2.0]], **change})
