"""Fire monitoring: an aircraft keeps returning to the hotspots of a moving fire front, so that none waits long."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from ....formulations.problem import Problem
from ....formulations.routing.problem import RoutingProblem
from ....instances.errors import UsageError
from ....instances.routing.instance import Sites, VehicleType
from ....instances.routing.spreading_fire import Flags, Floats, Integers, grid_moves, move_graph
from ....instances.routing.travel import EXPLICIT, Travel
from ....instances.routing.worlds.fire_monitoring import FireObservation, FireWorld, Hotspots
from ....instances.worlds import WORLDS, Setting, World, setting_values
from ..mission import MISSIONS, Actions, Decision, Mission, Scene

LABELS = 50_000
"""Partial patrols that the exact policy may keep; it looks less far ahead where they do not suffice."""


def weighted_scores(waits: Floats, costs: Floats, alpha: float) -> Floats:
    """Waiting time less ``alpha`` times path cost, for each hotspot: the largest is the target (3.3), whose argmin is a misprint."""
    return np.asarray(waits - alpha * costs)


def circling_heading(place: Floats, front: Floats, least: float, most: float, last: Floats) -> Floats:
    """Unit vector towards the nearest of the ``front`` beyond ``most``, away from it below ``least``, else square to it, to the left.

    ``last`` is the heading where the distance is 0. Source: Skeele (2016), algorithm 2, after Casbeer et al. (2005), corrected:
    docs/missions/fire-monitoring.md#errata.
    """
    off = front[((front - place) ** 2).sum(axis=1).argmin()] - place
    distance = float(np.hypot(*off))
    if not distance:
        return last
    unit = off / distance
    return np.asarray(unit if distance > most else -unit if distance < least else np.array([-unit[1], unit[0]]))


def least_possible(spots: Hotspots, place: Floats, speed: float, radius: float, horizon: int) -> int:
    """A lower bound on J after ``horizon`` more steps over a front that stands still, whatever flies, and -1 if it takes too long.

    From hotspot to hotspot the aircraft flies their distance less two radii at least. For a radius of 0 it is the optimum of straight
    flights. Source: all sequences of visits, by dominance; docs/missions/fire-monitoring.md#the-optimum-of-a-front-that-stands-still.
    """
    from .patrol_kernels import least_worst_waits

    apart = np.sqrt(((np.vstack([spots.places, place])[:, None, :] - spots.places) ** 2).sum(axis=2))
    apart -= np.where(np.arange(len(spots) + 1) < len(spots), 2.0, 1.0)[:, None] * radius
    return int(least_worst_waits(_steps(apart, speed), *_whole(spots), horizon, LABELS)[0])


class FireMonitoring(Mission):
    """Keep J small, the sum over hotspots of the longest wait.

    Source: Skeele (2016), chapter 3; readings and errata: docs/missions/fire-monitoring.md.
    """

    name: ClassVar[str] = "fire-monitoring"
    summary: ClassVar[str] = "an aircraft keeps returning to the hotspots of a spreading fire"
    headline: ClassVar[str] = "worst_waits"
    lasting: ClassVar[int] = 200
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["fire-monitoring"].settings,
        "alpha": Setting(0.5, "steps of waiting that a unit of path cost counts", float, 0.0, 1e6),
        "decide": Setting("every-step", "when a target is chosen anew", choices=("every-step", "on-arrival")),
        "blur": Setting(2.0, "cells over which the fire is blurred in the cost of paths", float, 0.1, 100.0),
        "near": Setting(1.0, "cost of a cell right at the fire, beside the 1 of its length", float, 0.0, 1e6),
        "inside": Setting(10.0, "further cost of a cell that burns or has burnt", float, 0.0, 1e6),
        "closest": Setting(1.0, "cells to the front below which circling turns away: d_min", float, 0.0, 1e6),
        "farthest": Setting(3.0, "cells to the front beyond which circling turns towards it: d_max", float, 0.0, 1e6),
        "look-ahead": Setting(40, "steps that the exact policy plans", int, 1, 1000),
        "patrolled": Setting(6, "hotspots that it plans for at most, those of the largest weighted scores", int, 1, 10),
    }

    def world(self, seed: int, **settings: Any) -> FireWorld:
        return self.begin(self.made(FireWorld, seed, settings))

    def begin(self, world: FireWorld) -> FireWorld:
        """Play in a world that was made elsewhere; the settings of what decides are those of ``world``, or the defaults."""
        if not hasattr(self, "values"):
            self.values = setting_values(self.name, self.settings, {})
        if self.values["closest"] > self.values["farthest"]:
            raise UsageError(
                f"closest must be at most farthest, not {self.values['closest']:g} and {self.values['farthest']:g}", "contradiction"
            )
        self.played = world
        self._target: int | None = None
        self._heading = np.array([1.0, 0.0])
        self._patrol: list[int] = []
        self._patrolled: Hotspots | None = None
        self._leg: list[Floats] = []
        return world

    def problem(self, observation: FireObservation) -> Problem | None:
        """The tour through the hotspots that are worth their way; None where none is wanted, or the last target still is one."""
        o = observation
        if not len(o.hotspots) or self._keeps(o):
            return None
        count = len(o.hotspots)
        costs = self._paths(o, np.vstack([o.place, o.hotspots.places]))[0][:, cells_of(o.burnt, o.hotspots.places)]
        matrix = np.zeros((count + 2, count + 2))
        matrix[: count + 1, 1 : count + 1] = costs
        np.fill_diagonal(matrix, 0.0)
        places = np.vstack([o.place, o.hotspots.places, o.place])
        depot = np.isin(np.arange(count + 2), (0, count + 1))
        sites = Sites.of(
            ["aircraft", *(f"hotspot {k}" for k in o.hotspots.ids), "end"], depot=depot, coordinates=places,
            reward=np.concatenate([[0.0], o.hotspots.waits, [0.0]]), required=depot,
        )  # fmt: skip
        alpha = self.values["alpha"]
        aim = f"reward - {alpha!r}*total-cost" if alpha else "reward then total-cost"
        fleet = [VehicleType(count=1, start=0, end=count + 1)]
        return RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), fleet, aim, name=f"fire at step {o.time}", problem="orienteering")

    def actions(self, observation: FireObservation, problem: Problem | None, answer: Any) -> Actions:
        """Fly towards the first hotspot of the tour; where no tour is worth its way, to that of the largest weighted score."""
        visits = [visit for route in answer or () for visit in route.visits]
        if visits:
            self._target = int(observation.hotspots.ids[visits[0] - 1])
        return self._fly(observation, choose=problem is not None and not visits)

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``weighted-greedy``, ``circling``, and ``exact``: the best patrol of a few hotspots, if they stay where they are."""
        return {"weighted-greedy": lambda o: self._fly(o, not self._keeps(o)), "circling": self._circle, "exact": self._exact}

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``asked``: hotspots in the problem of the step; ``toured``: of them, in the tour."""
        sizes = [len(d.problem.customers) for d in decisions if isinstance(d.problem, RoutingProblem)]
        toured = [len(route.visits) for d in decisions for route in d.answer or ()]
        return {"asked": float(sum(sizes)), "toured": float(sum(toured))}

    def scene(self, world: World) -> Scene:
        """The hotspots, marked, and the front; a link leads to the target."""
        assert isinstance(world, FireWorld)
        o = world.observe()
        apart = ((o.front[:, None, :] - o.hotspots.places) ** 2).sum(axis=2).min(axis=1, initial=np.inf)
        points = np.vstack([o.hotspots.places, o.front[apart > 2.0]])  # hotspots are not hidden by front cells
        links = [(0, k) for k, own in enumerate(o.hotspots.ids.tolist()) if own == self._target]
        labels = ("aircraft", "hotspots", "front")
        area = (0.0, 0.0, float(world.size[0]), float(world.size[1]))
        return Scene(area, o.place[None, :], world.rules.radius, points, np.arange(len(points)) < len(o.hotspots), labels, links=links)

    def _keeps(self, o: FireObservation) -> bool:
        """True if targets are kept until they are tracked, and the last one is not yet."""
        waits = o.hotspots.waits[o.hotspots.ids == self._target]
        return self.values["decide"] == "on-arrival" and len(waits) > 0 and bool(waits[0] > 0)

    def _fly(self, o: FireObservation, choose: bool) -> Actions:
        """A step along the cheapest path to the target, which is chosen anew by weighted scores if asked, or if there is none."""
        if not len(o.hotspots):
            return {}
        costs, before = self._paths(o, o.place[None, :])
        if choose or self._target not in o.hotspots.ids:
            scores = weighted_scores(o.hotspots.waits, costs[0, cells_of(o.burnt, o.hotspots.places)], self.values["alpha"])
            self._target = int(o.hotspots.ids[scores.argmax()])
        place = o.hotspots.places[o.hotspots.ids == self._target][0]
        return {0: advanced(o.place, corners(o.burnt, before[0], o.place, place), o.speed)[0]}

    def _circle(self, o: FireObservation) -> Actions:
        if not len(o.front):
            return {}
        self._heading = circling_heading(o.place, o.front, self.values["closest"], self.values["farthest"], self._heading)
        return {0: np.clip(o.place + o.speed * self._heading, 0.0, np.array(o.burnt.shape[::-1]) - 1.0)}

    def _exact(self, o: FireObservation) -> Actions:
        """The next step of the patrol, which is planned anew once it is flown, or the hotspots have changed."""
        then = self._patrolled
        same = then is not None and (then.ids.tolist(), then.places.tolist()) == (o.hotspots.ids.tolist(), o.hotspots.places.tolist())
        if not same:
            self._patrol, self._leg = [], []
        if not len(o.hotspots):
            return {}
        if not self._leg:
            if not self._patrol:
                self._patrolled, self._patrol = o.hotspots, self.patrol(o, self.values["look-ahead"])[1]
            place = o.hotspots.places[self._patrol.pop(0)] if self._patrol else o.place
            before = self._paths(o, o.place[None, :])[1][0]
            self._leg = corners(o.burnt, before, o.place, place)
        to, self._leg = advanced(o.place, self._leg, o.speed)
        return {0: to}

    def patrol(self, o: FireObservation, horizon: int) -> tuple[int, list[int], int]:
        """The least J after ``horizon`` steps if the hotspots stay, along cheapest paths, and the hotspots to fly to in turn.

        Halves the horizon until the plan can be made, and returns what is left of it. Each leg ends with a step.
        """
        from .patrol_kernels import least_worst_waits

        sources = np.vstack([o.hotspots.places, o.place])
        costs, before = self._paths(o, sources)
        scores = weighted_scores(o.hotspots.waits, costs[-1, cells_of(o.burnt, o.hotspots.places)], self.values["alpha"])
        chosen = np.sort(np.argsort(-scores, kind="stable")[: self.values["patrolled"]])
        rows = [*chosen.tolist(), len(o.hotspots)]
        ways = [[[sources[row], *corners(o.burnt, before[row], sources[row], o.hotspots.places[k])] for k in chosen] for row in rows]
        lengths = np.array([[sum(math.dist(a, b) for a, b in pairwise(way)) for way in own] for own in ways])
        waits, worst = (own[chosen] for own in _whole(o.hotspots))
        while True:
            total, visits = least_worst_waits(_steps(lengths, o.speed), waits, worst, horizon, LABELS)
            if total >= 0:
                return int(total), chosen[visits].tolist(), horizon
            horizon //= 2

    def _paths(self, o: FireObservation, places: Floats) -> tuple[Floats, Integers]:
        return cheapest_paths(o.burnt, places, self.values["blur"], self.values["near"], self.values["inside"])


def _steps(lengths: Floats, speed: float) -> Integers:
    """Steps of flights of these ``lengths``, shape (hotspots + 1, hotspots); to keep a hotspot takes one."""
    steps = np.ceil(np.maximum(lengths, 0.0) / speed - 1e-9).astype(np.int64)
    np.fill_diagonal(steps, 1)
    return steps


def _whole(spots: Hotspots) -> tuple[Integers, Integers]:
    return spots.waits.astype(np.int64), spots.worst.astype(np.int64)


MISSIONS.add("fire-monitoring", FireMonitoring)


SIDES = tuple((dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if (dx, dy) != (0, 0))
"""The eight directions in which a path leaves a cell."""


def cheapest_paths(burnt: Flags, places: Floats, blur: float, near: float, inside: float) -> tuple[Floats, Integers]:
    """Cost of the cheapest paths from ``places`` to all cells, and the cell before each; shape (places, cells). They are Dijkstra's.

    A unit of length costs 1, ``near`` times the fire blurred over ``blur`` cells, and ``inside`` in the fire: means of two cells.
    """
    from scipy import ndimage
    from scipy.sparse import csgraph

    cost = (1.0 + near * ndimage.gaussian_filter(burnt.astype(np.float64), blur) + inside * burnt).ravel()
    rows, columns = burnt.shape
    tail, head, way = grid_moves(rows, columns, SIDES)
    graph = move_graph(rows, columns, tail, head, np.hypot(*way.T) * (cost[tail] + cost[head]) / 2.0)
    costs, before = csgraph.dijkstra(graph, indices=cells_of(burnt, places), return_predecessors=True)
    return costs, before


def cells_of(burnt: Flags, places: Floats) -> Integers:
    """The cell of each place, by its number."""
    column, row = np.rint(places.T).astype(np.int64)
    return np.asarray(row * burnt.shape[1] + column)


def corners(burnt: Flags, before: Integers, origin: Floats, place: Floats) -> list[Floats]:
    """Corners of the path from ``origin`` on: centres of the cells between, and ``place`` itself."""
    start, cell = cells_of(burnt, np.vstack([origin, place])).tolist()
    way = [place]
    while cell != start and before[cell] != start:
        cell = int(before[cell])
        way.append(np.array([cell % burnt.shape[1], cell // burnt.shape[1]], dtype=np.float64))
    return way[::-1]


def advanced(place: Floats, way: Sequence[Floats], speed: float) -> tuple[Floats, list[Floats]]:
    """The place after a step along the corners of ``way``, and the corners that are left."""
    left, rest = speed * (1.0 + 1e-9), list(way)
    while rest:
        off = rest[0] - place
        length = float(np.hypot(*off))
        if length > left:
            return place + off * (left / length), rest
        place, left = rest.pop(0), left - length
    return place, rest
