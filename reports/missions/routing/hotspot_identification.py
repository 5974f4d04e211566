"""Hotspot identification: an aerial robot takes pictures from several altitudes to find the most intense place while its time lasts."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from ....formulations.problem import Problem
from ....formulations.routing.problem import RoutingProblem
from ....instances.number_arrays import Flags, Floats
from ....instances.routing.aerial_pictures import Arms
from ....instances.routing.instance import Sites, VehicleType
from ....instances.routing.travel import EXPLICIT, Travel
from ....instances.routing.worlds.hotspot_identification import HotspotObservation, HotspotWorld
from ....instances.worlds import WORLDS, Setting, World
from ..mission import MISSIONS, Actions, Decision, Mission, Scene

SCALES = {("current", "decreasing"): 1.5, ("future", "decreasing"): 10.0, ("current", "increasing"): 0.5, ("future", "increasing"): 10.0}
"""Scale of beta by variance and schedule: section 5.6.1 of the source."""


def bonus_weight(scale: float, rate: float, pictures: int, schedule: str) -> float:
    """beta after so many pictures: scale exp(rate k), or if increasing, scale (1 - exp(rate k)). Source: Sung (2019), (5.6)."""
    decay = scale * math.exp(rate * pictures)
    return decay if schedule == "decreasing" else scale - decay


def mean_variances(o: HotspotObservation, which: str, arms: Flags, cells: str = "independent") -> Floats:
    """Variance of the mean over each footprint as if its cells were independent, infinite but for ``arms``; shape (arms,).

    ``current``: of the belief; ``future``: of what is left of it once the cells of the footprint were measured from there. With
    ``dependent`` cells it is the mean of their variances. Source: Sung (2019), sections 5.4.5 and 5.5, (5.7).
    """
    variances = np.full(len(o.arms), np.inf)
    for layer in o.arms.layers:
        own = np.flatnonzero(arms[layer.arms])
        inside = layer.cells[own]
        each = o.belief.variance[inside] if which == "current" else o.belief.variance_left(inside, layer.noise)
        variances[layer.first + own] = each.mean(axis=1) / (inside.shape[1] if cells == "independent" else 1)
    return variances


def block_start(pictures: int) -> bool:
    """True if block UCL chooses anew after so many pictures; else it repeats the last arm.

    Frame k = 1, 2, ... has pictures 2^(k-1) to 2^k - 1, in blocks of k, the last one shorter. Source: Reverdy, Srivastava and Leonard
    (2014), section V.
    """
    frame = (pictures + 1).bit_length()
    return (pictures + 1 - (1 << (frame - 1))) % frame == 0


def sweep(arms: Arms) -> list[int]:
    """Arms of the lowest layer whose footprints cover the field, in rows there and back."""
    layer = arms.layers[0]
    corners = arms.places[layer.arms, :2] - layer.side / 2.0
    lanes = [np.unique([*own[:: layer.side], own[-1]]) for own in (np.unique(corners[:, 0]), np.unique(corners[:, 1]))]
    order = [(x, y) for k, y in enumerate(lanes[1]) for x in (lanes[0][::-1] if k % 2 else lanes[0])]
    number = {tuple(corner): layer.first + k for k, corner in enumerate(corners.tolist())}
    return [number[corner] for corner in order]


def picture_route(
    place: Floats, places: Floats, rewards: Floats, sensing_time: float, left: float, name: str
) -> RoutingProblem:  # fmt: skip
    """The most reward from pictures at ``places``, shape (arms, 3), in the time ``left`` from ``place``: orienteering without a return."""
    stops = np.vstack([place, place, places])
    times = np.sqrt(((stops[:, None, :] - stops) ** 2).sum(axis=2)) + sensing_time
    times[:, :2] = 0.0
    times[1] = 0.0
    np.fill_diagonal(times, 0.0)
    ids = ["start", "end", *(f"arm {k + 1}" for k in range(len(places)))]
    sites = Sites.of(
        ids, depot=np.arange(len(ids)) < 2, reward=[0.0, 0.0, *rewards], required=np.zeros(len(ids), bool), coordinates=stops[:, :2]
    )
    fleet = [VehicleType(count=1, start=0, end=1, max_distance=left, name="robot")]
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=times), fleet, "reward", name=name, problem="orienteering")


class HotspotIdentification(Mission):
    """Find the most intense place of a field while the time for flights and pictures lasts.

    Source: Sung (2019), chapter 5; readings and errata: docs/missions/hotspot-identification.md. Routes are ours.
    """

    name: ClassVar[str] = "hotspot-identification"
    summary: ClassVar[str] = "an aerial robot finds the most intense place of a field with a Gaussian process while its time lasts"
    headline: ClassVar[str] = "point"
    lasting: ClassVar[int] = 100_000
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["hotspot-identification"].settings,
        "schedule": Setting("increasing", "of beta, the weight of the variance, with pictures", choices=("increasing", "decreasing")),
        "scale": Setting(None, "of beta; the source's for the policy and schedule if none", float, 0.0, 1e6),
        "rate": Setting(-0.05, "of the exponential in beta, a picture", float, -1e3, 0.0),
        "cells": Setting("independent", "of a footprint, in the variance of their mean: independent as printed, or dependent in full",
                         choices=("independent", "dependent")),
        "window": Setting(5.0, "how far a policy with a window flies along each horizontal axis, m", float, 0.0, 1e6),
        "climb": Setting(30.0, "how far it climbs or descends at most, m", float, 0.0, 1e6),
        "last": Setting("stop", "if the best arm is too far for the time left: stop, or take the best that is not",
                        choices=("stop", "reach")),
        "variance": Setting("future", "in the indices of a solver's or heuristic's arms", choices=("current", "future")),
        "candidates": Setting(20, "arms of an orienteering problem", int, 1, 1000),
    }  # fmt: skip

    def world(self, seed: int, **settings: Any) -> HotspotWorld:
        world = self.made(HotspotWorld, seed, settings)
        self.played = world
        self._sweep: list[int] | None = None
        self._planned: list[int] = []
        return world

    def indices(self, o: HotspotObservation, which: str, arms: Flags) -> Floats:
        """Upper confidence bounds of ``arms``, minus infinity for others; ``which`` is ``current`` or ``future``."""
        v = self.values
        scale = SCALES[which, v["schedule"]] if v["scale"] is None else v["scale"]
        beta = bonus_weight(scale, v["rate"], len(o.taken), v["schedule"])
        bounds = np.full(len(o.arms), -np.inf)
        bounds[arms] = (o.arms.means(o.belief.mean) + beta * mean_variances(o, which, arms, v["cells"]))[arms]
        return bounds

    def problem(self, observation: HotspotObservation) -> Problem | None:
        """Orienteering among the best arms; None before the first picture, and where no arm that can be reached is worth one."""
        o = observation
        self._planned = self.best_apart(o) if o.taken else []
        if not self._planned:
            return None
        places, rewards = o.arms.places[self._planned], self._indices[self._planned]
        return picture_route(o.place, places, rewards, o.sensing_time, o.left, f"pictures after {len(o.taken)}")

    def best_apart(self, o: HotspotObservation) -> list[int]:
        """The arms of the largest positive indices, of those that can be reached and were not taken, with disjoint footprints."""
        open_arms = o.needed() <= o.left
        open_arms[list(o.taken)] = False
        self._indices = self.indices(o, self.values["variance"], open_arms)
        chosen: list[int] = []
        covered = np.zeros(len(o.belief.points), dtype=np.bool_)
        for arm in np.argsort(-self._indices, kind="stable").tolist():
            if len(chosen) == self.values["candidates"] or self._indices[arm] <= 0.0:
                break
            cells = o.arms.cells(arm)
            if not covered[cells].any():
                covered[cells] = True
                chosen.append(arm)
        return chosen

    def actions(self, observation: HotspotObservation, problem: Problem | None, answer: Any) -> Actions:
        """Fly to the first arm of the route; end the flight if there is no route."""
        if not observation.taken:
            return self._nearest(observation)
        if problem is None or answer is None or not len(answer):
            return {}
        return {0: self._planned[next(iter(answer)).visits[0] - 2]}

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``current-variance``, ``future-variance``, both with ``-window``, ``block-ucl`` and ``boustrophedon``."""

        def bound(which: str, near: bool) -> Callable[[HotspotObservation], Actions]:
            def rule(o: HotspotObservation) -> Actions:
                if not o.taken:
                    return self._nearest(o)
                off, v = np.abs(o.arms.places - o.place), self.values
                arms = (off[:, :2].max(axis=1) <= v["window"]) & (off[:, 2] <= v["climb"]) if near else np.ones(len(o.arms), bool)
                if v["last"] == "reach":
                    arms = arms & (o.needed() <= o.left)
                return self._fly(o, int(self.indices(o, which, arms).argmax()))

            return rule

        names = {f"{which}-variance{'-window' * near}": bound(which, near) for which in ("current", "future") for near in (False, True)}
        return {**names, "block-ucl": self._block_ucl, "boustrophedon": self._boustrophedon}

    def _block_ucl(self, o: HotspotObservation) -> Actions:
        from scipy.special import ndtri

        if not o.taken:
            return self._nearest(o)
        if not block_start(len(o.taken)):
            return self._fly(o, o.taken[-1])
        deviations = np.sqrt(mean_variances(o, "current", np.ones(len(o.arms), bool)))
        quantile = float(ndtri(1.0 - 1.0 / (math.sqrt(2.0 * math.pi * math.e) * (len(o.taken) + 1))))
        return self._fly(o, int((o.arms.means(o.belief.mean) + quantile * deviations).argmax()))

    def _boustrophedon(self, o: HotspotObservation) -> Actions:
        if self._sweep is None:
            self._sweep = sweep(o.arms)
        return self._fly(o, self._sweep.pop(0)) if self._sweep else {}

    def _nearest(self, o: HotspotObservation) -> Actions:
        return self._fly(o, int(o.needed().argmin()))

    def _fly(self, o: HotspotObservation, arm: int) -> Actions:
        """Fly to an arm; end the flight if there is no time for that."""
        return {0: arm} if o.needed()[arm] <= o.left else {}

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``planned``: pictures on the route of the step."""
        routes = [d.answer for d in decisions if d.answer is not None]
        return {"planned": float(sum(len(route.visits) for answer in routes for route in answer))}

    def scene(self, world: World) -> Scene:
        """Cells in a picture, which are marked, and hotspots that are in none yet; as full as they are believed to be intense."""
        from scipy.ndimage import maximum_filter

        assert isinstance(world, HotspotWorld)
        rows, columns = world.field.shape
        seen = np.zeros(world.field.size, dtype=np.bool_)
        for arm in set(world.taken):
            seen[world.arms.cells(arm)] = True
        peaks = (maximum_filter(world.field, 3) == world.field).ravel() & (world.values > 0.2 * world.values.max())
        shown = np.flatnonzero(seen | peaks)
        levels = np.clip(world.belief.mean / world.values.max(), 0.0, 1.0)[shown]
        return Scene(
            (0.0, 0.0, float(columns), float(rows)), world.place[None, :2], 0.5, world.belief.points[shown], seen[shown],
            ("robot", "in a picture", "hotspot in no picture yet"), levels=levels, notes=(f"{world.place[2]:g} m",),
        )  # fmt: skip


MISSIONS.add("hotspot-identification", HotspotIdentification)
