"""Maps of rooms in JSON."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.instances.auctions.exploration_map import ExplorationMap
from waybound.instances.auctions.json_kind.exploration_map import decode, encode
from waybound.instances.errors import InputError

MADE = ExplorationMap(
    [(0, 1)], [[0.0], [1.0]], np.zeros((2, 0)), [[1.0, 0.5]] * 2, [0], 0, [], 1, 4, ("a", "b"), np.array([[0.0, 0.0], [1.0, 0.0]])
)


def test_a_map_is_the_same_again() -> None:
    data = encode(MADE)
    assert data["rooms"]["mapping"] == [[], []] and data["doors"] == [[0, 1]] and data["heard"] == []
    again = decode(data)
    assert again.digest() == MADE.digest() and again.room_names == ("a", "b") and again.positions is not None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"doors": [[0]]}, r"doors\[0\]"),
        ({"problem": "tsp"}, "problem is none of maps of rooms"),
        ({"robots": [0.5]}, "robots"),
        ({"rooms": {**encode(MADE)["rooms"], "exploring": [[0], [1, 2]]}}, r"rooms.exploring\[1\]"),
        ({"rooms": {k: v for k, v in encode(MADE)["rooms"].items() if k != "y"}}, "one coordinate alone"),
    ],
)
def test_what_is_wrong_is_named(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        decode({**encode(MADE), **change})
