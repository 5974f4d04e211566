from typing import Any

import numpy as np
import pytest

from waybound.instances.auctions.exploration_map import ExplorationMap
from waybound.instances.errors import InputError

GOOD: dict[str, Any] = {
    "doors": [(0, 1), (1, 2)], "exploring": [[0.0], [1.0], [1.0]], "mapping": np.zeros((3, 0)), "searching": [[1.0, 0.5]] * 3,
    "starts": [0, 0], "base": 0, "heard": [(1, 2)], "silence": 1, "steps": 4,
}  # fmt: skip


def test_doors_lead_both_ways_and_a_room_hears_itself() -> None:
    made = ExplorationMap(**GOOD)
    assert made.adjacent.tolist() == [[False, True, False], [True, False, True], [False, True, False]]
    assert made.linked.tolist() == [[True, False, False], [False, True, True], [False, True, True]]
    assert made.facts()["exploring"] == 2.0 and made.facts()["mapping"] == 0.0
    turned = ExplorationMap(**{**GOOD, "doors": [(2, 1), (1, 0)], "room_names": ("a", "b", "c")})
    assert turned.digest() == made.digest() and turned.room_name(1) == "b"
    assert ExplorationMap(**{**GOOD, "silence": 2}).digest() != made.digest()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"exploring": [[0.0], [1.0, 2.0], [1.0]]}, "exploring must be a matrix of numbers"),
        ({"searching": [[0.5, 1.0]] * 3}, "searching of room 1, time 2 must be at least 0, and no more than the time before"),
        ({"searching": [[1.0, -1.0]] * 3}, "searching of room 1, time 2"),
        ({"searching": [[np.nan, 1.0]] * 3}, "searching of room 1, time 1"),
        ({"mapping": np.zeros((2, 0))}, "mapping has another shape; expected 3 x any"),
        ({"exploring": np.zeros((0, 1))}, "there are no rooms"),
        ({"doors": [(0, 3)]}, "a room of doors, entry 2"),
        ({"doors": [(1, 1)]}, "doors must join two different rooms"),
        ({"starts": []}, "there are no robots"),
        ({"starts": [3]}, "the start of robot 1"),
        ({"base": 3}, "the base must be a room; expected 0 to 2"),
        ({"silence": -1}, "silence must be"),
        ({"steps": 0}, "steps must be"),
        ({"steps": 2.5}, "steps must be"),
        (
            {"doors": [(0, 1)], "room_names": ("hall", "lab", "vault")},
            "no doors lead from a robot to 1 of the 3 rooms: vault; expected doors",
        ),
        ({"doors": [(0, 1)], "starts": [0, 2], "heard": [(0, 1)]}, "robot 2 can enter no room from which links lead to the base"),
    ],
)
def test_what_is_wrong_is_named(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        ExplorationMap(**{**GOOD, **change})
