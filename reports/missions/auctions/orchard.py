"""Orchard: robots bring empty bins to pickers and full ones home."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, ClassVar

import numpy as np

from ....formulations.auctions.bin_assignment import BinAssignment
from ....formulations.auctions.joint_assignment import JointAssignment
from ....formulations.auctions.orchard_day import OrchardDay
from ....formulations.problem import Problem
from ....instances.auctions.assignment import AssignmentInstance
from ....instances.auctions.joint_assignment import JointAssignmentInstance
from ....instances.auctions.orchard_jobs import OrchardJobs
from ....instances.auctions.orchard_rules import Trip
from ....instances.auctions.worlds.orchard import HAULING, OrchardObservation, OrchardWorld
from ....instances.worlds import WORLDS, Setting, World
from ..mission import MISSIONS, Actions, Decision, Mission, Scene
from .orchard_days.policies import CHOOSING, COSTS, DELIVERIES, costs, trips

PLANS = ("step", "joint", "makespan", "completion")

STACK, GAP, BESIDE = 3, 0.36, 0.25
"""Sizes in pictures: returned bins a lane beside the repository, the distance between them, and that of a bin from the robot that carries
it."""


class Orchard(Mission):
    """Bring all bins home early: whenever robots are idle, they decide which bins they fetch and where they bring new ones.

    Source: Zhang (2015), sections 3.2 to 3.5. Readings of what it leaves open: docs/missions.md#orchard.
    """

    name: ClassVar[str] = "orchard"
    summary: ClassVar[str] = "robots bring empty bins to pickers and full ones home"
    headline: ClassVar[str] = "returned"
    lasting: ClassVar[int] = 10_000  # one robot takes some 2,500 for 160 bins
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["orchard"].settings,
        "delivery": Setting("proposed", "where new bins go: ahead of requests too, or to the earliest request alone", choices=DELIVERIES),
        "cost": Setting("later", "of a bin: travel and filling, whichever ends later, or their sum", choices=COSTS),
        "plan": Setting(
            "step",
            "what robots solve: an assignment, one of bins and requests, or a schedule of standing bins by its last step or all",
            choices=PLANS,
        ),
        "idle": Setting("return", "what a robot in the field does without a bin to fetch", choices=("return", "stay")),
    }

    def world(self, seed: int, **settings: Any) -> OrchardWorld:
        return self.made(OrchardWorld, seed, settings)

    def problem(self, observation: OrchardObservation) -> Problem | None:
        o = observation
        if not len(o.robots) or not len(o.bins):
            return None
        if self.values["plan"] == "joint":
            return joint_assignment(o)
        if self.values["plan"] != "step":
            return OrchardDay(known_jobs(o), self.values["plan"])
        travel = o.rules.grid.empty_times[np.ix_(o.cells, o.bin_cells)]
        instance = AssignmentInstance.from_matrix(
            travel, filled=o.remaining.astype(np.float64), robot_names=tuple(str(r + 1) for r in o.robots.tolist()),
            bin_names=tuple(str(b + 1) for b in o.bins.tolist()), name=f"orchard at step {o.time}",
        )  # fmt: skip
        return BinAssignment(instance, waiting="max" if self.values["cost"] == "later" else "sum")

    def actions(self, observation: OrchardObservation, problem: Problem | None, answer: Any) -> Actions:
        o, chosen = observation, {}
        if problem is not None and answer is not None:
            if isinstance(problem, JointAssignment):
                return self._errands(o, answer)
            if isinstance(problem, OrchardDay):
                first = [own[0][1] if own else -1 for own in answer]
                chosen = {int(robot): first[robot] for robot in o.robots}
            else:
                chosen = dict(zip(o.robots.tolist(), answer, strict=True))
        chosen = {robot: int(row) for robot, row in chosen.items() if row >= 0}
        return trips(o, chosen, self.values["delivery"], self.values["idle"] == "return")

    def _errands(self, o: OrchardObservation, answer: Any) -> Actions:
        """The robots' trips; one at the repository without a request brings a new bin to the cell of its bin, if one is wanted there."""
        chosen: dict[int, Trip] = {}
        brought = {int(o.requests[request]) for _, request in answer if request >= 0}
        for robot, cell, (row, request) in zip(o.robots.tolist(), o.cells.tolist(), answer, strict=True):
            deliver = int(o.requests[request]) if request >= 0 else -1
            near = int(o.bin_cells[row]) if row >= 0 else -1
            ahead = self.values["delivery"] == "proposed" and deliver < 0 <= near and cell == o.rules.grid.home
            if ahead and o.wanting[near] and near not in brought:
                deliver = near
                brought.add(near)
            if row >= 0 or deliver >= 0 or self.values["idle"] == "return":
                chosen[robot] = Trip(deliver, int(o.bins[row]) if row >= 0 else -1)
        return chosen

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``greedy``, ``auction``, ``auction-immediate`` and ``assignment``; see ``orchard_days.policies.CHOICES``."""
        return {name: partial(self._by_rule, name) for name in CHOOSING}

    def _by_rule(self, name: str, o: OrchardObservation) -> Actions:
        chosen = CHOOSING[name](o, self.values["cost"]) if len(o.bins) else {}
        return trips(o, chosen, self.values["delivery"], self.values["idle"] == "return")

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``deciding``: idle robots; ``least``: the least sum of costs of as many of them as there are bins for; ``beaten``: 1 where the
        answer's sum is larger, else 0.

        The latter two are NaN where fewer than two robots choose, or by a schedule.
        """
        deciding, least, beaten = 0, math.nan, math.nan
        for d in decisions:
            deciding += len(d.view.robots)
            if isinstance(d.problem, BinAssignment) and d.answer is not None and len(d.view.robots) > 1:
                matrix = costs(d.view, self.values["cost"])
                least = _least(matrix)
                beaten = float(sum(int(matrix[i, j]) for i, j in enumerate(d.answer) if j >= 0) > least)
        return {"deciding": float(deciding), "least": least, "beaten": beaten}

    def scene(self, world: World) -> Scene:
        """Lanes from left to right, the first one on top; bins where they are, returned ones beside the repository."""
        assert isinstance(world, OrchardWorld)
        grid = world.rules.grid
        top = grid.rows - 1
        robots = np.column_stack([world.positions()[:, 1], top - world.positions()[:, 0]])
        rows, columns = np.divmod(world.bin_cells, grid.columns)
        points = np.column_stack([columns, top - rows]).astype(np.float64)
        points[world.stood < 0] = np.nan
        for robot in range(world.rules.robots):
            for k in (world.carried[robot], world.fetched[robot] if world.states[robot] == HAULING else -1):
                if k >= 0:
                    points[k] = robots[robot] + BESIDE
        home = world.returned >= 0
        order = np.argsort(world.returned[home], kind="stable")
        place = np.empty(len(order), dtype=np.int64)
        place[order] = np.arange(len(order))
        high = STACK * grid.rows
        points[home] = np.column_stack([-1.0 - GAP * (place // high), top + 0.3 - (place % high) / STACK])
        wide = 1.5 + GAP * (world.rules.bins // high)
        area = (-wide, -0.8, grid.columns - 0.4, top + 0.8)
        return Scene(area, robots, 0.3, points, home, ("robots", "bins returned", "bins in the orchard"))


def known_jobs(o: OrchardObservation) -> OrchardJobs:
    """The bins that stand free in the orchard, for all robots: busy ones begin at the repository when they are back."""
    grid, count = o.rules.grid, len(o.bins)
    cells, free = np.full(o.rules.robots, grid.home), o.homecoming - o.time
    cells[o.robots], free[o.robots] = o.cells, 0
    return OrchardJobs(
        grid, cells, free, o.bin_cells, np.full(count, -1), np.ones(count, dtype=bool), o.remaining, name=f"orchard at step {o.time}",
    )  # fmt: skip


def joint_assignment(o: OrchardObservation) -> JointAssignment:
    """Idle robots, bins in the orchard and open requests; a robot that is not at the repository has nothing to bring."""
    grid, home = o.rules.grid, (o.cells == o.rules.grid.home)[:, None]
    return JointAssignment(
        JointAssignmentInstance(
            grid.empty_times[np.ix_(o.cells, o.bin_cells)].astype(np.float64),
            np.where(home, grid.empty_times[np.ix_(o.cells, o.requests)], math.inf).reshape(len(o.cells), len(o.requests)),
            grid.empty_times[np.ix_(o.requests, o.bin_cells)].astype(np.float64), o.remaining.astype(np.float64),
            robot_names=tuple(str(r + 1) for r in o.robots.tolist()), bin_names=tuple(str(b + 1) for b in o.bins.tolist()),
            request_names=tuple(f"cell {c}" for c in o.requests.tolist()), name=f"orchard at step {o.time}",
        )
    )  # fmt: skip


def _least(matrix: Any) -> float:
    from scipy.optimize import linear_sum_assignment

    return float(matrix[linear_sum_assignment(matrix)].sum())


MISSIONS.add("orchard", Orchard)
