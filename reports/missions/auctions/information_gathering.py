"""Information gathering: robots empty sensors before they are full, and bring what they take to their bases."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, ClassVar

import numpy as np

from ....formulations.auctions.balanced_partition import EDGES, OBJECTIVES, BalancedPartition
from ....formulations.auctions.task_allocation import TaskAllocation
from ....formulations.problem import Problem
from ....formulations.stop import NEVER
from ....heuristics.auctions._gathering import URGENCIES, expected_contents, receding_order, reward_split, urgencies
from ....heuristics.heuristic import HEURISTICS, Context
from ....instances.auctions.robot_tasks import RobotTasks
from ....instances.auctions.worlds.information_gathering import EXCESS, GatheringObservation, GatheringWorld, Move
from ....instances.number_arrays import Floats, Integers
from ....instances.worlds import WORLDS, Setting, World
from ....solvers.linear_programs import LinearPrograms
from ..mission import MISSIONS, Actions, Mission, Scene

PLANS = {"partition": "distributed-sampling", "auction": "fixed-order-auction"}
"""Ways to share the sensors out, and the heuristic by which the policy of that name does it."""


class InformationGathering(Mission):
    """Lose little: a full sensor gathers nothing until a robot takes something out, and only what reaches a base counts.

    Source: Zhang (2015), chapter 4. Readings of what it leaves open: docs/missions.md#information-gathering.
    """

    name: ClassVar[str] = "information-gathering"
    summary: ClassVar[str] = "robots empty sensors that fill up, and bring what they take to their bases"
    headline: ClassVar[str] = "gain"
    lasting: ClassVar[int] = 1000
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["information-gathering"].settings,
        "plan": Setting("partition", "how sensors are shared out: once, or anew whenever a robot is back", choices=tuple(PLANS)),
        "look-ahead": Setting(3, "stops that the order of a robot's own sensors looks ahead", int, 1, 5),
        "urgency": Setting("shifted", "of a sensor in that order", choices=URGENCIES),
        "objective": Setting(OBJECTIVES[0], "of the partition", choices=OBJECTIVES),
        "edges": Setting(EDGES[0], "distances that a part of the partition costs", choices=EDGES),
    }

    def world(self, seed: int, **settings: Any) -> GatheringWorld:
        world = self.made(GatheringWorld, seed, settings)
        self._parts: tuple[tuple[int, ...], ...] | None = None
        self._tours = [Tour() for _ in range(world.rules.robots)]
        return world

    def problem(self, observation: GatheringObservation) -> Problem | None:
        return self._problem(observation, self.values["plan"])

    def actions(self, observation: GatheringObservation, problem: Problem | None, answer: Any) -> Actions:
        return self._moves(observation, self.values["plan"], problem, answer)

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``partition`` by distributed sampling, ``auction`` in a fixed order, both whatever ``plan`` says."""
        return {plan: partial(self._by_rule, plan) for plan in PLANS}

    def scene(self, world: World) -> Scene:
        """The grid, its first row on top; how full each sensor is, and what each robot carries, where it goes, and what it has brought
        home.

        The limit is what sensors could have gathered at most with room in their stores.
        """
        assert isinstance(world, GatheringWorld)
        rules = world.rules
        top = rules.rows - 1

        def places(cells: Any) -> Any:
            return np.column_stack([cells[:, 1], top - cells[:, 0]]).astype(np.float64)

        full = world.stores >= rules.store * (1 - EXCESS)
        area = (-1.0, -1.0, float(rules.columns), float(rules.rows))
        stops = [[(robot, sensor) for sensor in own.stops] for robot, own in enumerate(self._tours)]
        return Scene(
            area, places(world.robots), 0.5, places(world.places), ~full, ("robots, with what they carry", "sensors", "full sensors"),
            links=[link for tour in stops for link in tour], levels=world.stores / rules.store,
            notes=[f"{load:.0f}" for load in world.loads], shares=world.brought.copy(), limit=world.due,
        )  # fmt: skip

    # ------------------------------------------------------------------------------------------------------------------

    def _back(self, o: GatheringObservation) -> list[int]:
        """Robots at their bases without a stop ahead."""
        at_base = (o.robots == o.rules.bases).all(axis=1)
        return [robot for robot in range(o.rules.robots) if at_base[robot] and not self._tours[robot].stops]

    def _order(self, o: GatheringObservation) -> list[int]:
        """Sensors worth a visit, the soonest full first."""
        time = times_to_full(o)
        return sorted(worth_visiting(o), key=lambda sensor: (time[sensor], sensor))

    def _problem(self, o: GatheringObservation, plan: str) -> Problem | None:
        if plan == "partition":
            if self._parts is not None:
                return None
            time = times_to_full(o)
            weights = rates(o) - time + time.max(initial=0.0)
            data = RobotTasks.of_positions(o.rules.bases, o.sensors, "chebyshev", weights=weights, name="information gathering")
            return BalancedPartition(data, self.values["objective"], self.values["edges"])
        order = self._order(o)
        if not self._back(o) or not order:
            return None
        names = tuple(str(sensor + 1) for sensor in order)
        data = RobotTasks.of_positions(
            o.robots, o.sensors[order], "chebyshev", task_names=names, name=f"information gathering at step {o.time}"
        )
        return TaskAllocation(data)

    def _moves(self, o: GatheringObservation, plan: str, problem: Problem | None, answer: Any) -> Actions:
        if plan == "partition":
            if problem is not None:
                self._parts = ((),) * o.rules.robots if answer is None else answer
            worth = set(worth_visiting(o))
            for robot in self._back(o):
                own = [sensor for sensor in (self._parts or ())[robot] if sensor in worth]
                order = by_urgency(o, robot, own, self.values["look-ahead"], self.values["urgency"])
                self._tours[robot] = tour(o, robot, order)
        elif problem is not None and answer is not None:
            order = self._order(o)
            self._allot(o, [[order[task] for task in path] for path in answer])
        return {robot: drive(o, robot, own) for robot, own in enumerate(self._tours)}

    def _allot(self, o: GatheringObservation, paths: list[list[int]]) -> None:
        """New paths for robots that are back, and for those on their way that lose less by them; what nobody visits goes to robots left
        without."""
        back = self._back(o)
        stops = {robot: paths[robot] for robot in back}
        for robot, own in enumerate(self._tours):
            if robot in back:
                continue
            if not own.stops or not switched(o, robot, own.stops, paths[robot]):
                stops[robot] = own.stops
                continue
            stops[robot] = paths[robot]
            self._tours[robot] = tour(o, robot, paths[robot])
        taken = {sensor for robot, path in stops.items() if robot not in back for sensor in path}
        for robot in back:
            stops[robot] = [sensor for sensor in stops[robot] if sensor not in taken]
        idle = [robot for robot in back if not stops[robot]]
        visited = {sensor for path in stops.values() for sensor in path}
        stops |= appended(o, idle, [sensor for sensor in self._order(o) if sensor not in visited])
        for robot in back:
            self._tours[robot] = tour(o, robot, stops[robot])

    def _by_rule(self, plan: str, o: GatheringObservation) -> Actions:
        problem = self._problem(o, plan)
        answer = None if problem is None else HEURISTICS[PLANS[plan]].run(problem, _context()).answer
        return self._moves(o, plan, problem, answer)


def _context() -> Context:
    return Context(np.random.default_rng(0), math.inf, None, lambda answer: None, NEVER, LinearPrograms())


MISSIONS.add("information-gathering", InformationGathering)


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
