"""Maps of rooms for tests: paths, random ones, and their optima by enumeration."""

import numpy as np
from truth.auctions import RoomTruth

from waybound import ExplorationMap, RoomExploration


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
    """The most gain of all plans that keep contact."""
    return float(RoomTruth(problem).best[0])
