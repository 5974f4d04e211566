"""Places from which an aerial robot takes pictures of a field, and the cells that are in them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..number_arrays import Floats


@dataclass(frozen=True, eq=False)
class Layer:
    """The arms of one altitude: numbers ``first`` and up, as many as ``cells`` has rows.

    ``cells``, shape (arms, cells), are those in the footprint of each arm, a square of ``side`` cells; ``noise`` is the variance of a
    measurement from there.
    """

    altitude: float
    side: int
    first: int
    cells: NDArray[np.intp]
    noise: float

    @property
    def arms(self) -> slice:
        return slice(self.first, self.first + len(self.cells))


class Arms:
    """All places from which pictures are taken: at each altitude one above each square of cells that is as large as the footprint there.

    ``shape``: rows and columns of cells of 1 m. ``altitudes``, m. ``view``: side of a footprint for each metre of altitude, m; footprints
    are rounded to whole cells. ``noise``: variance of a measurement for each metre of altitude. ``places`` has the shape (arms, 3), m.
    Raises InputError if there is no altitude, one is given twice, or a footprint is larger than the field.

    Source: Sung (2019), sections 5.3 and 5.4.
    """

    def __init__(self, shape: tuple[int, int], altitudes: Sequence[float], view: float, noise: float) -> None:
        if not altitudes:
            raise InputError("there is no altitude to take pictures from", "missing", expected="one at least")
        if len(set(altitudes)) < len(altitudes) or not all(0.0 < height < math.inf for height in altitudes):
            said = ", ".join(f"{height:g}" for height in altitudes)
            raise InputError("altitudes must be positive, finite, and given once each", "out-of-range", found=said)
        if not 0.0 < noise < math.inf:
            raise InputError("the noise of a measurement must be positive and finite", "out-of-range", found=f"{noise:g}")
        self.shape = rows, columns = shape
        numbers = np.arange(rows * columns).reshape(rows, columns)
        layers, places, first = [], [], 0
        for height in sorted(altitudes):
            side = max(1, round(view * height))
            if side > min(shape):
                message = f"a picture from {height:g} m is larger than the field"
                raise InputError(message, "out-of-range", expected=f"at most {rows} x {columns} cells", found=f"{side} x {side}")
            cells = np.lib.stride_tricks.sliding_window_view(numbers, (side, side))
            y, x = np.mgrid[: cells.shape[0], : cells.shape[1]] + side / 2.0
            places.append(np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height)]))
            layers.append(Layer(height, side, first, cells.reshape(-1, side * side), noise * height))
            first += x.size
        self.places: Floats = np.vstack(places)
        self.layers = tuple(layers)

    def __len__(self) -> int:
        return len(self.places)

    def layer(self, arm: int) -> Layer:
        return next(layer for layer in self.layers if arm < layer.arms.stop)

    def cells(self, arm: int) -> NDArray[np.intp]:
        """The indices of the cells in the footprint of an arm."""
        layer = self.layer(arm)
        return np.asarray(layer.cells[arm - layer.first])

    def sums(self, values: Floats) -> Floats:
        """Sums of a value per cell over each footprint; shape (arms,)."""
        return np.concatenate([values[layer.cells].sum(axis=1) for layer in self.layers])

    def means(self, values: Floats) -> Floats:
        """Means of a value per cell over each footprint; shape (arms,)."""
        return np.concatenate([values[layer.cells].mean(axis=1) for layer in self.layers])
