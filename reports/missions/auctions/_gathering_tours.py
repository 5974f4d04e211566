"""Tours of robots that empty sensors: orders by urgency, shares of the load, and the answers of an auction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ....heuristics.auctions.gathering_steps.reward_split import expected_contents, reward_split
from ....heuristics.auctions.gathering_steps.urgency import receding_order, urgencies
from ....instances.auctions.worlds.information_gathering import GatheringObservation, Move

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass
class Tour:
    """Sensors that a robot is still going to visit, in order, and the amount that it takes at each."""

    stops: list[int] = field(default_factory=list)
    shares: dict[int, float] = field(default_factory=dict)


def steps(here: Integers, there: Integers) -> Integers:
    """Moves between each of some cells and each of others."""
    return np.asarray(np.abs(np.atleast_2d(here)[:, None, :] - np.atleast_2d(there)[None, :, :]).max(axis=2))


def rates(o: GatheringObservation) -> Floats:
    """Units a step; a sensor that gathers no more counts with the rate 1, so that it is emptied once more."""
    return np.where(o.rates > 0, o.rates, 1.0)


def times_to_full(o: GatheringObservation) -> Floats:
    """Steps until each store is full, at its rate."""
    return np.asarray((o.rules.store - o.stores) / rates(o))


def worth_visiting(o: GatheringObservation) -> list[int]:
    """Sensors that gather, or have something left in store."""
    return np.nonzero((o.rates > 0) | (o.stores > 1e-6))[0].tolist()


def by_urgency(o: GatheringObservation, robot: int, sensors: Sequence[int], look_ahead: int, urgency: str) -> list[int]:
    """The sensors in the order in which a robot visits them from where it is."""
    ids = np.array(sensors, dtype=np.int64)
    if not len(ids):
        return []
    rate, time = rates(o)[ids], times_to_full(o)[ids]
    first = urgencies(rate, time, steps(o.robots[robot], o.sensors[ids]), urgency)[0]
    then = urgencies(rate, time, steps(o.sensors[ids], o.sensors[ids]), urgency)
    return [int(ids[k]) for k in receding_order(first, then, look_ahead)]


def length(o: GatheringObservation, robot: int, stops: Sequence[int]) -> tuple[Floats, float]:
    """Steps after which a robot is at each stop, and back at its base."""
    cells = np.vstack([o.robots[robot][None], o.sensors[list(stops)].reshape(-1, 2), o.rules.bases[robot][None]])
    ways = np.cumsum(np.abs(np.diff(cells, axis=0)).max(axis=1)).astype(np.float64)
    return ways[:-1], float(ways[-1])


def tour(o: GatheringObservation, robot: int, stops: Sequence[int]) -> Tour:
    """Stops with shares of the robot's room, by what each store will hold when the tour is over: (4.6) and (4.7) of Zhang (2015)."""
    ids = list(stops)
    if not ids:
        return Tour()
    held = expected_contents(o.stores[ids], o.rates[ids], length(o, robot, ids)[1], o.rules.store)
    shares = reward_split(held, max(0.0, o.rules.load - float(o.loads[robot])))
    return Tour(ids, dict(zip(ids, shares.tolist(), strict=True)))


def drive(o: GatheringObservation, robot: int, own: Tour) -> Move:
    """The next move of a robot on its tour; at a stop also the amount that it takes, and the stop is done."""
    room = o.rules.load - o.loads[robot]
    if room <= 1e-9 * o.rules.load:
        own.stops.clear()
    goal = o.sensors[own.stops[0]] if own.stops else o.rules.bases[robot]
    here = o.robots[robot]
    cell = here + np.sign(goal - here)
    amount = 0.0
    if own.stops and (cell == goal).all():
        amount = own.shares[own.stops.pop(0)]
    return Move((int(cell[0]), int(cell[1])), amount)


def estimated_loss(o: GatheringObservation, robot: int, stops: Sequence[int], horizon: float) -> float:
    """Loss of all sensors within ``horizon`` steps if this robot alone visits its stops: each from when it is full until it is reached."""
    reached = np.full(len(o.sensors), horizon)
    ids = list(stops)
    if ids:
        reached[ids] = np.minimum(length(o, robot, ids)[0], horizon)
    return float((o.rates * np.maximum(0.0, reached - times_to_full(o))).sum())


def switched(o: GatheringObservation, robot: int, old: Sequence[int], new: Sequence[int]) -> bool:
    """Whether a robot on its way leaves its old stops for new ones, by which it expects a smaller loss of all sensors."""
    horizon = max(length(o, robot, old)[1], length(o, robot, new)[1])
    return estimated_loss(o, robot, new, horizon) < estimated_loss(o, robot, old, horizon)


def appended(o: GatheringObservation, robots: Sequence[int], sensors: Sequence[int]) -> dict[int, list[int]]:
    """Sensors, in the order given, each at the end of the path of the robot whose path is the shortest with it."""
    stops: dict[int, list[int]] = {robot: [] for robot in robots}
    costs, at = dict.fromkeys(robots, 0), {robot: o.robots[robot] for robot in robots}
    for sensor in sensors if robots else ():
        bids = {robot: costs[robot] + int(steps(at[robot], o.sensors[sensor])[0, 0]) for robot in robots}
        winner = min(bids, key=lambda robot, bids=bids: (bids[robot], robot))  # type: ignore[misc]
        costs[winner], at[winner] = bids[winner], o.sensors[sensor]
        stops[winner].append(sensor)
    return stops
