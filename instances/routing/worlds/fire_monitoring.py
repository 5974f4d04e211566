"""A fire front that spreads over a map, its hotspots with their identities, and an aircraft that keeps returning to them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from ...errors import InputError
from ...worlds import WORLDS, Setting, World, WorldKind, setting_values
from ..spreading_fire import Fire, Flags, Floats, Integers, spreading_fire

CLOSE = 1e-9
"""Share of the map's size up to which two places are one: positions are sums of steps."""


@dataclass(frozen=True, eq=False)
class Hotspots:
    """Targets on the front: ``ids``, ``places`` of shape (hotspots, 2), in steps ``waits`` since each was tracked, and the ``worst``."""

    ids: Integers = field(default_factory=lambda: np.zeros(0, np.int64))
    places: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    waits: Floats = field(default_factory=lambda: np.zeros(0))
    worst: Floats = field(default_factory=lambda: np.zeros(0))

    def __len__(self) -> int:
        return len(self.ids)

    def aged(self, tracked: Flags) -> "Hotspots":
        """A step later: waits grow, the worst with them, and then those ``tracked`` begin anew. A wait that a visit ends counts in full."""
        waits = self.waits + 1.0
        return Hotspots(self.ids, self.places, np.where(tracked, 0.0, waits), np.maximum(self.worst, waits))

    def moved(self, centres: Floats, within: float, next_id: int) -> "Hotspots":
        """New centres with the identity of the nearest hotspot closer than ``within``, each given once, near ones first; others are new."""
        apart = np.sqrt(((centres[:, None, :] - self.places[None, :, :]) ** 2).sum(axis=2))
        source = np.full(len(centres), -1)
        for flat in np.argsort(apart, axis=None, kind="stable").tolist():
            new, old = divmod(flat, len(self))
            if apart[new, old] >= within:
                break
            if source[new] < 0 and old not in source:
                source[new] = old
        fresh = source < 0
        ids = np.where(fresh, next_id - 1 + np.cumsum(fresh), self.ids[source] if len(self) else 0)
        waits, worst = (np.where(fresh, 0.0, own[source] if len(self) else 0.0) for own in (self.waits, self.worst))
        return Hotspots(ids, centres, waits, worst)

    def sorted(self) -> "Hotspots":
        """In the order of their identities."""
        order = np.argsort(self.ids)
        return Hotspots(*(getattr(self, own.name)[order] for own in fields(self)))


def number_of_clusters(points: int) -> int:
    """The square root of half the ``points``, rounded, half up; 1 at least where there are any. Source: Skeele (2016), (3.2)."""
    return max(1, math.floor(math.sqrt(points / 2.0) + 0.5)) if points else 0


def cluster_centres(points: Floats, count: int, seeds: Floats) -> Floats:
    """Centres of ``count`` clusters by Lloyd's k-means; shape (at most ``count``, 2).

    It begins at the first of ``seeds``, then at the point farthest from all beginnings, again and again.
    """
    from scipy.cluster.vq import vq

    begun = [*seeds[:count]] or [points[0]]
    while len(begun) < count:
        begun.append(points[int(((points[:, None, :] - np.array(begun)) ** 2).sum(axis=2).min(axis=1).argmax())])
    centres, before = np.array(begun), None
    while True:
        label = vq(points, centres)[0]
        if before is not None and (label == before).all():
            return centres
        sizes = np.bincount(label, minlength=len(centres))
        sums = np.stack([np.bincount(label, own, len(centres)) for own in points.T], axis=1)
        kept = sizes > 0  # a centre that no point is nearest to has none to stand for
        centres, before = sums[kept] / sizes[kept, None], (np.cumsum(kept) - 1)[label]


@dataclass(frozen=True, eq=False)
class FireObservation:
    """Knowledge of the aircraft: the fire so far, the hotspots, and where the aircraft is."""

    time: int
    place: Floats
    speed: float
    hotspots: Hotspots
    burnt: Flags
    front: Floats


@dataclass(frozen=True)
class HotspotRules:
    """How a front becomes hotspots: the settings of the same names and ranges, ``within`` and ``radius`` in cells."""

    threshold: float = 0.25
    normalised: str = "front"
    hotspots: int | None = None
    seeding: str = "previous"
    within: float = 6.0
    radius: float = 4.0
    keep_dead: bool = False

    def __post_init__(self) -> None:
        setting_values("fire-monitoring", WORLDS["fire-monitoring"].settings, vars(self))


class FireWorld(World):
    """One aircraft over a fire. In a step it flies straight, at most ``speed`` cells; then the fire spreads, and hotspots are found.

    ``start`` is a place (column, row) on the map, ``begin`` the step of the fire at which it comes; ``still`` keeps the front as it is
    then. The fire takes no notice of the aircraft. Raises InputError if there is no front then, or ``start`` is not on the map.

    Source: Skeele (2016), sections 3.2 and 3.3; docs/missions/fire-monitoring.md.
    """

    def __init__(
        self, fire: Fire, start: tuple[float, float], speed: float = 2.0, begin: int = 60, still: bool = False,
        rules: HotspotRules | None = None,
    ) -> None:  # fmt: skip
        self.fire, self.speed, self.begin, self.still, self.rules = fire, speed, begin, still, rules or HotspotRules()
        self.size = np.array(fire.arrival.shape[::-1], dtype=np.float64) - 1.0
        self.place = self._on_map(start, "the aircraft starts")
        if not 0 < speed < math.inf:
            raise InputError("the aircraft does not move", "out-of-range", expected="a finite speed above 0", found=f"{speed:g}")
        if not fire.front(begin).any():
            what = "no cell burns" if not (fire.arrival <= begin).any() else "all cells burn: none is free"
            raise InputError(f"there is no front at step {begin}: {what}", "contradiction", expected="burning cells beside free ones")
        self.time, self.flown, self.over_fire = 0, 0.0, 0
        self.hotspots, self.dead, self._ids = Hotspots(), 0.0, 0
        self._look()

    def observe(self) -> FireObservation:
        return self._observation

    def step(self, actions: Mapping[int, Any]) -> None:
        """Fly to the place that ``actions`` gives aircraft 0, a pair (column, row); none: stay."""
        for robot in actions:
            if robot != 0:
                raise InputError("there is no such aircraft", "unknown-name", expected="0", found=str(robot)[:40])
        to = self._on_map(actions.get(0, self.place), "the aircraft is sent")
        length = float(np.hypot(*(to - self.place)))
        if length > self.speed + CLOSE * self.size.max():
            raise InputError("the aircraft is sent too far", "out-of-range", expected=f"at most {self.speed:g} cells", found=f"{length:g}")
        self.place, self.time, self.flown = to, self.time + 1, self.flown + length
        self._look()
        self.over_fire += int(self._observation.burnt[tuple(np.rint(to[::-1]).astype(int))])

    @property
    def over(self) -> bool:
        """True once nothing is left that could burn, or the front has left the map."""
        return not len(self._observation.front)

    @property
    def worst_waits(self) -> float:
        """J: the sum over hotspots of the longest that each has waited so far, those gone included if they are to be kept (3.1)."""
        return float(self.hotspots.worst.sum()) + self.dead * self.rules.keep_dead

    def metrics(self) -> dict[str, float]:
        """``worst_waits``: J; ``hotspots``; ``tracked``: of them, now; ``mean_wait``: of them, steps; ``found``: so far; ``flown``: cells;
        ``over_fire``: steps that ended over burning or burnt ground; ``burnt``: share of the map."""
        spots = self.hotspots
        return {
            "worst_waits": self.worst_waits, "hotspots": float(len(spots)), "tracked": float(self.tracked.sum()),
            "mean_wait": float(spots.waits.mean()) if len(spots) else 0.0, "found": float(self._ids), "flown": self.flown,
            "over_fire": float(self.over_fire), "burnt": float(self._observation.burnt.mean()),
        }  # fmt: skip

    @property
    def tracked(self) -> Flags:
        """Which hotspots are within the radius of the aircraft."""
        return np.asarray(np.hypot(*(self.hotspots.places - self.place).T) <= self.rules.radius + CLOSE * self.size.max())

    def hot_points(self) -> Floats:
        """Front cells that burn intensely enough, as (column, row); shape (points, 2)."""
        front = self.fire.front(self._now)
        intensity = np.where(front, self.fire.intensity, 0.0)
        top = intensity.max() if self.rules.normalised == "front" else self.fire.intensity.max()
        return np.argwhere(intensity > self.rules.threshold * top)[:, ::-1].astype(np.float64)

    @property
    def _now(self) -> int:
        return self.begin + (0 if self.still else self.time)

    def _look(self) -> None:
        before = self.hotspots
        if not self.still or not self.time:
            points = self.hot_points()
            count = number_of_clusters(len(points)) if self.rules.hotspots is None else min(self.rules.hotspots, len(points))
            seeds = before.places if self.rules.seeding == "previous" else np.zeros((0, 2))
            centres = cluster_centres(points, count, seeds) if count else np.zeros((0, 2))
            self.hotspots = before.moved(centres, self.rules.within, self._ids).sorted()
            self._ids = max(self._ids, int(self.hotspots.ids.max(initial=-1)) + 1)
            self.dead += float(before.worst[~np.isin(before.ids, self.hotspots.ids)].sum())
        old = np.isin(self.hotspots.ids, before.ids)
        aged = self.hotspots.aged(self.tracked)  # new ones have waited for nothing yet
        self.hotspots = Hotspots(aged.ids, aged.places, old * aged.waits, old * aged.worst)
        burnt = self.fire.arrival <= self._now
        front = np.argwhere(self.fire.front(self._now))[:, ::-1].astype(np.float64)
        self._observation = FireObservation(self.time, self.place, self.speed, self.hotspots, burnt, front)

    def _on_map(self, given: Any, what: str) -> Floats:
        try:
            place = np.array(given, dtype=np.float64)
        except (TypeError, ValueError):
            place = np.full(1, np.nan)
        if place.shape != (2,) or not (np.isfinite(place) & (place >= 0) & (place <= self.size)).all():
            raise InputError(
                f"{what} off the map", "out-of-range", expected=f"(0, 0) to {tuple(self.size.tolist())}", found=str(given)[:60]
            )
        return place


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> FireWorld:
    size = values["size"]
    fire, wind = spreading_fire(rng, size, *(values[key] for key in ("spread", "elongation", "roughness", "patch")))
    start = np.clip((size - 1) * (0.5 - 0.5 * wind), 0.0, size - 1.0)
    rules = HotspotRules(**{own.name: values[own.name.replace("_", "-")] for own in fields(HotspotRules)})
    return FireWorld(fire, (float(start[0]), float(start[1])), values["speed"], values["begin"], values["still"], rules)


WORLDS.enter(
    WorldKind(
        "fire-monitoring", "a fire front spreads over a map, and an aircraft keeps returning to its hotspots",
        {
            "size": Setting(80, "rows and columns of the map", int, 8, 1000),
            "spread": Setting(0.25, "rate of spread with the wind, cells a step, where the fuel is 1", float, 1e-3, 1e3),
            "elongation": Setting(0.8, "eccentricity of the ellipse in which the fire spreads; 0: no wind", float, 0.0, 0.99),
            "roughness": Setting(0.3, "deviation of the logarithm of the fuel", float, 0.0, 3.0),
            "patch": Setting(4.0, "cells over which the fuel is alike", float, 0.1, 100.0),
            "begin": Setting(60, "step of the fire at which the aircraft comes", int, 1, 10**6),
            "still": Setting(False, "the front stays as it is then", bool),
            "speed": Setting(2.0, "of the aircraft, cells a step", float, 1e-3, 1e3),
            "threshold": Setting(0.25, "share of the largest intensity above which the front is hot: beta", float, 0.0, 0.999),
            "normalised": Setting("front", "largest intensity of the present front, or of the whole map", choices=("front", "map")),
            "hotspots": Setting(None, "number of clusters; the root of half the hot cells if none", int, 1, 1000),
            "seeding": Setting("previous", "k-means begins at the last hotspots, or at points far apart", choices=("previous", "spread")),
            "within": Setting(6.0, "cells: a hotspot keeps its identity if it moves less than this: delta", float, 0.0, 1e6),
            "radius": Setting(4.0, "cells: a hotspot this near to the aircraft is tracked", float, 0.0, 1e6),
            "keep-dead": Setting(False, "hotspots that have vanished stay in the objective", bool),
        },
        _make,
    ),
)  # fmt: skip
