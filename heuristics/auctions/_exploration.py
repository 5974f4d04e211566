"""One step of an exploration by a team in which some robots relay what others read, and the limits of contact."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ...formulations.auctions.room_exploration import GO, MAP, SEARCH
from ...instances.errors import InputError
from ...instances.number_arrays import Flags, Integers

Deed = tuple[int, int]
"""Room, and action there."""

Teams = Mapping[int, tuple[int, ...]]
"""Relays of each explorer that has any."""

Worth = Callable[[int, int, int], float]
"""Worth of an action in a room, given how many others chose it in this step: room, action, others."""

Offer = tuple[float, int, tuple[tuple[int, int], ...]]
"""An offer of relays: the gain that they give up, their number, and (robot, site) of each."""


def explorers_and_relays(
    adjacent: Flags,
    linked: Flags,
    base: int,
    here: Sequence[int],
    silent: Sequence[int],
    longest: int,
    worth: Worth,
    teams: Teams | None = None,
    *,
    relays: bool = True,
) -> tuple[dict[int, Deed], dict[int, tuple[int, ...]]]:
    """Each robot's next action and each explorer's relays; explorers choose in the order of their numbers what is worth most to the team.

    ``adjacent`` and ``linked``, shape (rooms, rooms), say where one step leads and which rooms hear each other; ``here`` and ``silent`` are
    each robot's room and steps in a row without contact, at most ``longest``. ``teams`` are the relays returned by the step before. Without
    ``relays`` each robot keeps to what it can do alone.

    A robot by itself may do what leaves it time to come to a room that hears the base. Where it may not, others offer to stand where they
    join it to the base, at the price of what they give up; the offer is taken if the explorer gains more. Relays stay with their explorer,
    as they could all stay in place, until each can do without. Source: Zhang (2015), algorithm 4, of which ten lines are printed, with
    decisions that fail left out and offers compared by the gain of all; docs/missions.md#room-exploration.
    """
    step = _Step(adjacent, linked, linked[base], here, silent, longest, worth, {} if teams is None else teams)
    kept: dict[int, tuple[int, ...]] = {}
    while len(step.deeds) < len(here):
        explorer = next(u for u in range(len(here)) if u not in step.deeds and u not in step.bound)
        deed, taken = step.best(explorer, relays)
        for u in step.teams.get(explorer, ()):
            del step.bound[u]
        step.take(explorer, deed)
        for u, site in taken:
            step.bound[u] = explorer
            step.take(u, (site, GO))
        if taken:
            kept[explorer] = tuple(u for u, _ in taken)
    return step.deeds, kept


class _Step:
    """The choices of robots in one step: ``deeds`` are the actions chosen so far, ``bound`` the explorer that each relay belongs to."""

    def __init__(
        self, adjacent: Flags, linked: Flags, near: Flags, here: Sequence[int], silent: Sequence[int],
        longest: int, worth: Worth, teams: Teams,
    ) -> None:  # fmt: skip
        self.linked, self.near, self.here, self.silent, self.longest = linked, near, here, silent, longest
        self.worth, self.teams = worth, teams
        self.back, self.hops = steps_to_contact(adjacent, near), steps_to_contact(linked, near)
        self.sites = [[room, *np.nonzero(adjacent[room])[0].tolist()] for room in here]
        self.bound = {u: explorer for explorer, own in teams.items() for u in own}
        self.chosen: dict[Deed, int] = {}
        self.deeds: dict[int, Deed] = {}

    def take(self, robot: int, deed: Deed) -> None:
        self.deeds[robot] = deed
        self.chosen[deed] = self.chosen.get(deed, 0) + 1

    def gain(self, robot: int, deed: Deed) -> float:
        return 0.0 if deed == (self.here[robot], GO) else self.worth(*deed, self.chosen.get(deed, 0))

    def options(self, robot: int) -> list[Deed]:
        at = self.here[robot]
        return [(at, MAP), (at, SEARCH), *((room, GO) for room in self.sites[robot])]

    def alone(self, robot: int, room: int) -> bool:
        """Whether the robot may be in the room without relays."""
        return allowed(0 if self.near[room] else self.silent[robot] + 1, int(self.back[room]), self.longest)

    def best_alone(self, robot: int) -> float | None:
        return max((self.gain(robot, deed) for deed in self.options(robot) if self.alone(robot, deed[0])), default=None)

    def released(self, own: tuple[int, ...], taken: tuple[tuple[int, int], ...]) -> bool:
        """Whether all relays that are not taken again can do without the explorer."""
        return all(self.best_alone(u) is not None for u in own if u not in dict(taken))

    def chain(self, room: int, given_up: Mapping[int, float], used: tuple[int, ...] = ()) -> Offer | None:
        """The cheapest relays that join a room to the base."""
        best: Offer | None = None
        free = [u for u in given_up if u not in used]
        for u in free:
            for site in self.sites[u]:
                if not self.linked[room, site] or not 0 <= self.hops[site] < len(free):
                    continue
                rest = (0.0, 0, ()) if self.near[site] else self.chain(site, given_up, (*used, u))
                if rest is not None:
                    offer = given_up[u] + rest[0], 1 + rest[1], ((u, site), *rest[2])
                    best = offer if best is None else min(best, offer)
        return best

    def best(self, explorer: int, relays: bool) -> tuple[Deed, tuple[tuple[int, int], ...]]:
        """The explorer's best action, and (robot, site) of the relays it takes."""
        own = self.teams.get(explorer, ())
        given_up = dict.fromkeys(own, 0.0)
        for u in range(len(self.here)) if relays else ():
            if u != explorer and u not in self.deeds and u not in self.bound and not self.teams.get(u):
                given_up[u] = self.best_alone(u) or 0.0
        best: tuple[tuple[float, bool, int], Deed, tuple[tuple[int, int], ...]] | None = None
        for number, deed in enumerate(self.options(explorer)):
            by_itself = self.alone(explorer, deed[0]) and self.released(own, ())
            offer = (0.0, 0, ()) if by_itself else self.chain(deed[0], given_up)
            if offer is None or not self.released(own, offer[2]):
                continue
            rank = self.gain(explorer, deed) - offer[0], not offer[2], -number
            if best is None or rank > best[0]:
                best = rank, deed, offer[2]
        if best is None:  # as they are, they stay in contact
            return (self.here[explorer], GO), tuple((u, self.here[u]) for u in own)
        return best[1:]


def steps_to_contact(adjacent: ArrayLike, contact: ArrayLike) -> Integers:
    """Fewest moves from each room to one with contact, shape (rooms,); -1 where there is no way.

    ``adjacent[a, b]`` says that one move leads from a to b, ``contact`` where a robot is heard.
    """
    moves, near = np.asarray(adjacent, dtype=bool), np.asarray(contact, dtype=bool)
    if moves.ndim != 2 or moves.shape != (len(near),) * 2:
        raise InputError(
            "there must be one row and column of moves a room, and one flag of contact", "wrong-shape", found=f"{moves.shape}, {near.shape}"
        )
    steps = np.where(near, 0, -1)
    reached, count = near, 0
    while True:
        more = moves[:, reached].any(axis=1) & (steps < 0)
        if not more.any():
            return np.asarray(steps, dtype=np.int64)
        count += 1
        steps[more] = count
        reached = more


def allowed(silent: int, to_contact: int, longest: int) -> bool:
    """Whether contact can be regained in time by a robot ``to_contact`` moves from contact; the last move ends in contact.

    ``silent`` counts the steps without contact so far, that of the action in question included; at most ``longest`` in a row are allowed.
    Source: Zhang (2015), section 5.3.6; docs/formulations/task-allocation.md#exploration.
    """
    if longest < 0:
        raise InputError("the steps out of contact must be at least 0", "out-of-range", found=str(longest))
    return to_contact >= 0 and silent + to_contact - 1 <= longest if to_contact else True
