"""How much a robot takes at each of its waypoints."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....instances.errors import InputError

Floats = NDArray[np.float64]


def expected_contents(contents: ArrayLike, rates: ArrayLike, steps: float, capacity: float = np.inf) -> Floats:
    """Contents of stores after ``steps``, at most ``capacity``: (4.6) of Zhang (2015), which has no capacity."""
    return np.minimum(np.asarray(contents, dtype=np.float64) + steps * np.asarray(rates, dtype=np.float64), capacity)


def reward_split(available: ArrayLike, room: float) -> Floats:
    """A robot's room shared out in proportion to what is available at each waypoint, and no more than that anywhere.

    Source: Zhang (2015), (4.7), whose shares always come to the whole room; docs/formulations/balanced-partition.md#reward-split.
    """
    held = np.asarray(available, dtype=np.float64)
    if held.ndim != 1 or not (held >= 0).all() or not np.isfinite(held).all() or not room >= 0:
        raise InputError("what is available, and the room of the robot, must be numbers from 0 on", found=str(available)[:60])
    return water_filled(held, held, room)


def water_filled(weights: Floats, caps: Floats, total: float) -> Floats:
    """Shares of ``total`` in proportion to ``weights``, each at most its cap: what a cap cuts off is shared out among the others."""
    shares, rest, open_ = np.zeros(len(weights)), float(total), (weights > 0) & (caps > 0)
    while rest > 0 and open_.any():
        part = np.where(open_, weights / weights[open_].sum() * rest, 0.0)
        full = open_ & (part >= caps)
        if not full.any():
            return np.where(open_, part, shares)
        shares[full] = caps[full]
        rest -= float(caps[full].sum())
        open_ &= ~full
    return shares
