import numpy as np
import pytest
from coded import coded
from draws import draws
from explorations import enumerated, path, random_map

from waybound.formulations.auctions.checking.best_increments import check_best_increments
from waybound.instances.errors import InputError


def test_no_plan_gains_more() -> None:
    rng = np.random.default_rng(6)
    for _ in range(draws(15)):
        problem = random_map(rng)
        assert check_best_increments(problem, {}) >= enumerated(problem)


def test_a_room_out_of_reach_gains_nothing() -> None:
    assert check_best_increments(path(4, 9, 2, 1, 3), {}) == 0.0
    assert check_best_increments(path(4, 9, 3, 1, 3), {}) == pytest.approx(1.0)
    assert check_best_increments(path(4, 9, 1, 1, 0), {}) == 0.0, "out of the start and back takes two steps"
    assert check_best_increments(path(4, 9, 2, 1, 0), {}) == pytest.approx(1.0)


def test_data_are_refused() -> None:
    with pytest.raises(InputError, check=coded("malformed")):
        check_best_increments(path(3, 0, 1), {"x": 1})
