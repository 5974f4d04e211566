"""Roles of robots that explore with small batteries: who carries a map home, and who gives itself up for it."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...instances.routing.worlds.unreliable_communication import CommunicationObservation

EXPLORE, MEET, WAIT, RETURN, SEARCH, DONE = "explore", "meet", "wait", "return", "search", "done"

RULES, KINDS = ("sacrifice", "printed", "home"), ("overwritten", "chain")


@dataclass
class Member:
    """A robot: whom it hands its map to (None: the base), from whom it waits for one, and what it does.

    ``met`` and ``relay_at`` are the cells of its last meeting and of the last sight of its relay, ``since`` the steps of exploration since
    that meeting, ``waited`` its steps on the ground.
    """

    met: int
    relay_at: int
    relay: int | None = None
    feeder: int | None = None
    mode: str = EXPLORE
    fed: bool = False
    since: int = 0
    waited: int = 0


class RelayRoles:
    """The automaton of each robot of a team, with thresholds of the text (``sacrifice``), the printed ones, or without roles (``home``).

    Of two that meet, the one of the lower number becomes the relay, which lands where its battery just lets it return to the base, and the
    other its sacrifice, which explores until it just comes back to the relay, hands its map over and ends there. New roles replace old ones
    (``overwritten``), or a relay keeps its own relay, to which it then returns (``chain``).

    In steps: after ``period`` of exploration a robot goes to the place of its last meeting, it turns back with ``margin`` of energy to
    spare, a relay waits ``patience`` on the ground, and the way back to it may be shorter by ``credit`` than to where it was seen: the
    reach of radios.

    Source: Skeele (2016), section 4.3 and algorithm 4, repaired: docs/missions/unreliable-communication.md#errata.
    """

    def __init__(
        self, robots: int, base: int, rule: str = "sacrifice", kind: str = "overwritten", period: int = 60, margin: int = 1,
        patience: float = math.inf, credit: int = 0,
    ) -> None:  # fmt: skip
        self.members = [Member(base, base) for _ in range(robots)]
        self.base, self.rule, self.kind = base, rule, kind
        self.period, self.margin, self.patience, self.credit = period, margin, patience, credit

    def meet(self, robots: Sequence[int], cell: int) -> None:
        """Robots meet: pairs of them, in the order of their numbers, become relay and sacrifice; in a ``chain`` each and the next do."""
        if self.rule == "home":
            return
        order = sorted(robots)
        for k in order:
            self.members[k].met, self.members[k].since, self.members[k].mode = cell, 0, EXPLORE
        for low, high in itertools.pairwise(order) if self.kind == "chain" else zip(order[::2], order[1::2], strict=False):
            first, second = self.members[low], self.members[high]
            first.feeder, first.fed, second.relay, second.relay_at = high, False, low, cell
            if self.kind == "overwritten":
                first.relay = second.feeder = None

    def goal_of_return(self, robot: int) -> int:
        """The cell where it will hand its map over."""
        own = self.members[robot]
        return self.base if own.relay is None else own.relay_at

    def spare(self, robot: int, battery: int, steps: Any) -> int:
        """Energy beyond what it needs to return, by ``steps`` from where it is to each cell."""
        own = self.members[robot]
        if own.relay is None or self.rule == "printed":
            return int(battery - steps[self.base])
        return int(battery - max(steps[own.relay_at] - self.credit, 0))

    def advance(self, o: CommunicationObservation, steps: Sequence[Any], frontier: Sequence[bool]) -> None:
        """Let all robots look at who is near, and change what they do.

        ``steps`` are, one a robot, those from its cell to all others on its map; ``frontier`` tells whether it knows a cell to explore.
        """
        self._hand_over(o)
        for group in o.groups:
            active = [k for k in group if self.members[k].mode in (EXPLORE, MEET)]
            if len(active) > 1 and any(self.members[k].mode == MEET for k in active):
                self.meet(active, o.robots[active[0]])
        for robot, own in enumerate(self.members):
            own.mode = self._next(robot, own, o, self.spare(robot, o.battery[robot], steps[robot]), frontier[robot])
        self._hand_over(o)

    def _hand_over(self, o: CommunicationObservation) -> None:
        """Relays are seen by their sacrifices; those that return hand their maps over, and a relay that has one may hand it on at once."""
        for robot, own in sorted(enumerate(self.members), reverse=True):
            if own.relay is not None and any(robot in group and own.relay in group for group in o.groups):
                own.relay_at, relay = o.robots[own.relay], self.members[own.relay]
                if own.mode in (RETURN, SEARCH):
                    own.mode = DONE
                    relay.fed |= relay.feeder == robot
                    if relay.fed and relay.mode == WAIT:
                        relay.mode = RETURN

    def _next(self, robot: int, own: Member, o: CommunicationObservation, spare: int, frontier: bool) -> str:
        cell = o.robots[robot]
        if own.mode == DONE or (not o.battery[robot] and own.mode != WAIT):
            return DONE
        if own.mode in (EXPLORE, MEET) and (spare <= self.margin or not frontier):
            own.mode = WAIT if own.feeder is not None and not own.fed else RETURN
        elif own.mode == EXPLORE:
            own.since += 1
            return MEET if self.rule != "home" and own.since > self.period else EXPLORE
        elif own.mode == MEET and cell == own.met:
            own.since = 0
            return EXPLORE
        if own.mode == WAIT:
            own.waited += 1
            if not own.fed and own.waited <= self.patience:
                return WAIT
            own.mode = RETURN
        if own.mode == RETURN and cell == self.goal_of_return(robot):
            own.mode = DONE if own.relay is None else SEARCH
        if own.mode == SEARCH and not frontier:  # nothing is left to explore, so that it tries to come home itself
            own.relay, own.mode = None, RETURN
        return own.mode


def next_step(steps: Any, cell: int, width: int) -> int:
    """The neighbour of ``cell`` from which it is nearest to where ``steps`` are counted from; the first such one."""
    near = [cell + 1, cell - 1, cell + width, cell - width]
    return near[int(np.argmin([steps[k] for k in near]))]
