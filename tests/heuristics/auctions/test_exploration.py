"""Beliefs about rooms by the source's tables, joint against marginal updates; steps of teams in which robots pass on what others read."""

from __future__ import annotations

import numpy as np
import pytest
from coded import coded
from draws import draws

from waybound.formulations.auctions.room_exploration import GO, MAP
from waybound.heuristics.auctions._exploration import (
    Rewards,
    Sensors,
    after_target,
    after_type,
    allowed,
    entropy,
    explorers_and_relays,
    mutual_information,
    prior,
    steps_to_contact,
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
        lambda: Rewards((1, 0, 0), decay=1.0),
    ):  # fmt: skip
        with pytest.raises(InputError):
            make()
    with pytest.raises(InputError, check=coded("contradiction")):
        after_target(prior([1, 0], [0, 0]), Sensors(np.eye(2), 1.0, 0.0), True)


def contact(linked: np.ndarray, base: int, rooms: list[int]) -> list[bool]:
    """Who is joined to the base, over others or not: as the judge has it, by plain search."""
    found, front = set(), [base]
    while front:
        room = front.pop()
        for robot, at in enumerate(rooms):
            if robot not in found and linked[room, at]:
                found.add(robot)
                front.append(at)
    return [robot in found for robot in range(len(rooms))]


def played(adjacent, linked, robots, longest, steps, *, relays, decay=0.5):
    """Rooms of the robots after each step, the longest that one was without contact, and visits."""
    here, silent, teams = [0] * robots, [0] * robots, {}
    visits, worst, ways = np.zeros(len(adjacent), int), 0, [tuple([0] * robots)]
    for _ in range(steps):
        worth = lambda room, kind, others: decay ** (visits[room] + others) if kind == GO else 0.0  # noqa: E731
        deeds, teams = explorers_and_relays(adjacent, linked, 0, here, silent, longest, worth, teams, relays=relays)
        assert sorted(deeds) == list(range(robots))
        assert all(room == at or adjacent[at, room] for (room, _), at in zip((deeds[k] for k in range(robots)), here, strict=True))
        for k in range(robots):
            visits[deeds[k][0]] += deeds[k][0] != here[k]
        here = [deeds[k][0] for k in range(robots)]
        silent = [0 if heard else age + 1 for heard, age in zip(contact(linked, 0, here), silent, strict=True)]
        worst = max(worst, *silent)
        ways.append(tuple(here))
    return ways, worst, visits


def path(rooms: int) -> np.ndarray:
    return np.abs(np.arange(rooms)[:, None] - np.arange(rooms)) == 1


@pytest.mark.parametrize(("robots", "relays", "depth"), [(2, False, 1), (2, True, 2), (3, True, 3), (4, True, 4), (4, False, 1)])
def test_each_relay_leads_another_robot_one_room_further(robots, relays, depth):
    adjacent = path(7)
    ways, worst, _ = played(adjacent, adjacent | np.eye(7, dtype=bool), robots, 0, 30, relays=relays)
    assert (max(map(max, ways)), worst) == (depth, 0)


@pytest.mark.parametrize("longest", range(5))
def test_alone_a_robot_goes_as_deep_as_the_closed_form_says(longest):
    ways, worst, _ = played(path(8), np.eye(8, dtype=bool), 1, longest, 60, relays=True)
    assert max(map(max, ways)) == (longest + 1) // 2 and worst <= longest


@pytest.mark.parametrize("relays", [False, True])
def test_nobody_is_ever_silent_for_too_long(relays):
    rng = np.random.default_rng(5)
    for _ in range(draws(60)):
        rooms, robots, longest = int(rng.integers(2, 9)), int(rng.integers(1, 5)), int(rng.integers(0, 4))
        adjacent = np.zeros((rooms, rooms), dtype=bool)
        for k in range(1, rooms):
            adjacent[k, rng.integers(0, k)] = True
        adjacent |= adjacent.T
        linked = adjacent & (rng.random((rooms, rooms)) < 0.7)
        linked = linked | linked.T | np.eye(rooms, dtype=bool)
        assert played(adjacent, linked, robots, longest, 25, relays=relays)[1] <= longest


def test_an_offer_is_taken_only_for_more_than_it_costs():
    adjacent = path(3)
    linked = adjacent | np.eye(3, dtype=bool)
    for beyond, moved in ((1.01, True), (1.0, False)):  # against 0.5 for each of them alone
        worth = lambda room, kind, others, beyond=beyond: (  # noqa: E731
            (beyond if room == 2 else 0.0) if kind == GO else 0.5 if (room, kind) == (1, MAP) and not others else 0.0
        )
        deeds, teams = explorers_and_relays(adjacent, linked, 0, [1, 1], [0, 0], 0, worth)
        assert (deeds[0] == (2, GO), teams == {0: (1,)}) == (moved, moved)


PATH = path(14)


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
    for call, code in ((lambda: steps_to_contact(PATH, [True]), "wrong-shape"), (lambda: allowed(1, 1, -1), "out-of-range")):
        with pytest.raises(InputError, check=coded(code)):
            call()
