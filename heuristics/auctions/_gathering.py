"""Tours of one robot that gathers from stores: the order of its waypoints by urgency, and how much it takes at each."""

import numpy as np
from numpy.typing import ArrayLike

from ...instances.errors import InputError, UsageError
from ...instances.number_arrays import Floats

URGENCIES = ("shifted", "literal", "rate")
"""``literal``: (rate - time) / distance, as printed, which grows with the distance where it is negative. ``shifted``: the same with the
largest time added to rate - time, so that it is positive. ``rate``: the rate over the time and the distance together."""

MOST_ORDERS = 10_000_000
"""Orders of the next stops that are compared at once."""


def urgencies(rates: ArrayLike, times: ArrayLike, distances: ArrayLike, urgency: str = "shifted") -> Floats:
    """Urgency of each waypoint from each place, shape (places, waypoints); ``urgency`` is one of ``URGENCIES``.

    ``rates`` are positive, ``times`` the steps until a store is full, ``distances`` of shape (places, waypoints) count as one step at
    least.

    Source: Zhang (2015), (4.2) and (4.5); docs/formulations/balanced-partition.md#urgency.
    """
    rate, time, away = (np.asarray(array, dtype=np.float64) for array in (rates, times, distances))
    if rate.ndim != 1 or time.shape != rate.shape or away.shape[-1:] != rate.shape:
        raise InputError(
            "there must be one rate, time and distance a waypoint", "wrong-shape", found=f"{rate.shape}, {time.shape}, {away.shape}"
        )
    if not (rate > 0).all() or not np.isfinite([rate, time]).all():
        raise InputError("rates must be positive, and all times finite", "out-of-range")
    steps = np.maximum(1.0, away)
    if urgency == "rate":
        return np.asarray(rate / (np.maximum(time, 0.0) + steps))
    if urgency not in URGENCIES:
        raise UsageError(f"urgency must be {', '.join(URGENCIES)}, not {urgency!r}", "unknown-name")
    return np.asarray((rate - time + (time.max(initial=0.0) if urgency == "shifted" else 0.0)) / steps)


def next_stop(first: Floats, then: Floats, horizon: int) -> int:
    """The first waypoint of the most urgent order of the next ``horizon`` ones; of equal orders the first in lexicographic order.

    ``first`` are the urgencies from where the robot is, ``then[a, b]`` that of b from waypoint a.
    """
    n = len(first)
    depth = min(horizon, n)
    if horizon < 1 or n == 0 or n**depth > MOST_ORDERS:
        raise UsageError(
            f"a look ahead of {horizon} stops among {n} waypoints: at least 1, and at most {MOST_ORDERS:,} orders", "out-of-range"
        )
    total = first.copy()
    for level in range(1, depth):
        total = total[..., None] + then  # what comes next counts from the last one
        index = np.indices(total.shape, sparse=True)
        for before in range(level):
            total = np.where(index[before] == index[level], -np.inf, total)
    return int(np.unravel_index(int(total.argmax()), total.shape)[0])


def receding_order(first: Floats, then: Floats, horizon: int = 3) -> tuple[int, ...]:
    """All waypoints, each the first of the most urgent order of the next ones from the stop before (Zhang 2015, section 4.4.2)."""
    ahead, order, here = np.arange(len(first)), [], first
    while len(ahead):
        chosen = int(ahead[next_stop(here[ahead], then[np.ix_(ahead, ahead)], horizon)])
        order.append(chosen)
        ahead, here = ahead[ahead != chosen], then[chosen]
    return tuple(order)


def expected_contents(contents: ArrayLike, rates: ArrayLike, steps: float, capacity: float = np.inf) -> Floats:
    """Contents of stores after ``steps``, at most ``capacity``: (4.6) of Zhang (2015), which has no capacity."""
    return np.minimum(np.asarray(contents, dtype=np.float64) + steps * np.asarray(rates, dtype=np.float64), capacity)


def reward_split(available: ArrayLike, room: float) -> Floats:
    """A robot's room shared out in proportion to what is available at each waypoint, and no more than that anywhere.

    Source: Zhang (2015), (4.7), whose shares always come to the whole room; docs/formulations/balanced-partition.md#reward-split.
    """
    held = np.asarray(available, dtype=np.float64)
    if held.ndim != 1 or not (held >= 0).all() or not np.isfinite(held).all() or not room >= 0:
        raise InputError(
            "what is available, and the room of the robot, must be numbers from 0 on", "out-of-range", found=str(available)[:60]
        )
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
