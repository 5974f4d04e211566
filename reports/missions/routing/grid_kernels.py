"""Steps over a grid from one cell, compiled. Imports numba: import it inside functions only."""

import numpy as np

from ....formulations.kernels import kernel

FAR = np.int64(1) << 40


@kernel("(read(b1[::1]), i8, i8)")
def steps_from(passable, start, width):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Steps from ``start`` to each cell through ``passable`` ones, ``FAR`` where there is no way. No cell at the border is passable."""
    steps, queue = np.full(passable.size, FAR), np.empty(passable.size, np.int64)
    steps[start], queue[0] = 0, start
    first, last = 0, 1
    while first < last:
        cell = queue[first]
        first += 1
        for k in range(4):
            near = cell + (1 if k == 0 else -1 if k == 1 else width if k == 2 else -width)
            if passable[near] and steps[near] == FAR:
                steps[near] = steps[cell] + 1
                queue[last] = near
                last += 1
    return steps
