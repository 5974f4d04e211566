"""Truth about a grid of cells: obstacles, cells that change, and lanes between blocks."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..generators import Draw, Flags, Floats

EDGE = 2.0
"""Edge of a cell, m."""

BLOCK = 4
"""Edge of a block in cells where there are no lanes."""


@dataclass(frozen=True)
class Terrain:
    """Truth about a grid, arrays of shape (rows, columns).

    ``occupied`` cells always are, ``known`` ones are known to stay free. Cells with a finite ``period``, s, are free for half of it, then
    occupied; ``phase`` says how many seconds into it they begin.
    """

    occupied: Flags
    known: Flags
    period: Floats
    phase: Floats

    def at(self, clock: float) -> Flags:
        """Cells that are occupied at a moment, s."""
        change = np.isfinite(self.period)
        length = np.where(change, self.period, 1.0)
        return self.occupied | change & ((clock + self.phase) % length >= length / 2.0)


def middle_of(values: Mapping[str, Any]) -> tuple[int, int]:
    """The cell in the middle of the grid, on a crossing of lanes where there are any."""
    side = values["lanes"] or 1
    return values["rows"] // 2 // side * side, values["columns"] // 2 // side * side


def made_terrain(rng: np.random.Generator, values: Mapping[str, Any]) -> Terrain:
    """Blocks between lanes, each of walls, of cells that change, or free."""
    draw, shape, lanes = Draw(rng), (values["rows"], values["columns"]), values["lanes"]
    row, column = np.indices(shape)
    middle = middle_of(values)
    known = np.hypot(row - middle[0], column - middle[1]) * EDGE <= values["safe"]
    if lanes:
        known |= (row % lanes == 0) | (column % lanes == 0)
    side = lanes or BLOCK
    block = row // side * (shape[1] // side + 1) + column // side
    kind = draw.uniform(0, 1, block.max() + 1)[block]
    wall, dynamic = kind < values["walls"], (kind >= values["walls"]) & (kind < values["walls"] + values["dynamic"])
    alike = block if values["phases"] == "clustered" else np.arange(row.size).reshape(shape)
    period = draw.uniform(values["shortest"], values["longest"], row.size)[alike]
    phase = draw.uniform(0, 1, row.size)[alike] * period
    return Terrain(wall & ~known, known, np.where(dynamic & ~known, period, np.inf), phase)
