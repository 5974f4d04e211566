"""A fire that wind drives over a map of cells: when each catches fire, and how intensely it burns."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from ..generators import Draw
from ..number_arrays import Flags as Flags, Floats as Floats, Integers as Integers

if TYPE_CHECKING:
    from scipy import sparse


ROUND = tuple((dx, dy) for dx in (-2, -1, 0, 1, 2) for dy in (-2, -1, 0, 1, 2) if math.gcd(dx, dy) == 1)
"""The sixteen directions in which fire spreads from a cell."""


@dataclass(frozen=True, eq=False)
class Fire:
    """Rasters of shape (rows, columns): the step at which each cell catches fire (``inf``: never), and how intensely it burns then.

    Raises InputError if they differ in shape, or hold what is no time or intensity.
    """

    arrival: Floats
    intensity: Floats

    def __post_init__(self) -> None:
        if self.arrival.ndim != 2 or self.arrival.shape != self.intensity.shape or min(self.arrival.shape) < 2:
            shapes = f"{self.arrival.shape} and {self.intensity.shape}"
            raise InputError(
                "arrival times and intensities are no two rasters alike", "malformed", expected="two of rows x columns", found=shapes
            )
        if np.isnan(self.arrival).any() or not (np.isfinite(self.intensity) & (self.intensity >= 0)).all():
            raise InputError(
                "a raster holds what is no time, or no intensity", "out-of-range", expected="times, and intensities of 0 or more"
            )

    def front(self, time: float) -> Flags:
        """Burning cells with one beside them that does not burn yet; shape (rows, columns)."""
        from scipy import ndimage

        burnt = self.arrival <= time
        return np.asarray(burnt & ~ndimage.binary_erosion(burnt, border_value=1))


@lru_cache(maxsize=8)
def grid_moves(rows: int, columns: int, offsets: tuple[tuple[int, int], ...]) -> tuple[Integers, Integers, Floats]:
    """Moves between cells, numbered row by row: tails in ascending order, heads, and the displacement (columns, rows) of each."""
    row, column = np.divmod(np.arange(rows * columns), columns)
    steps = np.array(offsets)
    to_row, to_column = row[:, None] + steps[:, 1], column[:, None] + steps[:, 0]
    tail, which = np.nonzero((to_row >= 0) & (to_row < rows) & (to_column >= 0) & (to_column < columns))
    return tail, to_row[tail, which] * columns + to_column[tail, which], steps[which].astype(np.float64)


def move_graph(rows: int, columns: int, tail: Integers, head: Integers, weights: Floats) -> "sparse.csr_matrix":
    """The moves of ``grid_moves`` with their weights, as ``scipy.sparse.csgraph`` takes them."""
    from scipy import sparse

    count = rows * columns
    return sparse.csr_matrix((weights, head, np.searchsorted(tail, np.arange(count + 1))), shape=(count, count))


def spreading_fire(
    rng: np.random.Generator, size: int, spread: float, elongation: float, roughness: float, patch: float
) -> tuple[Fire, Floats]:
    """A fire driven by wind, and the wind's direction, a unit vector.

    From every cell it spreads as an ellipse with the cell in its rear focus: fastest with the wind, by ``spread`` cells a step times the
    cell's fuel, and (1 + e) / (1 - e) times slower against it, e being the eccentricity ``elongation`` (0: no wind). The fuel is lognormal:
    the exponential of noise of deviation ``roughness``, smooth over ``patch`` cells. Arrival times are shortest paths over sixteen
    directions. The intensity is that of Byram (1959) up to a constant: fuel times the rate of spread of the move that brought the fire.
    """
    from scipy import ndimage
    from scipy.sparse import csgraph

    angle = 2.0 * math.pi * float(rng.random())
    wind = np.array([math.cos(angle), math.sin(angle)])
    noise = ndimage.gaussian_filter(Draw(rng).normal(0.0, 1.0, size * size).reshape(size, size), patch)
    fuel = np.exp(roughness * (noise - noise.mean()) / max(float(noise.std()), 1e-300)).ravel()
    tail, head, way = grid_moves(size, size, ROUND)
    length = np.hypot(*way.T)
    rate = spread * (1.0 - elongation) / (1.0 - elongation * (way @ wind) / length) * (fuel[tail] + fuel[head]) / 2.0
    origin = np.rint((size - 1) * (0.5 - 0.25 * wind * (elongation > 0))).astype(int)
    graph = move_graph(size, size, tail, head, length / rate)
    arrival, before = csgraph.dijkstra(graph, indices=int(origin[1] * size + origin[0]), return_predecessors=True)
    rates = move_graph(size, size, tail, head, rate)
    cells = np.arange(size * size)
    reached = before >= 0
    intensity = np.zeros(size * size)
    intensity[reached] = fuel[reached] * np.asarray(rates[before[reached], cells[reached]]).ravel()
    return Fire(arrival.reshape(size, size), intensity.reshape(size, size)), wind
