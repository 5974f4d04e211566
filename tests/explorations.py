"""Maps of rooms for tests: paths, random ones, and their optima by enumeration."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from waybound.formulations.auctions.room_exploration import RoomExploration
from waybound.instances.auctions.exploration_map import ExplorationMap


def path(
    rooms: int, silence: int, steps: int, robots: int = 1, target: int = 1, heard: tuple[tuple[int, int], ...] = ()
) -> RoomExploration:
    """Rooms in a row, the base at one end, and 1 to be gained by a visit of one of them."""
    gains = np.zeros((rooms, 1))
    gains[target] = 1.0
    doors, none = [(k, k + 1) for k in range(rooms - 1)], np.zeros((rooms, 0))
    return RoomExploration(ExplorationMap(doors, gains, none, none, [0] * robots, 0, heard, silence, steps))


def random_map(rng: np.random.Generator) -> RoomExploration:
    """A tree of up to four rooms, some of which hear their neighbours, one or two robots and few steps."""
    rooms, robots = int(rng.integers(2, 5)), int(rng.integers(1, 3))
    doors = [(k, int(rng.integers(0, k))) for k in range(1, rooms)]
    heard = [door for door in doors if rng.random() < 0.6]
    gains = [-np.sort(-rng.integers(0, 6, (rooms, 2)), axis=1).astype(float) for _ in range(3)]
    steps = int(rng.integers(1, 4 if robots == 1 else 3))
    return RoomExploration(ExplorationMap(doors, *gains, [0] * robots, 0, heard, int(rng.integers(0, 3)), steps))


def enumerated(problem: RoomExploration) -> float:
    """The most gain of all plans, contact and gains counted anew."""
    given = problem.instance
    doors = {tuple(sorted(pair)) for pair in given.doors.tolist()}
    links = {tuple(sorted(pair)) for pair in given.heard.tolist()}

    def plans(room: int, left: int) -> Iterator[tuple[tuple[int, int], ...]]:
        if not left:
            yield ()
            return
        others = [v for v in range(given.num_rooms) if tuple(sorted((room, v))) in doors]
        for to, action in [(room, 0), (room, 1), (room, 2), *((v, 0) for v in others)]:
            for rest in plans(to, left - 1):
                yield ((to, action), *rest)

    best = -1.0
    tables = [given.exploring, given.mapping, given.searching]
    for team in itertools.product(*(list(plans(int(start), given.steps)) for start in given.starts)):
        silent = [0] * len(team)
        fine = True
        for step in range(given.steps):
            at = [own[step][0] for own in team]
            joined = {given.base}
            for _ in at:
                joined |= {room for room in at if any(room == j or tuple(sorted((room, j))) in links for j in joined)}
            silent = [0 if room in joined else count + 1 for room, count in zip(at, silent, strict=True)]
            fine = fine and max(silent) <= given.silence
        if not fine or max(silent) > 0:
            continue
        total, done = 0.0, {}
        for start, own in zip(given.starts.tolist(), team, strict=True):
            here = start
            for to, action in own:
                if action or to != here:
                    count = done.get((action, to), 0)
                    total += float(tables[action][to, count]) if count < tables[action].shape[1] else 0.0
                    done[action, to] = count + 1
                here = to
        best = max(best, total)
    return best
