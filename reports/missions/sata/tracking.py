"""Tracking: robots predict targets, choose where to go next so that the targets stay in sight, and go there."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, cast

import numpy as np

from ....formulations.problem import Problem
from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from ....heuristics.sata.rounding import largest_shares
from ....instances.errors import UsageError
from ....instances.generators import Draw
from ....instances.number_arrays import Floats
from ....instances.sata.sensing_graph import SensingGraph
from ....instances.sata.worlds.tracking import TrackingObservation, TrackingWorld, distances, linked, scenario_values
from ....instances.worlds import WORLDS, Setting, World, make_world, setting_values
from ..mission import MISSIONS, Actions, Decision, Mission, Scene
from . import force_vectors

PROBLEMS = ("winner-takes-all", "bottleneck", "bottleneck-lp")

SPREAD = math.radians(30.0)
"""Largest angle between a robot's heading and a primitive ahead of it."""

PRESETS: dict[str, dict[str, Any]] = {
    "matlab": {"problem": "winner-takes-all", "primitives": 21, "motion": "around"},
    "gazebo-greedy": {"problem": "winner-takes-all", "primitives": 21, "motion": "around"},
    "gazebo-local": {"problem": "bottleneck", "primitives": 2, "motion": "ahead"},
}


class Tracking(Mission):
    """Keep moving targets in the sight of a team of robots.

    Source: Sung (2019), chapter 3. Readings of what it leaves open: docs/missions.md#tracking.
    """

    name: ClassVar[str] = "tracking"
    summary: ClassVar[str] = "robots keep moving targets in sight"
    headline: ClassVar[str] = "observed"
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["tracking"].settings,
        "problem": Setting(None, "what a team solves", str, choices=PROBLEMS),
        "weights": Setting("binary", "what seeing a target is worth", choices=("binary", "inverse-distance")),
        "closest": Setting(1.0, "distances below count as this one in inverse distances, m", float, 1e-6, 1e6),
        "primitives": Setting(None, "places that a robot may be at next, where it is included", int, 1, 1000),
        "motion": Setting(None, "where primitives lie: evenly around, or at random ahead", str, choices=("around", "ahead")),
        "order": Setting("random", "of primitives: a solver that meets equals takes the first", choices=("random", "fixed")),
        "idle": Setting("random", "what a robot without an action of its own does", choices=("random", "stay")),
    }

    def world(self, seed: int, **settings: Any) -> TrackingWorld:
        values = scenario_values(setting_values(self.name, self.settings, settings))
        preset = PRESETS[values["scenario"]]
        self.values = {key: preset[key] if value is None else value for key, value in values.items()}
        world = make_world("tracking", seed, **{key: values[key] for key in WORLDS["tracking"].settings})
        assert isinstance(world, TrackingWorld)
        self._assigned = list[tuple[int, int]]()
        self._draw = Draw(np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, 1]))))
        return world

    def teams(self, observation: TrackingObservation) -> Sequence[TrackingObservation]:
        """Robots that hear each other, directly or relayed, and share targets, directly or through others of them."""
        o, self._assigned = observation, []
        sees = o.seen.astype(np.int64)
        adjacent = (sees @ sees.T > 0) & (o.components[:, None] == o.components[None, :])
        label = linked(adjacent | np.eye(len(o.ids), dtype=bool))
        return [o.part(np.nonzero(label == team)[0]) for team in range(int(label.max(initial=-1)) + 1)]

    def problem(self, observation: TrackingObservation) -> Problem | None:
        """The assignment of primitives, over the targets that some primitive is predicted to see."""
        o = observation
        if not o.seen_by_any.any():
            return None
        places = self._primitives(o)
        robots, count = places.shape[:2]
        predicted = o.measured + o.velocities
        gaps = np.sqrt(((places[:, :, None, :] - predicted[:, None, :, :]) ** 2).sum(axis=3))  # NaN where a target is not seen
        weights = self._weights(gaps, o.rules.sensing).reshape(robots * count, -1)
        targets = np.nonzero(weights.any(axis=0))[0]
        if not len(targets):
            return None
        weights = weights[:, targets]
        action, target = np.nonzero(weights)
        indptr = np.zeros(len(weights) + 1, dtype=np.int32)
        np.cumsum((weights > 0).sum(axis=1), out=indptr[1:])
        graph = SensingGraph(
            np.repeat(np.arange(robots, dtype=np.int32), count), indptr, target.astype(np.int32), weights[action, target], robots,
            len(targets), robot_names=tuple(str(k + 1) for k in o.ids.tolist()), target_names=tuple(str(t + 1) for t in targets.tolist()),
            action_positions=places.reshape(-1, 2), target_positions=np.nanmean(predicted[:, targets], axis=0),
            name=f"tracking at step {o.time + 1}",
        )  # fmt: skip
        if self.values["problem"] == "winner-takes-all":
            return WinnerTakesAllSATA(graph)
        return BottleneckSATA(graph, fractional=self.values["problem"] == "bottleneck-lp")

    def actions(self, observation: TrackingObservation, problem: Problem | None, answer: Any) -> Actions:
        """The chosen primitives as positions; shares are rounded to the largest of each robot, the last of equals."""
        o = observation
        to: dict[int, Floats] = {}
        if problem is not None and answer is not None:
            graph, chosen = _graph(problem), chosen_actions(problem, answer)
            self._assigned += [(int(o.ids[robot]), target) for robot, target in assigned(problem, answer)]
            assert graph.action_positions is not None
            if isinstance(problem, WinnerTakesAllSATA):  # without credit any primitive is as good
                credited = set(problem.winners(tuple(chosen))[0].tolist() if answer.winners is None else answer.winners)
                chosen = [action for action in chosen if int(graph.robot_of_action[action]) in credited]
            for action in chosen:
                to[int(o.ids[graph.robot_of_action[action]])] = graph.action_positions[action]
        idle = [k for k, robot in enumerate(o.ids.tolist()) if robot not in to]
        if self.values["idle"] == "random" and idle:
            places = self._primitives(o.part(idle))
            pick = self._draw.integers(0, places.shape[1] - 1, len(idle))
            to.update({int(o.ids[k]): places[n, pick[n]] for n, k in enumerate(idle)})
        return to

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``force-vector``: Parker's A-CMOMMT; ``stay``: nobody moves."""
        return {"force-vector": force_vectors.moves, "stay": lambda observation: {}}

    def total(self, values: Sequence[float]) -> float:
        """Sum of the teams' values, or the worst of them where the worst-covered target counts."""
        return math.fsum(values) if self.values["problem"] == "winner-takes-all" else min(values)

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """Predicted measures of the step beside those that came true.

        ``candidates``: different targets in the teams' problems; ``estimated_targets``: those that the chosen primitives were predicted to
        see; ``actual_targets``: candidates that robots see after the step; ``estimated_value``: the value of the chosen primitives as
        predicted; ``actual_value``: the same of the robots' and targets' true places, each robot credited with the targets that it had
        predicted alone. Values are NaN where no team has an answer.
        """
        assert isinstance(world, TrackingWorld)
        solved = [d for d in decisions if d.problem is not None]
        answered = [d for d in solved if d.answer is not None]
        candidates = {t for d in solved for t in _targets(d.problem)}
        estimated = {target for d in answered for _, target in _sights(cast(Problem, d.problem), d.answer)}
        observed = world.observe().seen_by_any
        values = np.array([self._values(d, world) for d in answered], dtype=np.float64).reshape(-1, 2)
        whole = [self.total(column) if len(values) else math.nan for column in values.T.tolist()] if len(values) else [math.nan] * 2
        return {
            "candidates": float(len(candidates)), "estimated_targets": float(len(estimated)),
            "actual_targets": float(sum(bool(observed[t]) for t in candidates)), "estimated_value": whole[0], "actual_value": whole[1],
        }  # fmt: skip

    def scene(self, world: World) -> Scene:
        assert isinstance(world, TrackingWorld)
        r, seen = world.rules, world.observe().seen_by_any
        labels = ("robots", "targets seen", "targets unseen")
        area = (0.0, 0.0, r.width, r.height)
        return Scene(area, world.robots, r.sensing, world.targets, seen, labels, world.headings, tuple(self._assigned))

    # ------------------------------------------------------------------------------------------------------------------

    def _primitives(self, o: TrackingObservation) -> Floats:
        """Places where each robot may be next, its own included, no farther than the wall; shape (robots, primitives, 2)."""
        count, step = int(self.values["primitives"]) - 1, o.rules.robot_step
        shape = (len(o.ids), count)
        if self.values["motion"] == "around":
            angles = np.broadcast_to(2.0 * math.pi * np.arange(count) / max(count, 1), shape)
            lengths = np.full(shape, step)
        else:
            angles = o.headings[:, None] + self._draw.uniform(-SPREAD, SPREAD, shape)
            lengths = step * (1.0 - self._draw.uniform(0.0, 1.0, shape))
        moves = lengths[:, :, None] * np.stack([np.cos(angles), np.sin(angles)], axis=2)
        moves = np.concatenate([np.zeros((len(o.ids), 1, 2)), moves], axis=1)
        if self.values["order"] == "random":
            order = np.argsort(self._draw.uniform(0.0, 1.0, moves.shape[:2]), axis=1)
            moves = np.take_along_axis(moves, order[:, :, None], axis=1)
        places = moves + o.positions[:, None, :]
        return np.asarray(np.clip(places, 0.0, o.rules.area))

    def _weights(self, gaps: Floats, sensing: float) -> Floats:
        """Worth of seeing at each distance; 0 beyond the sensing range, and where the distance is not known."""
        near = gaps <= sensing
        if self.values["weights"] == "binary":
            return near.astype(np.float64)
        return np.where(near, 1.0 / np.maximum(np.where(near, gaps, 1.0), self.values["closest"]), 0.0)

    def _values(self, decision: Decision, world: TrackingWorld) -> tuple[float, float]:
        """Value of a team's chosen primitives as predicted, and with all true places."""
        problem, o = cast(Problem, decision.problem), decision.view
        graph, chosen = _graph(problem), chosen_actions(problem, decision.answer)
        predicted = np.zeros((graph.num_robots, graph.num_targets))
        for action in chosen:
            edges = slice(graph.indptr[action], graph.indptr[action + 1])
            predicted[graph.robot_of_action[action], graph.indices[edges]] = graph.weights[edges]
        targets = _targets(problem)
        true = self._weights(distances(world.robots[o.ids], world.targets[targets]), world.rules.sensing)
        true = np.where(o.seen[:, targets], true, 0.0)
        if self.values["problem"] == "winner-takes-all":
            return float(predicted.max(axis=0).sum()), float(true.max(axis=0).sum())
        return float(predicted.sum(axis=0).min()), float(true.sum(axis=0).min())


def chosen_actions(problem: Problem, answer: Any) -> list[int]:
    """One action per robot at most; of shares, the largest of each robot that has any, the last of equals."""
    if isinstance(problem, BottleneckSATA) and problem.fractional:
        return [int(action) for action in largest_shares(problem.graph, np.asarray(answer, dtype=np.float64))]
    return [int(action) for action in answer]


def assigned(problem: Problem, answer: Any) -> list[tuple[int, int]]:
    """Robots of a problem, and targets by their numbers in the world: whom each target is credited to, or who is predicted to see it."""
    if isinstance(problem, WinnerTakesAllSATA):
        targets, chosen = _targets(problem), chosen_actions(problem, answer)
        winners = problem.winners(tuple(chosen))[0] if answer.winners is None else np.asarray(answer.winners)
        return [(int(robot), targets[t]) for t, robot in enumerate(winners.tolist()) if robot >= 0]
    return _sights(problem, answer)


def _sights(problem: Problem, answer: Any) -> list[tuple[int, int]]:
    """Robots of a problem, and targets by their numbers in the world that their chosen actions are predicted to see."""
    graph, targets = _graph(problem), _targets(problem)
    seen = [(int(graph.robot_of_action[a]), graph.indices[graph.indptr[a] : graph.indptr[a + 1]]) for a in chosen_actions(problem, answer)]
    return [(robot, targets[t]) for robot, own in seen for t in own.tolist()]


def _graph(problem: Problem | None) -> SensingGraph:
    if not isinstance(problem, WinnerTakesAllSATA | BottleneckSATA):
        raise UsageError(f"tracking solves {', '.join(PROBLEMS)}, not {problem!r}", "unsupported")
    return problem.graph


def _targets(problem: Problem | None) -> list[int]:
    """The targets' numbers in the world."""
    graph = _graph(problem)
    return [int(graph.target_name(t)) - 1 for t in range(graph.num_targets)]


MISSIONS.add("tracking", Tracking)
