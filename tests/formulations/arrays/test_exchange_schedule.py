"""Schedules of exchanges, and what the checker says of those that cannot be flown."""

import numpy as np
import pytest
from coded import coded

from waybound.formulations.arrays.exchange_schedule import Aloft, ExchangeCase, Sortie, faults, uncovered
from waybound.instances.errors import InputError


def case(**changes):
    values = {
        "travel": np.array([[1, 2], [1, 2], [2, 1]]), "flight": 6, "charge": 4, "ready": np.array([0, 0, 3]), "begin": np.array([2, 2]),
        "end": np.array([8, 6]),
    } | changes  # fmt: skip
    return ExchangeCase(**{key: np.array(v) if isinstance(v, list) else v for key, v in values.items()})


GOOD = [Sortie(0, 0, 2, 6), Sortie(1, 1, 2, 4), Sortie(2, 1, 4, 6)]


def test_a_schedule_that_can_be_flown():
    assert faults(case(), GOOD) == []
    assert uncovered(case(), GOOD) == 2
    assert uncovered(case(), []) == 10
    assert uncovered(case(), [Sortie(0, 0, 0, 99)]) == 4


@pytest.mark.parametrize(
    ("schedule", "says"),
    [
        ([Sortie(0, 0, 2, 7)], "robot 0 flies 7 steps, but its battery lasts 6"),
        ([Sortie(2, 0, 4, 6)], "robot 2 takes off at step 2, but is charged at step 3"),
        ([Sortie(0, 0, 2, 3), Sortie(0, 0, 8, 9)], "robot 0 takes off at step 7, but is charged at step 8"),
        ([Sortie(0, 0, 3, 2)], "leaves place 0 before it arrives"),
        ([Sortie(7, 0, 2, 3)], "there is no robot 7"),
        ([Sortie(0, 5, 2, 3)], "place 5, which does not exist"),
    ],
)
def test_the_checker_tells_what_cannot_be_flown(schedule, says):
    found = faults(case(), schedule)
    assert len(found) == 1 and says in found[0]


def test_robots_in_the_air_go_on_with_what_is_left():
    flying = case(aloft={1: Aloft(0, -2, -1)})
    assert faults(flying, [Sortie(1, 0, 0, 3)]) == []
    assert "flies 7 steps" in faults(flying, [Sortie(1, 0, 0, 4)])[0]
    assert "not as scheduled" in faults(flying, [Sortie(1, 1, 0, 2)])[0]
    assert "does not say until when" in faults(flying, [])[0]
    assert faults(case(aloft={1: Aloft(1, -1, 1)}), [Sortie(1, 1, 1, 3)]) == []


@pytest.mark.parametrize(
    ("changes", "message", "code"),
    [
        ({"flight": 0}, "flight time", "out-of-range"),
        ({"charge": -1}, "charging time must not be negative", "out-of-range"),
        ({"travel": [[0, 1], [1, 1], [1, 1]]}, "a step at least", "out-of-range"),
        ({"ready": [0, -1, 0]}, "ready before step 0", "out-of-range"),
        ({"ready": [0]}, "an entry for each", "wrong-shape"),
        ({"end": [1, 6]}, "ends before it begins", "out-of-range"),
        ({"flight": 2}, "no robot reaches any place", "out-of-range"),
        ({"aloft": {9: Aloft(0, -1, 0)}}, "robot 9 aloft", "contradiction"),
        ({"aloft": {1: Aloft(0, 0, 1)}}, "robot 1 aloft", "contradiction"),
    ],
)
def test_cases_that_make_no_sense_are_refused(changes, message, code):
    with pytest.raises(InputError, match=message, check=coded(code)):
        case(**changes)


def test_a_fleet_of_no_robot_is_refused():
    with pytest.raises(InputError, match="no robot to watch"):
        case(travel=np.zeros((0, 2), dtype=np.int64), ready=np.zeros(0, dtype=np.int64))
