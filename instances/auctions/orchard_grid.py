"""An orchard's lanes: cells, distances and travel times."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..number_arrays import Integers

MOST_CELLS = 2500
"""Distances of all pairs are held."""


@dataclass(frozen=True)
class OrchardGrid:
    """Lanes side by side, open to a headland at each end: along a lane everywhere, from lane to lane in the headlands alone.

    Cells are numbered by rows, ``row * columns + column``; the first and last columns are headlands, the others are harvested. The
    repository is the row of the collection point, in the first column. Speeds are cells a step, without a full bin and with one; a leg
    takes whole steps, rounded up.

    Source: Zhang (2015), section 3.2; docs/formulations/orchard-day.md#the-orchard.
    """

    rows: int
    columns: int
    repository: int = 0
    empty_speed: int = 2
    full_speed: int = 1

    def __post_init__(self) -> None:
        for name, least in (("rows", 1), ("columns", 3), ("empty_speed", 1), ("full_speed", 1)):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or value < least:
                raise InputError(f"an orchard's {name} must be a whole number of at least {least}", "out-of-range", found=str(value)[:40])
        if self.rows * self.columns > MOST_CELLS:
            raise InputError(f"an orchard has at most {MOST_CELLS} cells", "too-large", found=f"{self.rows} x {self.columns}")
        if isinstance(self.repository, bool) or not isinstance(self.repository, int) or not 0 <= self.repository < self.rows:
            raise InputError(
                "the repository must lie in a row", "out-of-range", expected=f"0 to {self.rows - 1}", found=str(self.repository)[:40]
            )

    @property
    def home(self) -> int:
        """The repository's cell."""
        return self.repository * self.columns

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.rows * self.columns

    @cached_property
    def harvested(self) -> Integers:
        """Cells with trees, ascending."""
        cells = np.arange(self.size)
        return np.asarray(cells[(cells % self.columns > 0) & (cells % self.columns < self.columns - 1)])

    @cached_property
    def distances(self) -> Integers:
        """Steps from cell to cell of a shortest way, shape (size, size)."""
        row, column = np.divmod(np.arange(self.size), self.columns)
        together = column[:, None] + column[None, :]
        around = np.minimum(together, 2 * (self.columns - 1) - together) + np.abs(row[:, None] - row[None, :])
        return np.asarray(np.where(row[:, None] == row[None, :], np.abs(column[:, None] - column[None, :]), around))

    @cached_property
    def empty_times(self) -> Integers:
        """Steps of a leg without a full bin, shape (size, size)."""
        return np.asarray(-(-self.distances // self.empty_speed))

    @cached_property
    def full_times(self) -> Integers:
        """Steps of a leg with one, shape (size, size)."""
        return np.asarray(-(-self.distances // self.full_speed))

    def cell(self, row: int, column: int) -> int:
        """The index of a cell."""
        if not (0 <= row < self.rows and 0 <= column < self.columns):
            raise InputError(
                f"cell ({row}, {column}) lies outside", "out-of-range", expected=f"rows to {self.rows - 1}, columns to {self.columns - 1}"
            )
        return row * self.columns + column

    def cells(self, places: ArrayLike) -> Integers:
        """The indices of cells, given as an array of (row, column)."""
        return np.array([self.cell(int(row), int(column)) for row, column in np.asarray(places).reshape(-1, 2)], dtype=np.int64)

    def name(self, cell: int) -> str:
        """``row,column``."""
        row, column = divmod(int(cell), self.columns)
        return f"{row},{column}"

    def along(self, start: int, end: int, length: float) -> tuple[float, float]:
        """Row and column after ``length`` cells of a shortest way."""
        (r1, c1), (r2, c2) = divmod(int(start), self.columns), divmod(int(end), self.columns)
        if r1 == r2:
            return float(r1), c1 + float(np.clip(c2 - c1, -length, length))
        side = 0 if c1 + c2 <= 2 * (self.columns - 1) - c1 - c2 else self.columns - 1
        out, across = abs(side - c1), abs(r2 - r1)
        if length <= out:
            return float(r1), c1 + float(np.clip(side - c1, -length, length))
        if length <= out + across:
            return r1 + float(np.clip(r2 - r1, out - length, length - out)), float(side)
        rest = length - out - across
        return float(r2), side + float(np.clip(c2 - side, -rest, rest))
