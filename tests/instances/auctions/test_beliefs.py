"""Beliefs about rooms by the source's tables, joint against marginal updates."""

import itertools

import numpy as np
import pytest
from coded import coded

from waybound.instances.auctions.beliefs import (
    Rewards,
    Sensors,
    after_target,
    after_type,
    capacity,
    entropy,
    expected_gains,
    mutual_information,
    posterior,
    prior,
    sensors_from_text,
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
        lambda: Rewards((1, 0, 0), decay=1.0), lambda: Rewards((np.nan, 0.5, 0.5)), lambda: Rewards((1, 0, 0), first=np.inf),
    ):  # fmt: skip
        with pytest.raises(InputError):
            make()
    with pytest.raises(InputError, check=coded("contradiction")):
        after_target(prior([1, 0], [0, 0]), Sensors(np.eye(2), 1.0, 0.0), True)


def test_many_readings_at_once_are_those_one_by_one_in_any_order():
    rng = np.random.default_rng(4)
    for _ in range(30):
        types, targets = rng.integers(0, 4, 3), rng.integers(0, 4, 2)
        belief = ROOM
        for reading in rng.permutation(np.repeat(range(3), types)):
            belief = after_type(belief, SENSORS, int(reading))
        for reading in rng.permutation(np.repeat([True, False], targets)):
            belief = after_target(belief, SENSORS, bool(reading))
        assert posterior(ROOM, SENSORS, types, targets) == pytest.approx(belief)
    both = posterior(ROOM, SENSORS, [[3, 0, 0], [0, 0, 0]], [[0, 0], [0, 0]])
    assert both[1] == pytest.approx(ROOM) and both[0] == pytest.approx(posterior(ROOM, SENSORS, [3, 0, 0], [0, 0]))
    sure = Sensors(np.eye(3), 1.0, 0.0)
    assert posterior(ROOM, sure, [2, 0, 0], [1, 0]).tolist() == [[1, 0], [0, 0], [0, 0]]
    with pytest.raises(InputError, check=coded("contradiction")):
        posterior(ROOM, sure, [1, 1, 0], [0, 0])


def test_marginals_updated_in_turn_count_twice():
    told = [posterior(ROOM, SENSORS, [0, n, 0], [0, 0], joint=False) for n in (1, 2, 3)]
    assert [float(b[:, 0].sum()) for b in told] == pytest.approx([0.623077, 0.732091, 0.818748], abs=1e-6)
    once = posterior(ROOM, SENSORS, [0, 0, 0], [1, 0], joint=False)
    assert once.sum(axis=1).tolist() == pytest.approx([0.094737, 0.512281, 0.392982], abs=1e-6)


def test_expected_gains_are_the_mean_over_all_readings():
    rng = np.random.default_rng(2)
    states, table = rng.dirichlet(np.ones(3), 2), rng.dirichlet(np.ones(2), 3)
    told = expected_gains(states, table, 3)
    for p, gains in zip(states, told, strict=True):
        left = [float(entropy(p))]
        for count in (1, 2, 3):
            joints = [p * table[:, seen].prod(axis=1) for seen in itertools.product(range(2), repeat=count)]
            left.append(sum(float(j.sum() * entropy(j / j.sum())) for j in joints))
        assert gains.tolist() == pytest.approx((-np.diff(left)).tolist())


def test_no_belief_is_told_more_than_the_capacity():
    assert capacity(np.eye(3)) == pytest.approx(np.log(3)) and capacity(np.full((2, 2), 0.5)) == pytest.approx(0.0, abs=1e-12)
    flip = [[0.9, 0.1], [0.1, 0.9]]
    assert capacity(flip) == pytest.approx(np.log(2) - entropy(flip[0]))
    rng, most = np.random.default_rng(3), capacity(TABLE)
    assert 0.98 * most < mutual_information(rng.dirichlet(np.ones(3), 5000), TABLE).max() <= most


def test_tables_as_text():
    sensors = sensors_from_text("0.5 0.3 0.2; 0.05,0.9,0.05; 0.1 0.1 0.8", "0.9 0.1; 0.05 0.95")
    assert sensors.types.tolist() == TABLE.tolist() and sensors.targets == pytest.approx(np.array([[0.9, 0.1], [0.05, 0.95]]))
    for types, targets, message in (
        ("0.5 0.05 0.1; 0.3 0.9 0.1; 0.2 0.05 0.8", "1 0; 0 1", "type-sensor: each row, a true state, must be probabilities that sum to 1"),
        ("1 0 0; 0 1 0; 0 0 1", "0.5 0.3; 0.05 0.9", "target-sensor: each row, a true state, must be probabilities that sum to 1"),
        ("1 0 0; 0 1 0; 0 0 1", "0.5 0.3 0.2; 0 1 0", "target-sensor must be a table of 2 rows"),
        ("1 0 0; 0 1; 0 0 1", "1 0; 0 1", "type-sensor must be a table of 3 rows"),
        ("1 0 0; 0 1 0; 0 0 nan", "1 0; 0 1", "sum to 1"), ("1 0 x", "1 0; 0 1", "type-sensor must be numbers, rows apart by ;"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=message):
            sensors_from_text(types, targets)


def test_what_the_next_actions_gain():
    beliefs, visits = np.stack([ROOM, ROOM]), np.array([0, 2])
    visited, read, searched = Rewards((0.3, 0.3, 0.4), first=2.0).tables(beliefs, visits, SENSORS, 3)
    assert visited == pytest.approx(np.array([[0.6, 0.3, 0.15], [0.15, 0.075, 0.0375]]))
    assert read[0, 0] == pytest.approx(0.112046, abs=1e-6) and searched.shape == (2, 3)
    unknown = Rewards((0.3, 0.3, 0.4), gain="entropy").tables(beliefs, visits, SENSORS, 3)
    assert unknown[1][0, 0] == pytest.approx(0.329584, abs=1e-6) and unknown[2][0, 0] == pytest.approx(0.277259, abs=1e-6)
    assert unknown[1][0, 1] == pytest.approx(0.3 * 1.098612 - read[0, 0], abs=1e-6)
    assert all((np.diff(table) <= 0).all() for table in (*unknown, visited, read, searched))
