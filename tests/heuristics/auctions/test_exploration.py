import numpy as np
import pytest
from coded import coded
from draws import draws

from waybound.formulations.auctions.room_exploration import GO, MAP
from waybound.heuristics.auctions._exploration import allowed, explorers_and_relays, steps_to_contact
from waybound.instances.errors import InputError


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
