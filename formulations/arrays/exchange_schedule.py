"""Schedules of exchanges: robots with small batteries take turns at places that are never to be left alone, and what is wrong with one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from ...instances.errors import InputError
from ...instances.number_arrays import Integers


class Sortie(NamedTuple):
    """A robot's watch at a place in steps ``[arrive, leave)``; it takes off before and lands after by the way between pad and place."""

    robot: int
    place: int
    arrive: int
    leave: int


class Aloft(NamedTuple):
    """A robot that is in the air at step 0: its place, and when it took off and arrives there; not after step 0 if it is there."""

    place: int
    takeoff: int
    arrive: int


@dataclass(frozen=True, eq=False)
class ExchangeCase:
    """Places to be watched, and the robots that there are. All times are whole steps from now.

    A robot flies from its pad to a place, and back, in ``travel`` (robots, places) steps each way, at most ``flight`` steps from takeoff to
    landing, and stays on its pad ``charge`` steps before the next takeoff. ``ready`` (robots,) says when a robot on its pad may take off,
    and nothing of robots that are aloft. A place is watched in ``[begin, end)``, each of shape (places,).

    Raises InputError if arrays do not fit each other, or times are out of range.
    """

    travel: Integers
    flight: int
    charge: int
    ready: Integers
    begin: Integers
    end: Integers
    aloft: Mapping[int, Aloft] = field(default_factory=dict)

    def __post_init__(self) -> None:
        robots, places = self.travel.shape
        if self.ready.shape != (robots,) or self.begin.shape != (places,) or self.end.shape != (places,):
            raise InputError("ready, begin and end need an entry for each robot or place", "wrong-shape")
        if not robots:
            raise InputError("there is no robot to watch a place", "missing")
        wrong = [
            (self.flight < 1, f"the flight time must be a step at least, not {self.flight}"),
            (self.charge < 0, f"the charging time must not be negative, but is {self.charge} steps"),
            (bool((self.travel < 1).any()), "a way to a place must take a step at least"),
            (bool((self.ready < 0).any()), "a robot is ready before step 0"),
            (bool((self.begin < 0).any() or (self.end < self.begin).any()), "a watch begins before step 0, or ends before it begins"),
            (bool(places) and 2 * int(self.travel.min()) >= self.flight, "no robot reaches any place and returns with one charge"),
        ]
        for is_wrong, message in wrong:
            if is_wrong:
                raise InputError(message, "out-of-range")
        for robot, (place, takeoff, _) in self.aloft.items():
            if not (0 <= robot < robots and 0 <= place < places and takeoff < 0):
                raise InputError(f"robot {robot} aloft is none, has no place or took off after now", "contradiction")


def uncovered(case: ExchangeCase, schedule: Sequence[Sortie]) -> int:
    """Steps of all places at which nobody is there."""
    left = [set(range(int(begin), int(end))) for begin, end in zip(case.begin, case.end, strict=True)]
    for sortie in schedule:
        left[sortie.place].difference_update(range(sortie.arrive, sortie.leave))
    return sum(map(len, left))


def faults(case: ExchangeCase, schedule: Sequence[Sortie]) -> list[str]:
    """All ways in which robots cannot fly so: one line each; none for a schedule that can be flown, whether or not it covers all.

    Knows nothing of how schedules are made: each robot's day is gone through step by step. Source of the rules: Mitchell (2020), appendix
    A.1; docs/missions/fleet-energy.md#schedules.
    """
    messages = []
    for robot in sorted({sortie.robot for sortie in schedule} | set(case.aloft)):
        if not 0 <= robot < len(case.ready):
            messages.append(f"there is no robot {robot}")
            continue
        own = sorted((s for s in schedule if s.robot == robot), key=lambda s: s.arrive)
        free = int(case.ready[robot])
        for k, sortie in enumerate(own):
            if not 0 <= sortie.place < len(case.begin):
                messages.append(f"robot {robot} flies to place {sortie.place}, which does not exist")
                break
            way = int(case.travel[robot, sortie.place])
            takeoff, landing = sortie.arrive - way, sortie.leave + way
            if k == 0 and robot in case.aloft:
                place, takeoff, arrive = case.aloft[robot]
                if (sortie.place, sortie.arrive) != (place, max(arrive, 0)):
                    messages.append(f"robot {robot} is aloft to place {place} from step {max(arrive, 0)}, not as scheduled")
            elif takeoff < free:
                messages.append(f"robot {robot} takes off at step {takeoff}, but is charged at step {free}")
            if sortie.leave < sortie.arrive:
                messages.append(f"robot {robot} leaves place {sortie.place} before it arrives")
            if landing - takeoff > case.flight:
                messages.append(f"robot {robot} flies {landing - takeoff} steps, but its battery lasts {case.flight}")
            free = landing + case.charge
        if robot in case.aloft and not own:
            messages.append(f"robot {robot} is aloft, and the schedule does not say until when")
    return messages
