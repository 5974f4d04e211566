"""Occupancy grids: free cells as states, moves between neighbours, and what the place of a cell says of its risk.

Source: Xiao (2019), section 3.3.1, which leaves open how quantities become probabilities; docs/formulations/risky-path.md#risk-elements.
"""

import itertools
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..number_arrays import Flags, Floats, Integers as Indices, reals
from .obstacles import merged_boxes

CONNECTIVITIES = {4: (2, 1), 8: (2, 2), 6: (3, 1), 26: (3, 3)}
"""Dimensions of the map, and coordinates in which neighbours may differ, for each number of neighbours."""


def faded(values: ArrayLike, low: float, high: float, most: float) -> Floats:
    """Risks that fade from ``most`` at ``low`` to 0 at ``high``: the falling side of a trapezoid."""
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise InputError("risks fade from a smaller to a larger value", "contradiction", found=f"{low:g} to {high:g}")
    if not 0.0 <= most <= 1.0:
        raise InputError("a risk must lie in [0, 1]", "out-of-range", found=f"{most:g}")
    return np.asarray(most * np.clip((high - np.asarray(values, dtype=np.float64)) / (high - low), 0.0, 1.0))


def classed(values: ArrayLike, granular: float, restricted: float, habitable: float = 0.0) -> Floats:
    """Risks by class of ``OccupancyGrid.scale``: up to 1, up to 2, beyond."""
    v = np.asarray(values, dtype=np.float64)
    return np.where(v <= 1.0, granular, np.where(v <= 2.0, restricted, habitable))


def elevation(reel: ArrayLike, positions: ArrayLike) -> Floats:
    """Degrees above the horizon at which a reel sees each position, of which the last coordinate is the height; 90 is the singularity."""
    way = np.asarray(positions, dtype=np.float64) - np.asarray(reel, dtype=np.float64)
    return np.asarray(np.degrees(np.arctan2(way[:, -1], np.linalg.norm(way[:, :-1], axis=1))), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class OccupancyGrid:
    """Cells of a map, free or occupied.

    ``occupied`` has the shape (rows, columns) or (layers, rows, columns). ``cell``: side of a cell. The centre of cell (row, column) lies
    at ``((column + 1/2) cell, (row + 1/2) cell)``.
    """

    occupied: Flags
    cell: float = 1.0

    def __post_init__(self) -> None:
        grid = np.asarray(self.occupied, dtype=bool)
        if grid.ndim not in (2, 3) or not grid.size:
            raise InputError("a map must have rows and columns, or layers of them", "wrong-shape", found=f"shape {grid.shape}")
        if not 0.0 < self.cell < math.inf:
            raise InputError("the side of a cell must be positive", "out-of-range", found=str(self.cell))
        object.__setattr__(self, "occupied", grid)

    @cached_property
    def cells(self) -> Indices:
        """Free cells, one a state: shape (states, dimensions)."""
        return np.argwhere(~self.occupied)

    @cached_property
    def number(self) -> Indices:
        """State of each cell, -1 where it is occupied."""
        numbers = np.full(self.occupied.shape, -1)
        numbers[tuple(self.cells.T)] = np.arange(len(self.cells))
        return numbers

    @property
    def positions(self) -> Floats:
        """Centres of the free cells: shape (states, dimensions), x first."""
        return np.asarray((self.cells[:, ::-1] + 0.5) * self.cell, dtype=np.float64)

    @property
    def names(self) -> tuple[str, ...]:
        """``row,column`` of each state, counted from 0."""
        return tuple(",".join(map(str, cell)) for cell in self.cells.tolist())

    @property
    def boxes(self) -> Floats:
        """Occupied cells of a map in the plane as boxes, joined where they can be."""
        return merged_boxes(self.occupied, self.cell)

    def arcs(self, connectivity: int) -> tuple[Indices, Indices]:
        """Moves between free neighbours: 4 or 8 in the plane, 6 or 26 in space."""
        dimensions, most = CONNECTIVITIES.get(connectivity, (0, 0))
        if dimensions != self.occupied.ndim:
            known = ", ".join(str(c) for c, (d, _) in CONNECTIVITIES.items() if d == self.occupied.ndim)
            raise InputError("cells of this map have no such number of neighbours", "out-of-range", expected=known, found=str(connectivity))
        tails, heads = [], []
        for step in itertools.product((-1, 0, 1), repeat=dimensions):
            if 0 < sum(map(abs, step)) <= most:
                near = self.cells + np.array(step)
                inside = ((near >= 0) & (near < self.occupied.shape)).all(axis=1)
                head = np.full(len(near), -1)
                head[inside] = self.number[tuple(near[inside].T)]
                tails.append(np.nonzero(head >= 0)[0])
                heads.append(head[head >= 0])
        return np.concatenate(tails), np.concatenate(heads)

    def clearance(self, *, edges: bool = False) -> Floats:
        """Distance of each state to the centre of the closest occupied cell, beyond the map too if ``edges``: shape (states,)."""
        from scipy.ndimage import distance_transform_edt

        free = ~np.pad(self.occupied, 1, constant_values=True) if edges else ~self.occupied
        if free.all():
            return np.full(len(self.cells), math.inf)
        with np.errstate(over="ignore"):
            far = np.asarray(distance_transform_edt(free, sampling=self.cell))
        return np.asarray(far[tuple((self.cells + int(edges)).T)])

    def scale(self, size: float) -> Floats:
        """Width of the narrowest way through each state along an axis, in sizes of the vehicle: shape (states,).

        Up to 1 it is granular, up to 2 restricted, beyond habitable.
        """
        if not 0.0 < size < math.inf:
            raise InputError("the size of the vehicle must be positive", "out-of-range", found=str(size))
        least = np.full(self.occupied.shape, math.inf)
        for axis in range(self.occupied.ndim):
            grid = np.moveaxis(self.occupied, axis, -1)
            at = np.arange(grid.shape[-1])
            below = np.maximum.accumulate(np.where(grid, at, -1), axis=-1)
            above = np.flip(np.minimum.accumulate(np.flip(np.where(grid, at, grid.shape[-1]), -1), axis=-1), -1)
            least = np.minimum(least, np.moveaxis(above - below - 1, -1, axis))
        return np.asarray(least[tuple(self.cells.T)] * self.cell / size)

    def visibility(self, rays: int = 16) -> Floats:
        """Mean length of ``rays`` isovists of each state of a map in the plane, evenly spread from the direction of x: shape (states,)."""
        if self.occupied.ndim != 2:
            raise InputError("isovists are drawn in the plane", "unsupported", found=f"shape {self.occupied.shape}")
        if not 1 <= rays <= 3600:
            raise InputError("there must be 1 to 3600 isovists", "out-of-range", found=str(rays))
        at, boxes = self.positions, self.boxes.reshape(-1, 2, 2)
        end = np.array(self.occupied.shape[::-1]) * self.cell
        total = np.zeros(len(at))
        for angle in np.arange(rays) * (2.0 * math.pi / rays):
            way = np.round([math.cos(angle), math.sin(angle)], 12)
            with np.errstate(divide="ignore", invalid="ignore"):
                length = np.nanmin(np.where(way > 0, (end - at) / way, np.where(way < 0, -at / way, math.inf)), axis=1)
                for box in boxes:
                    sides = (box[None] - at[:, None]) / way
                    inside = (box[0] < at) & (at < box[1])
                    enter = np.where(way == 0, np.where(inside, -math.inf, math.inf), sides.min(axis=1)).max(axis=1)
                    leave = np.where(way == 0, np.where(inside, math.inf, -math.inf), sides.max(axis=1)).min(axis=1)
                    hit = (enter < leave) & (enter >= 0)
                    length[hit] = np.minimum(length[hit], enter[hit])
            total += length
        return total / rays

    def state(self, cell: ArrayLike) -> int:
        """State of a free cell (row, column); raises InputError for any other."""
        at = tuple(int(c) for c in reals("a cell", cell).tolist())
        inside = len(at) == self.occupied.ndim and all(0 <= c < size for c, size in zip(at, self.occupied.shape, strict=True))
        if not inside or self.number[at] < 0:
            raise InputError(f"cell {', '.join(map(str, at))} is {'occupied' if inside else 'not on the map'}", "unknown-name")
        return int(self.number[at])
