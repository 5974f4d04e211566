"""Exploration under unreliable communication: robots explore an unknown floor, and their maps count where they come to the base."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....formulations.problem import Problem
from ....formulations.routing.problem import RoutingProblem
from ....heuristics.routing._relay_roles import DONE, EXPLORE, KINDS, MEET, RETURN, RULES, SEARCH, WAIT, RelayRoles, next_step
from ....instances.routing.instance import Sites, VehicleType
from ....instances.routing.travel import EXPLICIT, Travel
from ....instances.routing.worlds.unreliable_communication import CommunicationObservation, CommunicationWorld
from ....instances.worlds import WORLDS, Setting, World, make_world, setting_values
from ..mission import MISSIONS, Actions, Decision, Mission, Scene

NOTES = {EXPLORE: "", MEET: "m", WAIT: "w", RETURN: "r", SEARCH: "s", DONE: "d"}
"""Letters beside robots in pictures."""


@dataclass(frozen=True, eq=False)
class Team:
    """Robots in contact, and their part of the observation."""

    whole: CommunicationObservation
    robots: tuple[int, ...]


class UnreliableCommunication(Mission):
    """Bring as much of the map as possible to the base, with batteries that do not last for all, and radios that do not reach far.

    Source: Skeele (2016), chapter 4; readings and errata: docs/missions/unreliable-communication.md.
    """

    name: ClassVar[str] = "unreliable-communication"
    summary: ClassVar[str] = "robots explore an unknown floor, and hand their maps over on the way to the base"
    headline: ClassVar[str] = "returned"
    lasting: ClassVar[int] = 10_000
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["unreliable-communication"].settings,
        "rule": Setting("sacrifice", "when robots return: by the text, by the printed algorithm, or home without roles", choices=RULES),
        "roles": Setting("overwritten", "whether new roles replace old ones, or a relay keeps its own relay", choices=KINDS),
        "paired": Setting(True, "whether robots take roles at the start, where all are in contact", bool),
        "period": Setting(60, "steps of exploration until a robot goes to the place of its last meeting", int, 1, 1_000_000),
        "margin": Setting(1, "steps of energy to spare at which robots return", int, 0, 1_000_000),
        "patience": Setting(100, "steps for which a relay waits on the ground; 0: for ever, as in the source", int, 0, 1_000_000),
        "near": Setting(False, "whether a robot counts on its relay's radio for the last steps", bool),
        "close": Setting(None, "cells within which two frontiers are one; none: as far as robots see", float, 0.0, 10_000.0),
        "weight": Setting(0.1, "frontier cells that a step costs, where a solver or heuristic decides", float, 0.0, 1e6),
        "sites": Setting(10, "frontiers that are shared out at once, the largest", int, 1, 1000),
    }

    def world(self, seed: int, **settings: Any) -> CommunicationWorld:
        values = setting_values(self.name, self.settings, settings)
        world = make_world(self.name, seed, **{key: values[key] for key in WORLDS[self.name].settings})
        assert isinstance(world, CommunicationWorld)
        return self.begin(world, **{key: values[key] for key in values if key not in WORLDS[self.name].settings})

    def begin(self, world: CommunicationWorld, **settings: Any) -> CommunicationWorld:
        """Play in a world that was made elsewhere, with settings that are not the world's."""
        self.values = setting_values(self.name, self.settings, settings)
        self.played, v = world, self.values
        count = len(world.robots)
        self.close = v["close"] if v["close"] is not None else float(world.sight)
        credit, patience = int(world.reach) if v["near"] else 0, v["patience"] or math.inf
        self.roles = RelayRoles(count, world.base, v["rule"], v["roles"], v["period"], v["margin"], patience, credit)
        if v["paired"] and count > 1:
            self.roles.meet(range(count), world.base)
        self.goals: dict[int, int] = {}
        return world

    def teams(self, observation: CommunicationObservation) -> Sequence[Team]:
        """Robots in contact decide together, each by its own map, which is that of all of them."""
        self._advance(observation)
        return [Team(observation, group) for group in observation.groups]

    def problem(self, observation: Team) -> Problem | None:
        """Routes of exploring robots through frontiers; None while each still has one that is not seen."""
        o = observation.whole
        busy = [k for k in observation.robots if self.roles.members[k].mode == EXPLORE]
        if not busy or all(k in self.goals and not o.seen[k, self.goals[k]] for k in busy):
            return None
        for k in busy:
            self.goals.pop(k, None)
        sites, rewards = self._frontiers(o, busy)
        routes = [(o.robots[k], self.roles.goal_of_return(k), o.battery[k] - self.values["margin"]) for k in busy]
        return sharing(o.open[busy[0]], o.width, sites, rewards, routes, self.values["weight"], f"frontiers at step {o.time}")

    def actions(self, observation: Team, problem: Problem | None, answer: Any) -> Actions:
        o = observation.whole
        if answer is not None:
            busy = [k for k in observation.robots if self.roles.members[k].mode == EXPLORE]
            assert isinstance(problem, RoutingProblem)
            for route in answer:
                if route.visits:
                    self.goals[busy[route.vehicle]] = int(problem.sites.ids[route.visits[0]])
        return self._fly(o, observation.robots)

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``nearest-frontier``: each to the nearest one, but of two close ones the robot of the lower number has the first choice."""
        return {"nearest-frontier": self._by_rule}

    def _by_rule(self, o: CommunicationObservation) -> Actions:
        self._advance(o)
        self.goals.clear()
        return {k: cell for group in o.groups for k, cell in self._fly(o, group).items()}

    def _advance(self, o: CommunicationObservation) -> None:
        from .grid_kernels import FAR, steps_from

        count = range(len(o.robots))
        self._steps = [steps_from(o.open[k], o.robots[k], o.width) for k in count]
        self._edges = [np.flatnonzero(o.open[k] & ~o.seen[k] & (self._steps[k] < FAR)) for k in count]
        self.roles.advance(o, self._steps, [len(edge) > 0 for edge in self._edges])
        self.played.patience = self.values["patience"] if any(own.mode == WAIT for own in self.roles.members) else 0

    def _fly(self, o: CommunicationObservation, group: Sequence[int]) -> dict[int, int]:
        """Next cells of robots in contact; exploring ones without a goal take the nearest frontier that is left."""
        from .grid_kernels import steps_from

        actions, taken = {}, [cell for k, cell in self.goals.items() if k in group]
        for robot in group:
            own = self.roles.members[robot]
            if own.mode in (WAIT, DONE) or not o.battery[robot]:
                continue
            if own.mode in (EXPLORE, SEARCH):
                goal = self.goals.get(robot)
                if goal is None or o.seen[robot, goal]:
                    goal = self._nearest(robot, o.width, taken)
                    taken.append(goal)
            else:
                goal = own.met if own.mode == MEET else self.roles.goal_of_return(robot)
            if goal != o.robots[robot]:
                actions[robot] = next_step(steps_from(o.open[robot], goal, o.width), o.robots[robot], o.width)
        return actions

    def _nearest(self, robot: int, width: int, taken: Sequence[int]) -> int:
        """The nearest frontier that is not close to one of ``taken``; where there is none, the nearest."""
        edge = self._edges[robot]
        steps = self._steps[robot][edge]
        rows, columns = np.divmod(edge, width)
        free = np.ones(len(edge), dtype=bool)
        for cell in taken:
            free &= np.hypot(rows - cell // width, columns - cell % width) > self.close
        kept = free if free.any() else ~free
        return int(edge[kept][np.argmin(steps[kept])])

    def _frontiers(self, o: CommunicationObservation, busy: Sequence[int]) -> tuple[list[int], list[float]]:
        """The largest frontiers, each a cell of it that is nearest to any of these robots, and their numbers of cells."""
        from scipy.ndimage import label

        edge = self._edges[busy[0]]
        flat = np.zeros(o.open.shape[1], dtype=bool)
        flat[edge] = True
        parts = label(flat.reshape(-1, o.width), np.ones((3, 3)))[0].ravel()[edge]
        nearest = np.min([self._steps[k][edge] for k in busy], axis=0)
        groups = [np.flatnonzero(parts == part) for part in range(1, int(parts.max(initial=0)) + 1)]
        groups = sorted(groups, key=lambda group: (-len(group), int(edge[group[0]])))[: self.values["sites"]]
        return [int(edge[group[np.argmin(nearest[group])]]) for group in groups], [float(len(group)) for group in groups]

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``shared_out``: frontiers in the problems of the step."""
        return {"shared_out": float(sum(len(d.problem.customers) for d in decisions if isinstance(d.problem, RoutingProblem)))}

    def scene(self, world: World) -> Scene:
        """Cells that any robot has seen, of large floors some, those that the base knows marked; letters tell what robots do: ``NOTES``."""
        assert isinstance(world, CommunicationWorld)
        every = 1 + world.width // 50
        seen = np.flatnonzero(world.observe().seen.any(axis=0))
        seen = seen[(seen % world.width % every == 1 % every) & (seen // world.width % every == 1 % every)]
        return Scene(
            (0.0, 1.0 - world.shape[0], float(world.width - 1), 0.0), _places(world.robots, world.width), world.sight,
            _places(seen, world.width), world.returned[seen], ("robots", "known at the base", "seen"),
            notes=[NOTES[own.mode] for own in self.roles.members],
        )  # fmt: skip


def sharing(
    open_: NDArray[np.bool_], width: int, sites: Sequence[int], rewards: Sequence[float], routes: Sequence[tuple[int, int, int]],
    weight: float, name: str,
) -> RoutingProblem:  # fmt: skip
    """Team orienteering on a map: ``routes`` have a first cell, a last one and a length, in steps, that they may have at most.

    Ids of the sites are their cells, and a step costs ``weight`` rewards.
    """
    from .grid_kernels import steps_from

    ends = [cell for start, end, _ in routes for cell in (start, end)]
    cells = [*ends, *sites]
    steps = np.array([steps_from(open_, cell, width)[cells] for cell in cells], dtype=np.float64)
    depot = np.arange(len(cells)) < len(ends)
    ids = [f"{name} {k}" for k, name in enumerate(map(str, ends))] + [str(cell) for cell in sites]
    places = Sites.of(
        ids, depot=depot, reward=np.where(depot, 0.0, [0.0] * len(ends) + list(rewards)), required=np.zeros(len(cells), dtype=bool),
        coordinates=_places(cells, width),
    )  # fmt: skip
    fleet = [
        VehicleType(count=1, start=2 * k, end=2 * k + 1, max_distance=max(length, 0), name=f"route {k + 1}")
        for k, (_, _, length) in enumerate(routes)
    ]
    aim = f"reward - {weight}*total-cost" if weight else "reward"
    return RoutingProblem(places, Travel(EXPLICIT, matrix=steps), fleet, aim, name=name, problem="team-orienteering")


def hindsight(world: CommunicationWorld, battery: int) -> RoutingProblem:
    """A relaxation of the best plan of two robots that know the floor, see the cell where they are, and lose no link.

    One flies a closed route from the base. The other ends where the first could hear it: within reach of a cell from which the base is not
    farther than half a battery, though the first need not fly there.
    """
    from .grid_kernels import steps_from

    home = steps_from(world.free, world.base, world.width)
    cells = [world.base, *(int(cell) for cell in np.flatnonzero(world.free & (home <= battery)) if cell != world.base)]
    steps = np.array([steps_from(world.free, cell, world.width)[cells] for cell in cells], dtype=np.float64)
    relays = [cell for cell in cells if 2 * home[cell] <= battery]
    ends = [k for k, cell in enumerate(cells) if any(world.linked(cell, relay) for relay in relays)]
    matrix = np.zeros((len(cells) + 1, len(cells) + 1))
    matrix[1:, 1:] = steps
    matrix[0, 1:] = matrix[1:, 0] = steps[:, ends].min(axis=1)
    depot = np.arange(len(matrix)) < 2
    sites = Sites.of(
        ["heard", "base", *map(str, cells[1:])], depot=depot, reward=np.where(depot, 0.0, 1.0), required=np.zeros(len(depot), dtype=bool)
    )
    fleet = [VehicleType(count=1, start=1, end=end, max_distance=battery, name=name) for end, name in ((1, "relay"), (0, "sacrifice"))]
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), fleet, "reward", name="hindsight", problem="team-orienteering")


def _places(cells: Any, width: int) -> NDArray[np.float64]:
    rows, columns = np.divmod(np.asarray(cells, dtype=np.int64), width)
    return np.column_stack([columns, -rows]).astype(np.float64)


MISSIONS.add("unreliable-communication", UnreliableCommunication)
