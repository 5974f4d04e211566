import numpy as np
import pytest

from waybound.instances.auctions.beliefs import expected_gains
from waybound.instances.auctions.generators.exploration_map import READINGS, TIMES
from waybound.instances.generating import generate


def test_the_first_observation_of_a_type_tells_what_is_worked_out_for_it() -> None:
    told = expected_gains(np.full(3, 1 / 3), READINGS, TIMES)
    assert told[0] == pytest.approx(0.373487, abs=1e-6) and (np.diff(told) < 0).all()
    assert expected_gains(np.full(2, 0.5), np.full((2, 2), 0.5), TIMES).tolist() == pytest.approx([0.0] * 3, abs=1e-12)
    assert expected_gains(np.full(2, 0.5), np.eye(2), TIMES).tolist() == pytest.approx([np.log(2.0), 0.0, 0.0], abs=1e-12)


def test_all_rooms_can_be_reached() -> None:
    for rooms in (1, 2, 7, 22):
        made = generate("exploration-map", rooms=rooms, seed=3)
        reached = np.zeros(rooms, dtype=bool)
        reached[0] = True
        for _ in range(rooms):
            reached |= made.adjacent[reached].any(axis=0)
        assert reached.all() and len(made.doors) >= rooms - 1 and made.num_rooms == rooms
        assert made.digest() == generate("exploration-map", rooms=rooms, seed=3).digest()
    assert made.mapping[5, 0] == pytest.approx(0.3 * 0.373487, abs=1e-6)
    assert made.exploring[0].tolist() == [0.15, 0.075, 0.0] and made.exploring[1].tolist() == [0.3, 0.15, 0.075]
