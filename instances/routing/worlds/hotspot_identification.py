"""A field with hotspots, and an aerial robot that takes pictures of it from several altitudes while its time lasts."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import InputError
from ...generators import Draw
from ...number_arrays import Floats
from ...text import read_text
from ...worlds import WORLDS, Setting, World, WorldKind
from ..aerial_pictures import Arms
from ..gaussian_process import GaussianProcess, SquaredExponential

MOST_CELLS = 3600
"""Beyond it the covariance of all cells takes hundreds of megabytes."""

LEAST_NOISE = 1e-9
"""Share of the variance of the prior: with less, the factor of all measurements is lost to rounding."""


@dataclass(frozen=True, eq=False)
class HotspotObservation:
    """Knowledge of the robot: its place (x, y, altitude), the time ``left``, arms ``taken`` so far in their order, and what it believes."""

    time: int
    place: Floats
    left: float
    taken: tuple[int, ...]
    arms: Arms
    belief: GaussianProcess
    sensing_time: float

    def needed(self) -> Floats:
        """Time to fly to each arm and take a picture there."""
        return np.asarray(np.sqrt(((self.arms.places - self.place) ** 2).sum(axis=1)) + self.sensing_time)


class HotspotWorld(World):
    """One robot flies at unit speed from arm to arm; a step is a flight and a picture, and one without an order ends the flight.

    A picture gives ``pixels`` x ``pixels`` measurements of the field, evenly spread over its footprint, each with normal noise. Between the
    centres of cells the field is bilinear: ``field`` (rows, columns) has the intensity at the centre of each cell of 1 m, the southernmost
    row first. The robot's belief has the ``kernel``; ``budget`` is the time for all flights and pictures, of which each takes
    ``sensing_time``, and the flight begins at ``start`` (m), at the lowest altitude.

    Raises InputError if the field has a negative or unknown intensity or nothing but 0, or more than 3,600 cells, or is not that of the
    arms; if the noise is lost to rounding beside the prior, the start is not on the field, or the budget does not suffice for one picture.

    Source: Sung (2019), problem 4 and section 5.6.1; docs/missions/hotspot-identification.md.
    """

    def __init__(
        self, field: Floats, arms: Arms, kernel: SquaredExponential, rng: np.random.Generator, budget: float = 100.0,
        sensing_time: float = 1.0, pixels: int = 3, start: tuple[float, float] = (0.0, 0.0),
    ) -> None:  # fmt: skip
        if not np.isfinite(field).all() or field.min() < 0.0 or field.max() <= 0.0:
            raise InputError("a field needs finite intensities of at least 0, and one above", "out-of-range", found=f"{field.min():g}")
        if field.size > MOST_CELLS:
            raise InputError("the field has too many cells", "out-of-range", expected=f"at most {MOST_CELLS}", found=str(field.size))
        if field.shape != arms.shape:
            raise InputError("the arms are those of another field", "wrong-shape", expected=str(field.shape), found=str(arms.shape))
        if not (0.0 <= start[0] <= field.shape[1] and 0.0 <= start[1] <= field.shape[0]):
            raise InputError("the robot starts outside the field", "out-of-range", found=str(start))
        if not (sensing_time > 0.0 and budget < math.inf and pixels >= 1):
            found = f"{sensing_time:g}, {budget:g} and {pixels}"
            raise InputError("a picture must take time, the budget be finite, and a pixel be measured", "out-of-range", found=found)
        least = LEAST_NOISE * kernel.deviation**2
        if arms.layers[0].noise < least:
            message = "the noise is too small beside the deviation of the prior"
            raise InputError(message, "out-of-range", expected=f"at least {least:g}", found=f"{arms.layers[0].noise:g}")
        self.field, self.arms, self.pixels, self.rng = field, arms, pixels, rng
        self.values = field.ravel()
        y, x = np.mgrid[: field.shape[0], : field.shape[1]] + 0.5
        self.belief = GaussianProcess.prior(kernel, np.column_stack([x.ravel(), y.ravel()]))
        self.place = np.array([*start, min(layer.altitude for layer in arms.layers)])
        self.left, self.sensing_time, self.time, self.ended = float(budget), float(sensing_time), 0, False
        self.taken: tuple[int, ...] = ()
        least = float(self.observe().needed().min())
        if budget < least:
            message = "the budget does not suffice for one picture"
            raise InputError(message, "out-of-range", expected=f"at least {least:g}", found=f"{budget:g}")

    def observe(self) -> HotspotObservation:
        return HotspotObservation(self.time, self.place, self.left, self.taken, self.arms, self.belief, self.sensing_time)

    def step(self, actions: Mapping[int, int]) -> None:
        """The robot, number 0, flies to the arm that ``actions`` gives and takes a picture; without an order its flight ends."""
        if set(actions) - {0}:
            raise InputError("there is no such robot", "unknown-name", expected="0", found=str(next(iter(set(actions) - {0})))[:40])
        self.time += not actions
        if not actions:
            self.ended = True
            return
        from scipy.ndimage import map_coordinates

        arm = actions[0]
        if isinstance(arm, bool) or not isinstance(arm, int | np.integer) or not 0 <= arm < len(self.arms):
            raise InputError("the robot is told no arm", expected=f"0 to {len(self.arms) - 1}", found=str(arm)[:40])
        needed = float(self.observe().needed()[arm])
        if self.ended or needed > self.left:
            left = 0.0 if self.ended else self.left
            raise InputError(f"no time is left for arm {arm}", "contradiction", expected=f"at most {left:g}", found=f"{needed:g}")
        self.time += 1
        self.left -= needed
        self.place, self.taken = self.arms.places[arm], (*self.taken, int(arm))
        layer = self.arms.layer(int(arm))
        places = self._pixels(int(arm), layer.side)
        noise = Draw(self.rng).normal(0.0, math.sqrt(layer.noise), len(places))
        # Bilinear between centres of cells and constant beyond.
        seen = map_coordinates(self.field, [places[:, 1] - 0.5, places[:, 0] - 0.5], order=1, mode="nearest")
        self.belief = self.belief.given(places, seen + noise, layer.noise)

    def _pixels(self, arm: int, side: int) -> Floats:
        """Places at which the pixels of a picture are measured; shape (pixels, 2)."""
        steps = side * ((np.arange(self.pixels) + 0.5) / self.pixels - 0.5)
        x, y = np.meshgrid(self.arms.places[arm, 0] + steps, self.arms.places[arm, 1] + steps)
        return np.column_stack([x.ravel(), y.ravel()])

    @property
    def over(self) -> bool:
        """True if the flight has ended, or no time is left for another picture from the same place."""
        return self.ended or self.left < self.sensing_time

    def metrics(self) -> dict[str, float]:
        """``point``: intensity where the largest is believed, in percent of the largest; ``arm``: the same of sums over footprints;
        ``collected``: mean intensities of footprints, summed over the arms taken, each once; ``pictures``; ``left``: time."""
        sums, own = self.arms.sums(self.values), np.array(sorted(set(self.taken)), dtype=np.intp)
        return {
            "point": 100.0 * float(self.values[self.belief.mean.argmax()] / self.values.max()),
            "arm": 100.0 * float(sums[self.arms.sums(self.belief.mean).argmax()] / sums.max()),
            "collected": float(self.arms.means(self.values)[own].sum()), "pictures": float(len(self.taken)), "left": self.left,
        }  # fmt: skip


def bumps(draw: Draw, shape: tuple[int, int], count: int, spread: tuple[float, float], largest: float) -> Floats:
    """``count`` normal bumps of any place, height and spread (within two limits), scaled so that the most intense cell has ``largest``."""
    y, x = np.mgrid[: shape[0], : shape[1]] + 0.5
    centres, spreads = draw.uniform(0.0, 1.0, (count, 2)) * [shape[1], shape[0]], draw.uniform(min(spread), max(spread), count)
    heights, field = draw.uniform(0.2, 1.0, count), np.zeros(shape)
    for (cx, cy), own, height in zip(centres, spreads, heights, strict=True):
        field += height * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2.0 * own**2))
    return np.asarray(field * (largest / field.max()))


def read_field(path: str) -> Floats:
    """A table of intensities, numbers with commas, a line per row of cells, the northernmost first. Raises InputError."""
    rows = read_text(path).split("\n")
    try:
        return np.loadtxt(rows, delimiter=",", ndmin=2, comments=None)[::-1]
    except ValueError as fault:
        raise InputError(f"cannot be read as a table of numbers: {fault}", "file", file=path) from None


def read_altitudes(text: str) -> list[float]:
    """Altitudes as numbers with commas. Raises InputError."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError("altitudes are numbers with commas between them", "malformed", found=text) from None


def _make(rng: np.random.Generator, v: Mapping[str, Any]) -> HotspotWorld:
    if v["file"] is not None:
        field = read_field(v["file"])
    else:
        field = bumps(Draw(rng), (v["size"], v["size"]), v["hotspots"], (v["narrowest"], v["widest"]), v["largest"])
    arms = Arms((field.shape[0], field.shape[1]), read_altitudes(v["altitudes"]), v["view"], v["noise"])
    kernel = SquaredExponential(v["deviation"], v["length-scale"])
    return HotspotWorld(field, arms, kernel, rng, v["budget"], v["sensing-time"], v["pixels"])


WORLDS.enter(
    WorldKind(
        "hotspot-identification", "an aerial robot looks for the most intense place of a field from several altitudes",
        {
            "size": Setting(20, "cells of 1 m along each side of the field", int, 2, 60),
            "hotspots": Setting(8, "bumps of the field", int, 1, 1000),
            "narrowest": Setting(0.5, "least spread of a bump, m", float, 0.1, 1e3),
            "widest": Setting(1.5, "largest spread of a bump, m", float, 0.1, 1e3),
            "largest": Setting(50.0, "intensity of the most intense cell", float, 1e-6, 1e6),
            "file": Setting(None, "the field instead: a table of intensities with commas, the northernmost row first", str),
            "altitudes": Setting("10,40,70", "from which pictures are taken, m"),
            "view": Setting(0.1, "side of a footprint for each metre of altitude, m; rounded to whole cells", float, 1e-6, 1e3),
            "pixels": Setting(3, "measurements along each side of a picture", int, 1, 20),
            "noise": Setting(1.0, "variance of a measurement for each metre of altitude", float, 1e-9, 1e9),
            "budget": Setting(100.0, "time of all flights and pictures; the robot flies 1 m a unit of time", float, 0.0, 1e6),
            "sensing-time": Setting(3.0, "of a picture", float, 1e-3, 1e6),
            "deviation": Setting(10.0, "of the intensity by the belief before the first picture", float, 1e-6, 1e6),
            "length-scale": Setting(1.0, "over which intensities are believed to be alike, m", float, 1e-3, 1e3),
        },
        _make,
    ),
)  # fmt: skip
