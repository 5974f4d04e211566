import math

import numpy as np
import pytest

from waybound.instances.errors import UsageError
from waybound.solvers.engines.sata.local_max_min import robot
from waybound.solvers.engines.sata.local_max_min.robot import MOST_LEVELS, CommonLevels, SteppedLevels


def of_least(least: float) -> robot.Tested:
    return robot.Tested(least, 0, np.zeros(1))


def test_common_levels_span_half_of_the_least_ceiling_to_the_largest() -> None:
    levels = CommonLevels(0.1)
    ((name, (first, tried)),) = levels.families(levels.wanted([3.0, 5.0])).items()
    assert name == 0.0 and levels.names((1, 2)) == (0.0,)
    assert tried[0] < 1.5 and tried[-1] > 5.0 and (np.diff(tried) > 0).all()
    assert (tried[1:] / tried[:-1] <= 1.1 + 1e-12).all()
    assert levels.families(levels.join([levels.wanted([3.0]), levels.wanted([5.0])]))[0.0][1].tolist() == tried.tolist()
    assert levels.families((first + 1, first + 2))[0.0][1].tolist() == tried[1:3].tolist()


def test_stepped_levels_go_down_from_each_ceiling_to_half_of_it() -> None:
    levels = SteppedLevels(0.5)
    request = levels.join([levels.wanted([4.0, 3.0, 4.0]), levels.wanted([2.0])])
    assert request == (2.0, 3.0, 4.0) == levels.names(request)
    assert {u: v[1].tolist() for u, v in levels.families(request).items()} == {
        2.0: [0.5, 1.0, 1.5, 2.0], 3.0: [1.0, 1.5, 2.0, 2.5, 3.0], 4.0: [1.5, 2.0, 2.5, 3.0, 3.5, 4.0],
    }  # fmt: skip


def test_common_levels_cross_between_two_of_them_and_stepped_ones_at_the_last_that_holds() -> None:
    tried, reds = np.array([1.0, 2.0, 4.0]), np.array([3.0, 1.0, -1.0])
    assert CommonLevels(0.5).crossing(reds, tried, 1.0)[0] == 3.0  # half way from 2 to 4
    assert SteppedLevels(0.5).crossing(reds, tried, 1.0)[0] == 2.0
    for levels in (CommonLevels(0.5), SteppedLevels(0.5)):
        assert levels.crossing(np.array([1.0, 1.0, 0.0]), tried, 1.0)[0] == math.inf
        assert levels.crossing(np.array([-1.0, -2.0, -3.0]), tried, 1.0)[0] == 1.0


def test_a_rounding_below_0_is_no_crossing_of_steps() -> None:
    assert SteppedLevels(0.5).crossing(np.array([1.0, -1e-13]), np.array([1.0, 2.0]), 1.0)[0] == math.inf


def test_a_root_settles_within_its_ceiling_and_half_of_it() -> None:
    found = {4.0: of_least(3.5), 2.0: of_least(0.3), 8.0: of_least(math.inf)}
    assert [SteppedLevels(0.5).settle(u, found) for u in (4.0, 2.0, 8.0)] == [3.5, 1.0, 8.0]
    assert CommonLevels(0.5).settle(4.0, {0.0: of_least(2.5)}) == 2.5


@pytest.mark.parametrize("levels", [CommonLevels(0.1), SteppedLevels(0.5)])
def test_what_is_said_is_understood(levels: CommonLevels | SteppedLevels) -> None:
    request = levels.wanted([4.0, 3.0])
    found = {name: robot.Tested(float(k), k, np.arange(3.0) + k) for k, name in enumerate(levels.names(request))}
    said = levels.message(found)
    heard = levels.read(request, said)
    assert list(heard) == list(found)
    for name, one in found.items():
        assert (heard[name].least, heard[name].first, heard[name].reds.tolist()) == (one.least, one.first, one.reds.tolist())
    numbers = [number for least, first, reds in said for number in (least, first, *reds)]
    assert {type(number) for number in numbers} <= {int, float}


def test_more_levels_than_robots_can_test_at_once_are_refused_by_the_option() -> None:
    with pytest.raises(UsageError, match=r"with step=1e-06; the limit is 100000"):
        SteppedLevels(1e-6).families((1.0,))
    with pytest.raises(UsageError, match=r"with eps=1e-06"):
        levels = CommonLevels(1e-6)
        levels.families(levels.wanted([1.0]))
    assert len(SteppedLevels(1.0 / MOST_LEVELS).families((1.0,))[1.0][1]) <= MOST_LEVELS
