"""Plume exploration: robots fly over a drifting plume of unknown shape until every cell of it was visited, and return."""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from ....formulations.problem import Problem
from ....formulations.routing.problem import RoutingProblem
from ....instances.routing.instance import Sites, VehicleType
from ....instances.routing.travel import EXPLICIT, Travel
from ....instances.routing.worlds.plume_exploration import Cell, PlumeObservation, PlumeWorld, flight_time, neighbours
from ....instances.worlds import WORLDS, Setting, World, make_world, setting_values
from ..mission import MISSIONS, Actions, Decision, Mission, Scene


class DepthFirst:
    """Recursive depth-first exploration by a team: algorithm 4 of Sung (2019), repaired.

    Each cell becomes a child of the one from which it is seen first, children in the order north, east, south, west; ``depth`` counts the
    edges of the longest path from the start. A robot goes to a child that is not explored in full, or else to the parent. Several such
    children are halved again and again, the first against all others, and the robot goes where fewer robots are; ties go to the first.
    Robots that arrive together all look before any goes on, and go in the order of their numbers. Source: Sung (2019), section 4.4.1; what
    was repaired: docs/missions/plume-exploration.md#errata.
    """

    def __init__(self, start: Cell) -> None:
        self.parent: dict[Cell, Cell | None] = {start: None}
        self.children: dict[Cell, list[Cell]] = {}
        self.levels = {start: 0}
        self._explored: set[Cell] = set()
        self._inside: Counter[Cell] = Counter()

    @property
    def depth(self) -> int:
        return max(self.levels.values())

    def go(self, observation: PlumeObservation) -> dict[int, Cell]:
        """The cells to which robots at a cell fly next."""
        waiting = [(robot, cell) for robot, cell in enumerate(observation.robots) if not observation.remaining[robot]]
        for _, cell in waiting:
            if cell not in self.children:
                self._discover(cell, observation.known)
        actions = {}
        for robot, cell in waiting:
            branches = [child for child in self.children[cell] if child not in self._explored]
            while len(branches) > 1:
                rest = sum(self._inside[child] for child in branches[1:])
                branches = branches[:1] if self._inside[branches[0]] <= rest else branches[1:]
            parent = self.parent[cell]
            if branches:
                self._inside[branches[0]] += 1
                actions[robot] = branches[0]
            elif parent is not None:
                self._inside[cell] -= 1
                actions[robot] = parent
        return actions

    def _discover(self, cell: Cell, known: Mapping[Cell, bool]) -> None:
        new = [near for near in neighbours(cell) if near in known and near not in self.parent]
        self.children[cell] = new
        self.parent.update((child, cell) for child in new)
        self.levels.update((child, self.levels[cell] + 1) for child in new)
        at: Cell | None = cell
        while at is not None and at in self.children and self._explored.issuperset(self.children[at]):
            self._explored.add(at)
            at = self.parent[at]


def lawn_mower(
    box: tuple[int, int, int, int], robots: int, speed: float, drift: tuple[float, float]
) -> tuple[list[list[Cell]], float]:  # fmt: skip
    """The cells of a rectangle in strips, one a robot, each swept to and fro; and the longest time of a sweep.

    Strips lie along the columns or the rows, whichever takes less time; flights to the strips and back do not count. Source: Sung (2019),
    section 4.6, whose reference curve this is; it bounds nothing: docs/missions/plume-exploration.md#errata.
    """
    west, south, east, north = box
    plans: list[tuple[float, int, list[list[Cell]]]] = []
    for turned, (width, height) in enumerate([(east - west + 1, north - south + 1), (north - south + 1, east - west + 1)]):
        each, sweeps = math.ceil(width / robots), []
        for first in range(0, width, each):
            lanes = [[(x, y) for y in range(height)][:: -1 if (x - first) % 2 else 1] for x in range(first, min(first + each, width))]
            sweeps.append([(west + (y if turned else x), south + (x if turned else y)) for lane in lanes for x, y in lane])
        longest = max(sum(flight_time(a, b, speed, drift) for a, b in pairwise(sweep)) for sweep in sweeps)
        plans.append((longest, turned, sweeps))
    longest, _, sweeps = min(plans)
    return sweeps, longest


def covering(
    home: Cell, starts: Sequence[tuple[Cell, float]], cells: Sequence[Cell], speed: float, drift: tuple[float, float], name: str
) -> RoutingProblem:
    """Visit ``cells`` and end at ``home`` so that the last robot is there as early as possible, by straight flights.

    ``starts`` are the cells at which robots are free to go on, with the time until then; equal ones are vehicles of one type, in the
    order in which they come first. With the whole plume as ``cells`` it is the offline optimum that explorations are compared with.
    """
    kinds = Counter(starts)
    places = [home, *(cell for cell, _ in kinds), *cells]
    later = [0.0, *(left for _, left in kinds), *([0.0] * len(cells))]
    times = np.array([[flight_time(a, b, speed, drift) + left for b in places] for a, left in zip(places, later, strict=True)])
    np.fill_diagonal(times, 0.0)
    ids = ["home", *(f"start {k + 1}" for k in range(len(kinds))), *(f"{x},{y}" for x, y in cells)]
    sites = Sites.of(ids, depot=np.arange(len(places)) <= len(kinds), coordinates=np.array(places, dtype=np.float64))
    fleet = [VehicleType(count=count, start=1 + k, end=0, name=f"robots {k + 1}") for k, count in enumerate(kinds.values())]
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=times), fleet, "makespan", name=name, problem="min-makespan-vrp")


class PlumeExploration(Mission):
    """Visit every cell of a plume and return soon: the last robot to be back counts.

    Source: Sung (2019), chapter 4; readings and errata: docs/missions/plume-exploration.md.
    """

    name: ClassVar[str] = "plume-exploration"
    summary: ClassVar[str] = "robots find out the shape of a drifting plume, and return"
    headline: ClassVar[str] = "visited"
    lasting: ClassVar[int] = 100_000
    settings: ClassVar[Mapping[str, Setting]] = WORLDS["plume-exploration"].settings

    def world(self, seed: int, **settings: Any) -> PlumeWorld:
        world = make_world(self.name, seed, **setting_values(self.name, self.settings, settings))
        assert isinstance(world, PlumeWorld)
        return self.begin(world)

    def begin(self, world: PlumeWorld) -> PlumeWorld:
        """Play in a world that was made elsewhere."""
        self.played, self.tree = world, DepthFirst(world.start)
        self._sweeps: list[list[Cell]] | None = None
        return world

    def problem(self, observation: PlumeObservation) -> Problem | None:
        """Routes through the cells that nobody visited or flies to; None where there are none, or no robot is free."""
        o = observation
        left = _unclaimed(o)
        if not left or all(o.remaining):
            return None
        starts = list(zip(o.robots, o.remaining, strict=True))
        return covering(o.home, starts, left, o.speed, o.drift, f"plume at step {o.time}")

    def actions(self, observation: PlumeObservation, problem: Problem | None, answer: Any) -> Actions:
        o = observation
        if not o.unvisited:
            return {robot: o.home for robot, cell in enumerate(o.robots) if not o.remaining[robot] and cell != o.home}
        if answer is None:
            return {}
        left, starts = _unclaimed(o), list(zip(o.robots, o.remaining, strict=True))
        kinds = list(Counter(starts))
        free: dict[tuple[Cell, float], list[int]] = {kind: [] for kind in kinds}
        for robot, start in enumerate(starts):
            free[start].append(robot)
        routes = [(kinds[route.vehicle], left[route.visits[0] - 1 - len(kinds)]) for route in answer if route.visits]
        return {free[start].pop(0): cell for start, cell in routes if not start[1]}

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``depth-first`` and ``lawn-mower``, which is told a rectangle around the plume."""
        return {"depth-first": lambda o: self.tree.go(o), "lawn-mower": self._mow}

    def _mow(self, o: PlumeObservation) -> Actions:
        if self._sweeps is None:
            self._sweeps = lawn_mower(o.box, len(o.robots), o.speed, o.drift)[0]
        actions = {}
        for robot, sweep in enumerate(self._sweeps):
            if not o.remaining[robot]:
                while sweep and sweep[0] == o.robots[robot]:
                    sweep.pop(0)
                actions[robot] = sweep.pop(0) if sweep else o.home
        return {robot: cell for robot, cell in actions.items() if cell != o.robots[robot]}

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``shared_out``: cells in the problem of the step."""
        sizes = [len(d.problem.customers) for d in decisions if isinstance(d.problem, RoutingProblem)]
        return {"shared_out": float(sum(sizes))}

    def scene(self, world: World) -> Scene:
        """The plume's cells, those visited marked; robots under way between cells."""
        assert isinstance(world, PlumeWorld)
        cells = sorted(world.cells)
        visited = world.observe().known
        points = np.array(cells, dtype=np.float64)
        west, south, east, north = world.observe().box
        return Scene(
            (west - 1.0, south - 1.0, east + 1.0, north + 1.0), np.array(world.places()), 0.5, points,
            np.array([visited.get(cell, False) for cell in cells]), ("robots", "plume, visited", "plume, not visited yet"),
        )  # fmt: skip


def _unclaimed(o: PlumeObservation) -> list[Cell]:
    """Cells that are seen, but neither visited nor the end of a flight."""
    claimed = {cell for cell, left in zip(o.robots, o.remaining, strict=True) if left}
    return [cell for cell in o.unvisited if cell not in claimed]


MISSIONS.add("plume-exploration", PlumeExploration)
