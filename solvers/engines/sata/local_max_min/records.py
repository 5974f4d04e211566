"""The arrays that the compiled loops of the local algorithm work on, by name."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .cleaning import Floats, Indices

DEEPEST = 1024.0
"""Red copies count as no further below 0 than this, in parts of the cap: a level at which one is negative is not valid, however much."""


class Scratch(NamedTuple):
    """Working arrays of ``level_kernels.sweep``; rows of eight doubles start at cache lines."""

    reds: Floats
    least: Floats
    room: Floats
    next_room: Floats
    near: Floats
    next_near: Floats
    blues: Floats
    below: Floats


class Sight(NamedTuple):
    """Robots that see each target, one entry an edge."""

    starts: NDArray[np.int64]
    robots: Indices


class Lists(NamedTuple):
    """Robots and targets within reach of some roots; ``distance`` is -1 elsewhere."""

    distance: Indices
    marked: NDArray[np.bool_]
    robots: Indices
    targets: Indices
