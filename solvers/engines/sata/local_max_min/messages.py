"""The local algorithm by messages: robots in step, and a network between those that share a target.

Two robots are neighbours when some target is seen by an action of each. A round is one message to every neighbour, and then the
reading of theirs. The number of rounds is 5h - 4, whatever the robots, weights and eps are: 1 to get to know each other, and h - 1
each for the ceilings of the trees, for the levels that others want tested, for their test (all at once: the factor log(1/eps) in
rounds is traded for messages of O(1/eps) numbers), for the smoothing, and for the solution.

It earns its place beside the arrays by what only it can show: that the algorithm is local, with its rounds and messages counted, and,
being written from the robots' side without those arrays, that they compute what the robots would (the tests compare share by share).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .....formulations.stop import NEVER, Stop
from .....instances.sata.sensing_graph import SensingGraph
from .cleaning import Floats
from .robot import CommonLevels, Inbox, Orders, Outbox, Robot, SteppedLevels
from .search import MARGIN
from .shares import check_options

BYTES_A_NUMBER = 8


@dataclass(frozen=True, eq=False)
class MessageRun:
    """Shares and levels that the robots settled on, and the rounds and messages that it took.

    A message counts once for each receiver, with 8 bytes a number and nothing for structure. ``relative_eps`` is that of ``LocalShares``,
    as far as the levels tell it by themselves.
    """

    shares: Floats
    levels: Floats
    relative_eps: float
    rounds: int
    messages: int
    bytes: int
    most_bytes: int


class Network:
    """Carries messages between robots that share a target, and counts them.

    ``watchers`` names the robots that see each target. Raises ValueError where a robot speaks to one with which it shares no target, a
    fault of its programme, and Stopped.
    """

    def __init__(self, watchers: Mapping[int, Sequence[int]], stop: Stop = NEVER) -> None:
        self._watchers, self._stop = watchers, stop
        self._linked: dict[int, set[int]] = {}
        for robots in watchers.values():
            stop.check()
            for i in robots:
                self._linked.setdefault(i, set()).update(robots)
        self.rounds = self.messages = self.bytes = self.most_bytes = 0

    def by_target(self, outboxes: Mapping[int, Outbox]) -> dict[int, dict[int, dict[int, Any]]]:
        """The first round: the message of a robot on a target reaches all others that see it."""
        self.rounds += 1
        inboxes: dict[int, dict[int, dict[int, Any]]] = {i: {k: {} for k in outbox} for i, outbox in outboxes.items()}
        for i, outbox in outboxes.items():
            self._stop.check()
            for k, message in outbox.items():
                for j in self._watchers[k]:
                    if j != i:
                        self._count(message)
                        inboxes[j][k][i] = message
        return inboxes

    def by_robot(self, outboxes: Mapping[int, Outbox]) -> dict[int, dict[int, Any]]:
        """Any later round."""
        self.rounds += 1
        inboxes: dict[int, dict[int, Any]] = {i: {} for i in outboxes}
        for i, outbox in outboxes.items():
            self._stop.check()
            for j, message in outbox.items():
                if j not in self._linked[i]:
                    raise ValueError(f"robot {i} shares no target with robot {j}, so it cannot speak to it")
                self._count(message)
                inboxes[j][i] = message
        return inboxes

    def _count(self, message: Any) -> None:
        size = BYTES_A_NUMBER * _numbers(message)
        self.messages += 1
        self.bytes += size
        self.most_bytes = max(self.most_bytes, size)


def exchange(
    graph: SensingGraph,
    h: int,
    *,
    eps: float = 0.1,
    search: str = "secant",
    step: float = 0.1,
    smoothing: str = "layers",
    normalise: bool = True,
    stop: Stop = NEVER,
) -> MessageRun:
    """Run the local algorithm by messages, with the parameters, errors and shares of ``local_shares``.

    Robots of which no action sees a target take no part.

    Source: Sung (2019), section 3.4.1, Algorithm 2 and Theorem 1; docs/local_algorithm.md#rounds.
    """
    check_options(h, eps, search, step, smoothing)
    orders = Orders(h, CommonLevels(eps) if search == "secant" else SteppedLevels(step), smoothing, normalise)
    robots: list[Robot] = []
    owned: dict[int, list[int]] = {}
    watchers: dict[int, list[int]] = {}
    starts, actions = graph.by_robot
    for i in range(graph.num_robots):
        stop.check()
        live = [v for v in actions[starts[i] : starts[i + 1]].tolist() if graph.indptr[v + 1] > graph.indptr[v]]
        if live:
            edges = [slice(graph.indptr[v], graph.indptr[v + 1]) for v in live]
            sees = [dict(zip(graph.indices[e].tolist(), graph.weights[e].tolist(), strict=True)) for e in edges]
            robots.append(Robot(i, sees, orders))
            owned[i] = live
            for k in {k for seen in sees for k in seen}:
                watchers.setdefault(k, []).append(i)
    network = Network(watchers, stop)
    running = {robot.name: robot.programme() for robot in robots}
    outboxes = {i: next(programme) for i, programme in running.items()}
    inboxes: Mapping[int, Inbox] = network.by_target(outboxes) if running else {}
    shares, levels = np.zeros(graph.num_actions), np.full(graph.num_actions, math.nan)
    while running:
        outboxes, ended = {}, []
        for i, programme in running.items():
            stop.check()
            try:
                outboxes[i] = programme.send(inboxes[i])
            except StopIteration as end:
                shares[owned[i]] = end.value
                ended.append(i)
        for i in ended:
            del running[i]
        if running:
            inboxes = network.by_robot(outboxes)
    for robot in robots:
        levels[owned[robot.name]] = robot.levels
    least = float(np.nanmin(levels)) if robots else math.inf
    relative = float(eps) if search == "secant" else min(1.0, step / least)
    relative = (1.0 + relative) / (1.0 - MARGIN) - 1.0
    return MessageRun(shares, levels, relative, network.rounds, network.messages, network.bytes, network.most_bytes)


def _numbers(message: Any) -> int:
    return sum(_numbers(part) for part in message) if isinstance(message, tuple) else 1
