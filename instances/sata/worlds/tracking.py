"""Robots that watch moving targets in a rectangle."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...errors import UsageError
from ...generators import Draw, Flags, Floats, Integers
from ...worlds import WORLDS, Setting, World, WorldKind
from ._plane import direction, distances as distances, moved, placed, wandered

SCENARIOS: dict[str, dict[str, Any]] = {
    "matlab": {
        "robots": 10, "targets": 20, "width": 200.0, "height": 200.0, "robot-step": 10.0, "target-step": 5.0, "moving": 1.0,
        "turn-every": 25, "turn-chance": 0.0, "sensing": 40.0, "communication": 80.0, "noise": 0.0,
    },
    "gazebo-greedy": {
        "robots": 10, "targets": 30, "width": 30.0, "height": 30.0, "robot-step": 1.25, "target-step": 0.625, "moving": 1.0,
        "turn-every": 0, "turn-chance": 0.1, "sensing": 5.0, "communication": 10.0, "noise": 0.0,
    },
    "gazebo-local": {
        "robots": 5, "targets": 30, "width": 15.0, "height": 15.0, "robot-step": 1.0, "target-step": 0.5, "moving": 0.5,
        "turn-every": 0, "turn-chance": 0.1, "sensing": 3.0, "communication": 6.0, "noise": 0.0,
    },
}  # fmt: skip
"""The experiments of Sung (2019), chapter 3. What the source leaves open is listed in docs/missions.md#tracking."""


@dataclass(frozen=True)
class TrackingRules:
    """Numbers and ranges, which do not change while a tracking world unfolds.

    The area is [0, ``width``] x [0, ``height``] in metres, and nobody leaves it. ``robot_step`` is a robot's longest move in a step,
    ``target_step`` a target's every move, both in metres. ``moving`` is the share of the targets that move, rounded to a number of them.
    Moving targets take new headings every ``turn_every`` steps (0 for never), and in any step with the probability ``turn_chance``. A robot
    sees the targets within ``sensing`` metres and hears the robots within ``communication`` metres. ``noise`` is the standard deviation of
    the error of each measured coordinate, in metres, and of each measured component of a velocity, in metres a step.
    """

    robots: int
    targets: int
    width: float
    height: float
    robot_step: float
    target_step: float
    moving: float = 1.0
    turn_every: int = 0
    turn_chance: float = 0.0
    sensing: float = math.inf
    communication: float = math.inf
    noise: float = 0.0

    def __post_init__(self) -> None:
        if self.target_step > min(self.width, self.height) / 2:
            raise UsageError(
                f"a target's step of {self.target_step:g} m is too long for an area of {self.width:g} x {self.height:g} m: "
                "at most half its shorter side"
            )

    @property
    def area(self) -> Floats:
        """Width and height, m."""
        return np.array([self.width, self.height])


@dataclass(frozen=True, eq=False)
class TrackingObservation:
    """Knowledge of some robots, with the numbers ``ids``, at one time.

    ``positions``, shape (robots, 2), are in metres, and ``headings`` in radians, the direction of each robot's last move. ``seen``, shape
    (robots, targets), tells which targets each robot sees now; only these can it predict. ``measured``, shape (robots, targets, 2), is
    where it sees them, and ``velocities`` their last move in metres a step as it measures it (before the first step: the move that the
    heading announces); both are NaN for other targets. Robots with one number in ``components`` hear each other, directly or relayed.
    """

    time: int
    rules: TrackingRules
    ids: Integers
    positions: Floats
    headings: Floats
    seen: Flags
    measured: Floats
    velocities: Floats
    components: Integers

    @property
    def seen_by_any(self) -> Flags:
        """Flag for each target, shape (targets,): true if at least one of the robots sees it now."""
        return np.asarray(self.seen.any(axis=0))

    def part(self, rows: ArrayLike) -> "TrackingObservation":
        """The observation of the robots in these rows alone."""
        at = np.asarray(rows)
        return replace(
            self, ids=self.ids[at], positions=self.positions[at], headings=self.headings[at], seen=self.seen[at],
            measured=self.measured[at], velocities=self.velocities[at], components=self.components[at],
        )  # fmt: skip


class TrackingWorld(World):
    """Targets move along straight lines and turn now and then; robots move as they are told and see what is near.

    ``robots`` and ``targets``, shape (number, 2) in metres, are where they start, uniform in the area unless they are given. Raises
    InputError unless each start is one finite position in the area for each.

    Source: Sung (2019), section 3.5; what it leaves open: docs/missions.md#tracking. A target whose next move would cross a wall draws
    headings until one leads inside. The targets' way depends on the seed, the rules and their numbers alone.
    """

    def __init__(
        self, rules: TrackingRules, rng: np.random.Generator, *, robots: ArrayLike | None = None, targets: ArrayLike | None = None
    ) -> None:
        self.rules, self._draw = rules, Draw(rng)
        self.time = 0
        self.targets = self._start("target", rules.targets, targets)
        self.target_headings = self._draw.uniform(-math.pi, math.pi, rules.targets)
        self.moving = self._draw.chosen(round(rules.moving * rules.targets), rules.targets)
        self.robots = self._start("robot", rules.robots, robots)
        self.headings = self._draw.uniform(-math.pi, math.pi, rules.robots)
        self._last_move = rules.target_step * direction(self.target_headings) * self.moving[:, None]
        self._observation = self._look()
        self._before: Flags = np.zeros(rules.targets, dtype=bool)

    def _start(self, what: str, count: int, given: ArrayLike | None) -> Floats:
        drawn = self._draw.uniform(0.0, 1.0, (count, 2)) * self.rules.area
        return drawn if given is None else placed(what, given, count, self.rules.area)

    # -- the three things that every world does ------------------------------------------------------------------------

    def observe(self) -> TrackingObservation:
        """The observation of all robots; ``TrackingObservation.part`` gives the share of some of them."""
        return self._observation

    def step(self, actions: Mapping[int, ArrayLike]) -> None:
        """Move each robot to the position that ``actions`` gives for its number, and all targets; robots not named stay."""
        to = moved(self.robots, actions, self.rules.robot_step, self.rules.area)
        moves = to - self.robots
        turned = (moves**2).sum(axis=1) > 0
        self.headings = np.where(turned, np.arctan2(moves[:, 1], moves[:, 0]), self.headings)
        self.robots, self._before = to, self._observation.seen_by_any
        self._move_targets()
        self.time += 1
        self._observation = self._look()

    def metrics(self) -> dict[str, float]:
        """``observed``: targets that at least one robot sees; ``kept``: those that one saw a step ago, too; ``components``: of the
        communication graph."""
        o = self._observation
        now = o.seen_by_any
        kept = now & self._before
        return {"observed": float(now.sum()), "kept": float(kept.sum()), "components": float(len(np.unique(o.components)))}

    # ------------------------------------------------------------------------------------------------------------------

    def _move_targets(self) -> None:
        r, draw = self.rules, self._draw
        drawn, chance = draw.uniform(-math.pi, math.pi, r.targets), draw.uniform(0.0, 1.0, r.targets)
        due = r.turn_every > 0 and self.time > 0 and self.time % r.turn_every == 0
        headings = np.where(due | (chance < r.turn_chance), drawn, self.target_headings)
        reach = np.asarray(r.target_step * self.moving[:, None], dtype=np.float64)
        self.target_headings, self._last_move = wandered(draw, self.targets, headings, reach, r.area)
        self.targets = self.targets + self._last_move

    def _look(self) -> TrackingObservation:
        r = self.rules
        # Drawn whether or not there is noise, and for all pairs: the targets' way must depend on neither.
        errors = self._draw.normal(0.0, 1.0, 4 * r.robots * r.targets).reshape(2, r.robots, r.targets, 2) * r.noise
        seen = distances(self.robots, self.targets) <= r.sensing
        hidden = ~seen[:, :, None]
        return TrackingObservation(
            self.time, r, np.arange(r.robots), self.robots, self.headings, seen,
            np.where(hidden, np.nan, self.targets + errors[0]), np.where(hidden, np.nan, self._last_move + errors[1]),
            linked(distances(self.robots, self.robots) <= r.communication),
        )  # fmt: skip


def linked(adjacent: Flags) -> Integers:
    """The connected component of each node, numbered by their first nodes, of a symmetric matrix with a true diagonal."""
    least = np.arange(len(adjacent))
    while True:
        spread = np.where(adjacent, least[None, :], len(adjacent)).min(axis=1, initial=len(adjacent))
        if (spread == least).all():
            return np.unique(least, return_inverse=True)[1].reshape(-1)
        least = spread


def scenario_values(values: Mapping[str, Any]) -> dict[str, Any]:
    """Values of the settings, with the scenario's own in place of those that are None."""
    preset = SCENARIOS[values["scenario"]]
    return {key: preset[key] if value is None and key in preset else value for key, value in values.items()}


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> TrackingWorld:
    full = scenario_values(values)
    return TrackingWorld(TrackingRules(**{key.replace("-", "_"): value for key, value in full.items() if key != "scenario"}), rng)


WORLDS.enter(
    WorldKind(
        "tracking",
        "robots with a sensing range in a rectangle with moving targets",
        {
            "scenario": Setting("matlab", "whose numbers hold where nothing else is said", choices=tuple(SCENARIOS)),
            "robots": Setting(None, "number of robots", int, 1, 1000),
            "targets": Setting(None, "number of targets", int, 1, 10_000),
            "width": Setting(None, "of the area, m", float, 1e-3, 1e6),
            "height": Setting(None, "of the area, m", float, 1e-3, 1e6),
            "robot-step": Setting(None, "longest move of a robot in a step, m", float, 0, 1e6),
            "target-step": Setting(None, "move of a target in a step, m", float, 0, 1e6),
            "moving": Setting(None, "share of the targets that move", float, 0, 1),
            "turn-every": Setting(None, "steps between turns of all targets, 0 for never", int, 0, 10**9),
            "turn-chance": Setting(None, "probability of a target's turn in a step", float, 0, 1),
            "sensing": Setting(None, "range in which a robot sees targets, m", float, 0, 1e6),
            "communication": Setting(None, "range in which robots hear each other, m", float, 0, 1e6),
            "noise": Setting(None, "standard deviation of measured coordinates, m", float, 0, 1e6),
        },
        _make,
    ),
)
