"""Beliefs about rooms: the source's tables as they must be read, joint against marginal updates, and rewards."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.heuristics.auctions.exploration_steps.beliefs import (
    Rewards,
    Sensors,
    after_target,
    after_type,
    entropy,
    mutual_information,
    prior,
)
from waybound.instances.errors import InputError

TABLE = np.array([[0.5, 0.3, 0.2], [0.05, 0.9, 0.05], [0.1, 0.1, 0.8]])
SENSORS = Sensors(TABLE, 0.9, 0.05)
ROOM = prior([1 / 3] * 3, [0.1, 0.8, 0.6])


def test_the_prior_of_a_room():
    assert ROOM.sum(axis=0).tolist() == pytest.approx([0.5, 0.5])
    assert entropy(ROOM.sum(axis=1)) == pytest.approx(1.098612, abs=1e-6)
    assert entropy(ROOM.sum(axis=0)) == pytest.approx(0.693147, abs=1e-6)


def test_readings_of_the_type():
    types = np.full(3, 1 / 3)
    assert (types @ TABLE).tolist() == pytest.approx([0.216667, 0.433333, 0.35], abs=1e-6)
    expected = [(0.769231, 0.076923, 0.153846), (0.230769, 0.692308, 0.076923), (0.190476, 0.047619, 0.761905)]
    seen = [after_type(ROOM, SENSORS, reading) for reading in range(3)]
    for belief, row in zip(seen, expected, strict=True):
        assert belief.sum(axis=1).tolist() == pytest.approx(row, abs=1e-6)
        assert belief.sum() == pytest.approx(1.0)
    assert [entropy(b.sum(axis=1)) for b in seen] == pytest.approx([0.687092, 0.790268, 0.668018], abs=1e-6)
    assert [b[:, 0].sum() for b in seen] == pytest.approx([0.230769, 0.623077, 0.514286], abs=1e-6)
    assert mutual_information(types, TABLE) == pytest.approx(0.373487, abs=1e-6)


def test_one_surprising_reading_raises_the_entropy():
    sure = prior([0.9, 0.05, 0.05], [0.1, 0.8, 0.6])
    after = after_type(sure, SENSORS, 1).sum(axis=1)
    assert entropy(sure.sum(axis=1)) == pytest.approx(0.394398, abs=1e-6)
    assert after.tolist() == pytest.approx([0.84375, 0.140625, 0.015625]) and entropy(after) == pytest.approx(0.484193, abs=1e-6)


def test_repeated_readings_are_not_counted_twice():
    belief, seen = ROOM, []
    for _ in range(200):
        belief = after_type(belief, SENSORS, 1)
        seen.append(float(belief[:, 0].sum()))
    assert seen[:3] == pytest.approx([0.623077, 0.728571, 0.774769], abs=1e-6)
    assert max(seen) <= 0.8 + 1e-12 and seen[-1] == pytest.approx(0.8)


def test_a_report_of_a_target_tells_of_the_type_too():
    belief = after_target(ROOM, SENSORS, True)
    assert belief.sum(axis=0)[0] == pytest.approx(0.947368, abs=1e-6)
    assert belief.sum(axis=1).tolist() == pytest.approx([0.094737, 0.512281, 0.392982], abs=1e-6)
    assert after_target(ROOM, SENSORS, False).sum(axis=0)[0] < 0.5


def test_the_two_definitions_of_gain_change_the_decision():
    thesis, correct = Rewards((0.3, 0.3, 0.4), gain="entropy"), Rewards((0.3, 0.3, 0.4))
    assert thesis.explore(0) == 0.3
    assert thesis.map(ROOM, SENSORS) == pytest.approx(0.329584, abs=1e-6)
    assert thesis.search(ROOM, SENSORS) == pytest.approx(0.277259, abs=1e-6)
    assert correct.map(ROOM, SENSORS) == pytest.approx(0.112046, abs=1e-6)
    assert [Rewards((1, 0, 0)).explore(visits) for visits in range(4)] == [1, 0.5, 0.25, 0.125]


def test_information_is_never_negative_and_none_comes_of_a_useless_sensor():
    rng = np.random.default_rng(1)
    for _ in range(100):
        p, table = rng.dirichlet(np.ones(3)), rng.dirichlet(np.ones(4), 3)
        assert 0.0 <= mutual_information(p, table) <= entropy(p) + 1e-12
    assert mutual_information([0.2, 0.8], [[0.5, 0.5], [0.5, 0.5]]) == pytest.approx(0.0, abs=1e-15)


def test_tables_that_are_no_probabilities_are_refused():
    for make in (
        lambda: Sensors(TABLE.T, 0.9, 0.05), lambda: Sensors([[0.5, 0.3], [0.05, 0.9]], 0.9, 0.1), lambda: Sensors(TABLE, 1.2, 0.1),
        lambda: prior([0.5, 0.6], [0, 1]), lambda: prior([0.5, 0.5], [0, 2]), lambda: Rewards((0.5, 0.5, 0.5)),
        lambda: Rewards((1, 0, 0), decay=1.0), lambda: after_target(prior([1, 0], [0, 0]), Sensors(np.eye(2), 1.0, 0.0), True),
    ):  # fmt: skip
        with pytest.raises(InputError):
            make()
