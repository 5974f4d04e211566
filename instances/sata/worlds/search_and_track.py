"""Robots with a limited field of view that look for moving targets, and what their filter makes of the detections."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...errors import UsageError
from ...generators import Draw, Flags, Floats
from ...worlds import WORLDS, Setting, World, WorldKind
from ..phd_filter import REPULSIONS, Mixture, PHDFilter
from ..tracks import TrackRules, Tracks, ospa
from ._plane import direction, distances, moved, placed, wandered

FOUND = 10.0
"""Metres from a target within which a track has found it."""


@dataclass(frozen=True)
class SearchRules:
    """Numbers of the world and its robots; lengths in metres.

    ``robot_step`` is a robot's longest move in a step, ``target_step`` a target's every move; targets turn every ``turn_every`` steps (0:
    never). The filter begins with ``initial`` components of variance ``initial_variance`` and weight ``initial_weight``: one for each of
    the first targets, on average ``initial_offset`` from it, and the others anywhere.
    """

    robots: int = 1
    targets: int = 10
    width: float = 150.0
    height: float = 150.0
    robot_step: float = 0.5
    target_step: float = 0.0
    turn_every: int = 400
    initial: int = 10
    initial_offset: float = 15.0
    initial_variance: float = 50.0
    initial_weight: float = 1.0

    def __post_init__(self) -> None:
        if self.target_step > min(self.width, self.height) / 2:
            area = f"{self.width:g} x {self.height:g} m"
            raise UsageError(f"a target's step of {self.target_step:g} m is too long for an area of {area}: at most half its shorter side")

    @property
    def area(self) -> Floats:
        """Width and height, m."""
        return np.array([self.width, self.height])


@dataclass(frozen=True, eq=False)
class SearchObservation:
    """Knowledge of the team after a step.

    ``robots`` are its positions, ``mixture`` the filter's density, and ``tracks`` the rows of those of its components that are ends of
    confirmed tracks.
    """

    time: int
    rules: SearchRules
    filter: PHDFilter
    robots: Floats
    mixture: Mixture
    tracks: list[int]


class SearchWorld(World):
    """Targets wander; robots detect those in their discs, miss some, and see some that are not there; a filter counts and follows them.

    ``robots`` and ``targets``, shape (number, 2) in metres, are where they start: by default robots in the lower corners of equal
    strips, and targets uniform in the area. Raises InputError unless each start is one finite position in the area for each.

    Source: Sung (2019), chapter 2. In each step the filter predicts, is updated with each robot's detections in turn, prunes and merges,
    and adds a component a detection; then targets are extracted, and tracks go on. What is open there: docs/missions/search-and-track.md.
    Targets, detections and errors do not depend on where robots go, but for which targets they are near.
    """

    def __init__(
        self, rules: SearchRules, density: PHDFilter, tracks: TrackRules, rng: np.random.Generator, *,
        robots: ArrayLike | None = None, targets: ArrayLike | None = None,
    ) -> None:  # fmt: skip
        self.rules, self.filter, self._draw = rules, density, Draw(rng)
        r, draw = rules, self._draw
        drawn = draw.uniform(0.0, 1.0, (r.targets, 2)) * r.area
        self.targets = drawn if targets is None else placed("target", targets, r.targets, r.area)
        corners = np.column_stack([np.arange(r.robots) * (r.width / r.robots), np.zeros(r.robots)])
        self.robots = corners if robots is None else placed("robot", robots, r.robots, r.area)
        self.headings = draw.uniform(-math.pi, math.pi, r.targets)
        self.tracks = Tracks(tracks)
        known = min(r.initial, r.targets)
        off = r.initial_offset / math.sqrt(math.pi / 2.0) * draw.normal(0.0, 1.0, 2 * r.targets).reshape(-1, 2)  # Rayleigh distances
        anywhere = draw.uniform(0.0, 1.0, (r.initial - known, 2)) * r.area
        means = np.concatenate([np.clip(self.targets + off, 0.0, r.area)[:known], anywhere])
        covariances = np.tile(r.initial_variance * np.eye(2), (r.initial, 1, 1))
        self.mixture = Mixture(np.full(r.initial, r.initial_weight), means, covariances)
        self._observed()

    def observe(self) -> SearchObservation:
        return self._observation

    def step(self, actions: Mapping[int, ArrayLike]) -> None:
        """Move each robot to the position that ``actions`` gives for its number, and all targets; robots not named stay, and all look."""
        r = self.rules
        self.robots = moved(self.robots, actions, r.robot_step, r.area)
        drawn = self._draw.uniform(-math.pi, math.pi, r.targets)
        due = r.turn_every > 0 and self.time > 0 and self.time % r.turn_every == 0
        self.headings, moves = wandered(
            self._draw, self.targets, drawn if due else self.headings, np.full((r.targets, 1), r.target_step), r.area
        )
        self.targets = self.targets + moves
        self.time += 1
        self._estimate(self._detections())
        self._observed()

    def _detections(self) -> list[Floats]:
        """Measurements of each robot, drawn for every robot and target: random draws must not depend on where robots are."""
        r, f, draw = self.rules, self.filter, self._draw
        chance = draw.uniform(0.0, 1.0, (r.robots, r.targets + 3))
        errors = f.noise * draw.normal(0.0, 1.0, 2 * r.robots * r.targets).reshape(r.robots, r.targets, 2)
        detected = self._in_sight() & (chance[:, : r.targets] < f.detection)
        detections = []
        for k, place in enumerate(self.robots):
            false, radius, angle = chance[k, r.targets :]
            ghost = place + f.sensing * math.sqrt(radius) * direction(np.array([2.0 * math.pi * angle]))
            detections.append(np.concatenate([(self.targets + errors[k])[detected[k]], ghost[: int(false < f.clutter)]]))
        return detections

    def _in_sight(self) -> Flags:
        return np.asarray(distances(self.robots, self.targets) <= self.filter.sensing)

    def _estimate(self, found: list[Floats]) -> None:
        f = self.filter
        mixture = f.predict(self.tracks.predict(self.mixture))
        for place, detections in zip(self.robots, found, strict=True):
            mixture = f.update(mixture, place, detections)
        self.mixture = f.reduced(mixture).joined(f.born(np.concatenate(found)))
        self.tracks.follow(self.mixture)

    def _observed(self) -> None:
        ends = [track.component for track in self.tracks.confirmed if track.component is not None]
        self._observation = SearchObservation(self.time, self.rules, self.filter, self.robots, self.mixture, ends)

    def found(self) -> Flags:
        """Which targets have the end of a track within ``FOUND`` metres."""
        return np.asarray((distances(self.targets, self.mixture.means[self._observation.tracks]) <= FOUND).any(axis=1))

    def metrics(self) -> dict[str, float]:
        """Errors of the confirmed tracks against the true targets.

        ``found``: targets with a track within 10 m; ``missed``: the others; ``ospa``: distance of the two sets, order 2, cut-off 100 m;
        ``tracks``, ``components``: their numbers; ``track_weight``, ``weight``: sums of their weights; ``closest``, ``next_closest``: mean
        Mahalanobis distance of a target to the closest and second closest track, NaN without one; ``variance``: largest trace of a
        component's covariance, m2; ``observed``: targets in sight.
        """
        mixture, ends = self.mixture, self._observation.tracks
        followed = mixture.part(np.array(ends, dtype=np.int64))
        away = self.targets[:, None, :] - followed.means
        squares = np.einsum("tki,kij,tkj->tk", away, np.linalg.inv(followed.covariances), away)
        closest = np.sort(np.sqrt(squares), axis=1)[:, :2].mean(axis=0)
        detected = float(self.found().sum())
        traces = np.trace(mixture.covariances, axis1=1, axis2=2)
        return {
            "found": detected, "missed": self.rules.targets - detected, "ospa": ospa(followed.means, self.targets),
            "tracks": float(len(ends)), "components": float(len(mixture.weights)),
            "track_weight": float(followed.weights.sum()), "weight": float(mixture.weights.sum()),
            "closest": float(closest[0]) if len(ends) > 0 else math.nan, "next_closest": float(closest[1]) if len(ends) > 1 else math.nan,
            "variance": float(traces.max(initial=0.0)), "observed": float(self._in_sight().any(axis=0).sum()),
        }  # fmt: skip


def read_places(text: str | None) -> list[list[float]] | None:
    """Positions from text such as ``10,20 30,40``; raises UsageError."""
    if text is None:
        return None
    try:
        places = [[float(number) for number in pair.split(",")] for pair in text.split()]
    except ValueError:
        places = [[]]
    if any(len(place) != 2 for place in places):
        raise UsageError(f"start must be pairs of numbers such as '10,20 30,40', not {text!r}", "malformed")
    return places


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> SearchWorld:
    named = {key.replace("-", "_"): value for key, value in values.items()}

    def of(kind: type) -> dict[str, Any]:
        return {field.name: named[field.name] for field in fields(kind)}

    rules, density, tracks = SearchRules(**of(SearchRules)), PHDFilter(**of(PHDFilter)), TrackRules(**of(TrackRules))
    return SearchWorld(rules, density, tracks, rng, robots=read_places(values["start"]))


WORLDS.enter(
    WorldKind(
        "search-and-track",
        "robots with a limited field of view and a filter that counts and follows moving targets",
        {
            "robots": Setting(1, "number of robots", int, 1, 100),
            "targets": Setting(10, "number of targets", int, 1, 1000),
            "width": Setting(150.0, "of the area, m", float, 1e-3, 1e6),
            "height": Setting(150.0, "of the area, m", float, 1e-3, 1e6),
            "robot-step": Setting(0.5, "longest move of a robot in a step, m", float, 1e-6, 1e6),
            "target-step": Setting(0.0, "move of a target in a step, m", float, 0, 1e6),
            "turn-every": Setting(400, "steps between turns of all targets, 0 for never", int, 0, 10**9),
            "start": Setting(None, "positions of the robots at the start: 'x,y x,y', m", str),
            "sensing": Setting(25.0, "radius of the disc that a robot sees, m", float, 1e-3, 1e6),
            "detection": Setting(0.98, "probability that a target in the disc is detected", float, 0, 1),
            "clutter": Setting(0.1, "probability of a false detection in a step of a robot", float, 0, 1),
            "noise": Setting(1.0, "standard deviation of measured coordinates, m", float, 1e-6, 1e6),
            "initial": Setting(10, "components that the filter begins with", int, 0, 1000),
            "initial-offset": Setting(15.0, "mean distance of these from their targets, m", float, 0, 1e6),
            "initial-variance": Setting(50.0, "of each of their coordinates, m2", float, 1e-6, 1e9),
            "initial-weight": Setting(1.0, "of each of them", float, 0, 1e3),
            "survival": Setting(1.0, "probability that a target is there a step later", float, 0, 1),
            "drift": Setting(0.1, "standard deviation by which a coordinate is expected to change in a step, m", float, 0, 1e6),
            "prune": Setting(1e-3, "weight below which components are dropped", float, 0, 1),
            "merge": Setting(10.0, "squared Mahalanobis distance within which components are merged", float, 0, 1e6),
            "birth": Setting(1.0, "weight of the component that each detection adds", float, 0, 1e3),
            "repulsion": Setting("all", "which components at the border of the disc are pushed out of it", choices=REPULSIONS),
            "threshold": Setting(0.5, "weight above which a component is a target", float, 0, 1e3),
            "confirm": Setting(3, "length from which a track counts, steps", int, 1, 10**6),
            "patience": Setting(3, "steps without a component that a track outlives", int, 0, 10**6),
            "gate": Setting(10.0, "squared Mahalanobis distance within which a component goes on with a track", float, 0, 1e6),
            "window": Setting(20, "latest positions that a track's motion is learnt from; 0: it stays", int, 0, 1000),
            "length-scale": Setting(20.0, "of the motion's Gaussian process, steps", float, 1e-6, 1e6),
            "kernel-noise": Setting(0.5, "of the process: deviation of a position as a share of the motion's", float, 1e-6, 1e6),
        },
        _make,
    ),
)
