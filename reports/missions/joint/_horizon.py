"""Plans of a team within a horizon: views that are selected, ways that are open, and routes that are extended."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ....formulations.sata.submodular_selection import SubmodularSelection
from ....formulations.stop import Stop
from ....heuristics.sata.greedy_steps.picking import pick
from ....instances.errors import InputError
from ....instances.generators import Floats, Integers
from ....instances.routing.occupancy import way, ways
from ....instances.routing.occupancy_maps import cell_worth
from ....instances.routing.worlds.persistent_exploration import Cell, MapObservation, PersistentWorld
from ....instances.sata.constraints import Cardinality
from ....instances.sata.set_functions import DenseFacilityLocation


@dataclass
class Plan:
    """Plan of a robot: cells from where it can be told another way to its last waypoint, and its way home from there.

    ``end`` is in seconds from now, ``used`` the time in the air by then; ``stops`` are waypoints with the moments at which it is there.
    """

    robot: int
    cell: Cell
    end: float
    used: float
    fresh: bool
    cells: list[Cell] = field(default_factory=list)
    home: list[Cell] = field(default_factory=list)
    stops: list[tuple[Cell, float]] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Round:
    """Waypoints selected in one round of a horizon, their rewards, and the plans that they may extend.

    ``added`` is what they add to the worth of all waypoints so far, ``at_most`` what no choice of as many exceeds.
    """

    chosen: list[Cell]
    rewards: Floats
    plans: list[Plan]
    added: float
    at_most: float


class Horizon:
    """Planning from an observation on: the ways that are open, the views that may be selected, and plans so far.

    Raises InputError if no view is within reach of the base.
    """

    def __init__(
        self, o: MapObservation, world: PersistentWorld, values: Mapping[str, Any], stops: Mapping[int, Sequence[tuple[Cell, float]]]
    ):
        self.o, self.step, self.limit, self.world = o, world.seconds, world.endurance, world
        known = world.terrain.known
        self.closes = np.where(known, np.inf, o.map.closes(values["free"]).reshape(known.shape))
        self._frozen, self._found = bool(np.isinf(self.closes).all()), dict[tuple[Cell, float], Integers]()
        self.tree = self.ways_from(o.base, 0.0)
        grid = np.indices(known.shape).reshape(2, -1).T
        near = (self.tree.ravel() > 0) & (2.0 * self.tree.ravel() * self.step <= self.limit)
        self.pool: Integers = grid[near & (grid % values["spacing"] == 0).all(axis=1)]
        if not len(self.pool):
            message = "no view is within reach: the battery does not last for the way there and back"
            raise InputError(message, "contradiction", expected="a cell of the planning grid within reach of the base")
        self.worth = np.where(known.ravel(), 0.0, cell_worth(o.map, values["utility"], values["misfit-weight"]))
        self.worth[self.worth < 1e-12] = 0.0
        self.plans = [plan for robot in range(len(o.robots)) if (plan := self._committed(robot, stops.get(robot, ()))) is not None]
        self.places = [stop for plan in self.plans for stop, _ in plan.stops]
        self.left = np.ones(len(self.pool), dtype=bool)

    @cached_property
    def offered(self) -> Floats:
        """Weights of all views of the pool."""
        return self.weights(self.pool)

    def ways_from(self, start: Cell, begin: float) -> Integers:
        """Steps of shortest ways from a cell, for who begins there in so many seconds, which counts where cells close later."""
        key = start, 0.0 if self._frozen else begin
        if key not in self._found:
            self._found[key] = ways(self.closes, [start], begin, self.step)[0]
        return self._found[key]

    def weights(self, cells: Any) -> Floats:
        """Worth that a view from each of ``cells`` gives each cell of the map."""
        return self.world.beams.visibility(self.o.p, np.asarray(cells, dtype=np.int64).reshape(-1, 2)) * self.worth

    def _committed(self, robot: int, stops: Sequence[tuple[Cell, float]]) -> Plan | None:
        """The plan of a robot as far as it is bound by: to its next waypoint; None if it cannot be told anything."""
        state = self.o.robots[robot]
        if state.free:
            return Plan(robot, state.cell, 0.0, 0.0, True)
        if not state.aloft:
            return None
        plan = Plan(robot, state.cell, state.after, state.flown, False)
        following = next(((cell, moment) for cell, moment in stops if moment >= self.o.clock + state.after - 1e-6), None)
        if following is not None:
            count = round((following[1] - self.o.clock - state.after) / self.step)
            plan.cells, plan.stops = list(state.ahead[:count]), [following]
            plan.cell, plan.end, plan.used = following[0], plan.end + count * self.step, plan.used + count * self.step
        return plan if self._bring_home(plan) else None

    def _bring_home(self, plan: Plan) -> bool:
        steps = self.ways_from(plan.cell, plan.end)
        back = int(steps[self.o.base])
        if back < 0 or plan.used + back * self.step > self.limit + 1e-6:
            return False
        plan.home = way(steps, self.o.base)
        return True

    def reachable(self, plan: Plan) -> Any:
        """Views that a robot can go on to and be home in time, by the ways of now."""
        out = self.ways_from(plan.cell, plan.end)[self.pool[:, 0], self.pool[:, 1]]
        back = self.tree[self.pool[:, 0], self.pool[:, 1]]
        return self.left & (out >= 0) & (plan.used + (out + back) * self.step <= self.limit + 1e-6), out * self.step

    def extend(self, plan: Plan, target: Cell) -> bool:
        """Let a plan go on to a waypoint; False, and no change, if it is closed by then or the robot would not be home in time."""
        steps = self.ways_from(plan.cell, plan.end)
        taken = int(steps[target]) * self.step
        if taken < 0.0:
            return False
        longer = Plan(plan.robot, target, plan.end + taken, plan.used + taken, plan.fresh, [*plan.cells, *way(steps, target)])
        if not self._bring_home(longer):
            return False
        plan.__dict__.update(longer.__dict__, stops=[*plan.stops, (target, self.o.clock + longer.end)])
        self.places.append(target)
        return True

    def selected(self, plans: list[Plan], count: int, least: float) -> tuple[list[int], float, float]:
        """The next views of the pool, lazily and greedily by what they add to all waypoints so far (algorithm 5); what they add, and a
        bound for all choices: these add no more than any of what was picked first and the largest gains beside it (Minoux 1978)."""
        open_ = np.flatnonzero(np.any([self.reachable(plan)[0] for plan in plans], axis=0))
        if not len(open_):
            return [], 0.0, 0.0
        base = range(len(open_), len(open_) + len(self.places))
        function = DenseFacilityLocation(np.vstack([self.offered[open_], self.weights(self.places)]))
        problem = SubmodularSelection(function, Cardinality(count + len(base)))
        picked = pick(problem, Stop(math.inf), evaluation="lazy", eps=least, base=base)
        best = function.matrix[list(base)].max(axis=0, initial=0.0)
        added, at_most = 0.0, math.inf
        for k, gain in [*zip(picked.elements, picked.gains, strict=True), (-1, 0.0)]:
            gains = np.sort(np.maximum(function.matrix[: len(open_)] - best, 0.0).sum(axis=1))[::-1]
            at_most = min(at_most, added + float(gains[:count].sum()))
            best, added = np.maximum(best, function.matrix[k]), added + gain
        return [int(open_[k]) for k in picked.elements], added, at_most
