"""How far a robot may go out of contact: at most so many steps in a row, then it has to be heard again."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....instances.errors import InputError

Integers = NDArray[np.int64]


def steps_to_contact(adjacent: ArrayLike, contact: ArrayLike) -> Integers:
    """Fewest moves from each room to one with contact, shape (rooms,); -1 where there is no way.

    Parameters
    ----------
    adjacent : array of shape (rooms, rooms)
        Whether one move leads from a room to another.
    contact : array of shape (rooms,)
        Whether a robot there is heard.
    """
    moves, near = np.asarray(adjacent, dtype=bool), np.asarray(contact, dtype=bool)
    if moves.ndim != 2 or moves.shape != (len(near),) * 2:
        raise InputError("there must be one row and column of moves a room, and one flag of contact", found=f"{moves.shape}, {near.shape}")
    steps = np.where(near, 0, -1)
    reached, count = near, 0
    while True:
        more = moves[:, reached].any(axis=1) & (steps < 0)
        if not more.any():
            return np.asarray(steps, dtype=np.int64)
        count += 1
        steps[more] = count
        reached = more


def allowed(silent: int, to_contact: int, longest: int) -> bool:
    """Whether contact can be regained in time.

    Parameters
    ----------
    silent : int
        Steps without contact so far, that of the action in question included.
    to_contact : int
        Moves from there to a room with contact, as of ``steps_to_contact``.
    longest : int
        Steps in a row that a robot may be out of contact; 0 asks for contact always.

    Notes
    -----
    The last move ends in contact. Source: Zhang (2015), section 5.3.6; docs/formulations/task-allocation.md#exploration.
    """
    if longest < 0:
        raise InputError("the steps out of contact must be at least 0", found=str(longest))
    return to_contact >= 0 and silent + to_contact - 1 <= longest if to_contact else True
