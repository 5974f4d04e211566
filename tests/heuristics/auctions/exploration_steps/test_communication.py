"""How far robots may go out of contact: by the predicate, on paths, the depths of the closed form."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.heuristics.auctions.exploration_steps.communication import allowed, steps_to_contact
from waybound.instances.errors import InputError

PATH = np.abs(np.arange(14)[:, None] - np.arange(14)) == 1


def deepest(contact, longest):
    """The farthest room of a path that a robot reaches by moves that are allowed, out of all states."""
    away = steps_to_contact(PATH, contact)
    seen, ahead = {(0, 0)}, [(0, 0)]
    while ahead:
        room, silent = ahead.pop()
        for after in np.nonzero(PATH[room])[0].tolist():
            state = (after, 0 if contact[after] else silent + 1)
            if state not in seen and allowed(state[1], int(away[after]), longest):
                seen.add(state)
                ahead.append(state)
    return max(room for room, _ in seen)


@pytest.mark.parametrize("near", [0, 1, 3])
def test_on_a_path_the_depth_is_that_of_the_closed_form(near):
    contact = np.arange(14) <= near
    assert [deepest(contact, longest) for longest in range(8)] == [near + (longest + 1) // 2 for longest in range(8)]


def test_a_relay_lets_the_other_go_on():
    assert deepest(np.arange(14) <= 1, 0) == 1  # within one edge of the base
    assert deepest(np.arange(14) <= 2, 0) == 2  # and of a relay one edge away from it


def test_steps_to_contact():
    assert steps_to_contact(PATH, np.arange(14) == 2).tolist() == [2, 1, 0, *range(1, 12)]
    assert steps_to_contact(np.zeros((2, 2)), [True, False]).tolist() == [0, -1]
    assert not allowed(1, -1, 9)
    for call in (lambda: steps_to_contact(PATH, [True]), lambda: allowed(1, 1, -1)):
        with pytest.raises(InputError):
            call()
