"""Search and tracking: robots decide which supposed targets to go and look at, and a filter counts and follows what they detect."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from ....formulations.problem import Problem
from ....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from ....instances.number_arrays import Floats
from ....instances.sata.phd_filter import Mixture
from ....instances.sata.sensing_graph import SensingGraph
from ....instances.sata.worlds.search_and_track import SearchObservation, SearchWorld
from ....instances.worlds import WORLDS, Setting, World, setting_values
from ..mission import MISSIONS, Actions, Decision, Mission, Scene

OBJECTIVES = ("reduction", "nearest", "largest")


class SearchAndTrack(Mission):
    """Find targets and keep track of them, with one robot or a team.

    Source: Sung (2019), section 2.5.7; docs/missions/search-and-track.md#planning. ``reduction`` is ours.
    """

    name: ClassVar[str] = "search-and-track"
    summary: ClassVar[str] = "robots look for moving targets and track them with a Gaussian-mixture PHD filter"
    headline: ClassVar[str] = "found"
    lasting: ClassVar[int] = 7278
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["search-and-track"].settings,
        "objective": Setting("reduction", "worth of a goal", choices=OBJECTIVES),
        "plan-every": Setting(1, "steps between plans", int, 1, 10**6),
        "size": Setting("trace", "of a covariance", choices=("trace", "eigenvalue")),
        "lane": Setting(None, "distance of the lawn mower's lanes, m; as far as a robot sees if none", float, 1e-3, 1e6),
    }

    def world(self, seed: int, **settings: Any) -> SearchWorld:
        return self.begin(self.made(SearchWorld, seed, settings))

    def begin(self, world: SearchWorld) -> SearchWorld:
        """Play in a world that was made elsewhere; the settings are those of ``world``, or the defaults."""
        if not hasattr(self, "values"):
            self.values = setting_values(self.name, self.settings, {})
        r, lane = world.rules, self.values["lane"] or world.filter.sensing
        self._lanes = [lawn_mower(k * r.width / r.robots, r.width / r.robots, r.height, lane) for k in range(r.robots)]
        self._next = [0] * r.robots
        self._goals: dict[int, Floats] = {}
        self._planned: Floats = np.zeros((0, 2))
        return world

    def problem(self, observation: SearchObservation) -> Problem | None:
        """The assignment of goals; None between plans, and where no component is worth a flight."""
        if observation.time % self.values["plan-every"]:
            return None
        self._goals = {}
        worth = self.worth(observation)  # robots, goals, components
        robots, goals, components = worth.shape
        weights = worth.reshape(robots * goals, components)
        action, target = np.nonzero(weights)
        if not len(action):
            return None
        seen, target = np.unique(target, return_inverse=True)
        useful, row = np.unique(action, return_inverse=True)
        indptr = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=len(useful)))]).astype(np.int32)
        self._planned = _within(observation)
        graph = SensingGraph(
            (useful // goals).astype(np.int32), indptr, target.reshape(-1).astype(np.int32), weights[weights > 0], robots, len(seen),
            target_names=tuple(str(k + 1) for k in seen.tolist()), action_positions=self._planned[useful % goals],
            target_positions=observation.mixture.means[seen], name=f"search and tracking at step {observation.time + 1}",
        )  # fmt: skip
        return WinnerTakesAllSATA(graph)

    def worth(self, o: SearchObservation) -> Floats:
        """Gains of each robot from each component if it takes each component's mean as its goal; shape (robots, goals, components)."""
        goals, count = _within(o), len(o.mixture.weights)
        apart = np.sqrt(((o.robots[:, None, :] - goals) ** 2).sum(axis=2))
        if self.values["objective"] == "reduction":
            after = o.filter.gains(o.mixture)[2]
            less = np.trace(o.mixture.covariances - after, axis1=1, axis2=2)
            gain = o.filter.detected(o.mixture, goals) * o.mixture.weights * less if count else np.zeros((0, 0))
            gain[gain < 1e-6 * gain.max(initial=0.0)] = 0.0
            return np.asarray(gain / (1.0 + apart / o.rules.robot_step)[:, :, None])
        nearest = self.values["objective"] == "nearest"
        own = np.hypot(*o.rules.area) - apart if nearest else np.tile(self.sizes(o.mixture), (len(o.robots), 1))
        return np.asarray(np.maximum(own, 0.0)[:, :, None] * np.eye(count))

    def sizes(self, mixture: Mixture) -> Floats:
        """Size of each component's covariance, m2: its trace or its largest eigenvalue, as the source does not say which."""
        if self.values["size"] == "trace":
            return np.asarray(np.trace(mixture.covariances, axis1=1, axis2=2))
        return np.asarray(np.linalg.eigvalsh(mixture.covariances)[:, -1])

    def actions(self, observation: SearchObservation, problem: Problem | None, answer: Any) -> Actions:
        """A step towards each robot's goal; of a chosen action that credits nothing, of the lawn mower."""
        if isinstance(problem, WinnerTakesAllSATA) and answer is not None:
            graph = problem.graph
            credited = set(problem.winners(tuple(answer))[0].tolist())
            assert graph.action_positions is not None
            chosen = {int(graph.robot_of_action[action]): graph.action_positions[action] for action in answer}
            self._goals = {robot: goal for robot, goal in chosen.items() if robot in credited}
        return self._moves(observation)

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``nearest-gaussian`` and ``largest-gaussian``, each robot by itself; ``lawn-mower``, each in its strip; ``stay``."""

        def by(choice: Callable[[SearchObservation, Floats], int]) -> Callable[[SearchObservation], Actions]:
            def rule(o: SearchObservation) -> Actions:
                goals = _within(o)
                self._goals = {k: goals[choice(o, robot)] for k, robot in enumerate(o.robots)} if len(goals) else {}
                return self._moves(o)

            return rule

        return {
            "nearest-gaussian": by(lambda o, robot: int(((o.mixture.means - robot) ** 2).sum(axis=1).argmin())),
            "largest-gaussian": by(lambda o, robot: int(self.sizes(o.mixture).argmax())),
            "lawn-mower": self._moves, "stay": lambda o: {},
        }  # fmt: skip

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``assigned``: robots with a goal; ``goals``: components that the plan of this step chose among, 0 between plans."""
        planned = [d.problem for d in decisions if isinstance(d.problem, WinnerTakesAllSATA)]
        return {"assigned": float(len(self._goals)), "goals": float(sum(p.graph.num_targets for p in planned))}

    def scene(self, world: World) -> Scene:
        """Targets with a track are marked; links lead from robots to the targets nearest to their goals."""
        assert isinstance(world, SearchWorld)
        r = world.rules
        links = [(robot, int(((world.targets - goal) ** 2).sum(axis=1).argmin())) for robot, goal in self._goals.items()]
        labels = ("robots", "targets with a track", "targets without a track")
        area = (0.0, 0.0, r.width, r.height)
        return Scene(area, world.robots, world.filter.sensing, world.targets, world.found(), labels, links=links, limit=float(r.targets))

    def _moves(self, o: SearchObservation) -> dict[int, Floats]:
        """A step of each robot towards its goal, or else along its lanes, which begin anew at their end, backwards."""
        to = {}
        for k, place in enumerate(o.robots):
            lanes = self._lanes[k]
            goal = self._goals.get(k)
            if goal is None:
                if float(np.hypot(*(lanes[self._next[k]] - place))) < 1e-9:
                    self._next[k] = (self._next[k] + 1) % len(lanes)
                goal = lanes[self._next[k]]
            off = goal - place
            length = math.hypot(*off)
            to[k] = goal if length <= o.rules.robot_step else np.clip(place + off * (o.rules.robot_step / length), 0.0, o.rules.area)
        return to


def lawn_mower(left: float, width: float, height: float, lane: float) -> Floats:
    """Corners of a sweep of a strip along evenly spaced lanes, at most ``lane`` apart, and of the same way back; shape (corners, 2)."""
    count = math.ceil(width / lane * (1 - 1e-12)) + 1
    across = left + width * np.arange(count) / (count - 1)
    there = [(x, y) for k, x in enumerate(across.tolist()) for y in ((0.0, height) if k % 2 == 0 else (height, 0.0))]
    return np.array(there + there[-2:0:-1])


def _within(o: SearchObservation) -> Floats:
    """Means of the components, those outside of the area moved to its border."""
    return np.asarray(np.clip(o.mixture.means, 0.0, o.rules.area))


MISSIONS.add("search-and-track", SearchAndTrack)
