"""The largest distances and durations of a travel, and few numbers that stand for all of them, without a look at all pairs."""

import math
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from ....instances.routing.travel import METRICS, Travel
from .integer_scales import Floats, Strips

MANY = 5_000
"""Sites up to which all distances are looked at."""

STRIP = 1 << 20
"""Distances that are looked at together."""

CORNERS = 2_000
"""Corners of a convex hull up to which all pairs of them are looked at."""

STEPS = {"file": 1.0, "round": 1.0, "ceil": 1.0, "trunc1": 0.1, "trunc2": 0.01}
"""Step of each rounding convention: every distance is a multiple of it."""

NO_STEP = 1.0 / math.pi
"""Part of the largest distance that stands for distances that are multiples of nothing: no power of ten makes it whole."""


def distances_of(travel: Travel) -> tuple[Strips, Strips]:
    """All distances and durations, the same ones where these are equal, computed in strips: no matrix of floats is made of coordinates.

    Of more than ``MANY`` sites with coordinates only few numbers are looked at, whose largest is no less than that of all, and which are
    whole in a unit only where all are.
    """
    every = np.arange(len(travel))
    step = max(1, STRIP // max(1, len(every)))

    def rows(between: Callable[[ArrayLike, ArrayLike], Floats]) -> Iterator[Floats]:
        for first in range(0, len(every), step):
            yield between(every[first : first + step, None], every[None, :])

    few = None if travel.matrix is not None or len(travel) <= MANY else _standing_for_all(travel)
    lengths = Strips(partial(rows, travel.distance), few)
    if not travel.own_durations:
        return lengths, lengths
    own = travel.duration_matrix is not None or few is None
    return lengths, Strips(partial(rows, travel.duration), None if own else tuple(travel.pace * value for value in few or ()))


def largest_distance(travel: Travel) -> float:
    """The largest distance between two sites; of many sites on a globe no less than that."""
    return distances_of(travel)[0].largest


def largest_duration(travel: Travel) -> float:
    """The largest duration of a move between two sites; of many sites on a globe no less than that."""
    return distances_of(travel)[1].largest


def _standing_for_all(travel: Travel) -> tuple[float, ...]:
    """The largest distance, and a number of which every distance is a multiple, or one that no power of ten makes whole."""
    points = travel.coordinates
    assert points is not None
    whole = travel.metric == "manhattan" and bool((points == np.rint(points)).all()) and float(np.abs(points).max()) < 2.0**40
    largest = _farthest(travel, points)
    return largest, min(largest, STEPS.get(travel.convention, 1.0 if whole else NO_STEP * largest))


def _farthest(travel: Travel, points: Floats) -> float:
    """The distance of two sites that are farthest from each other, or on a globe twice the largest distance from one site."""
    metric = METRICS[travel.metric].distance
    if travel.metric in ("manhattan", "MAN_2D"):
        turned = np.column_stack([points.sum(axis=1), points[:, 0] - points[:, 1]])
        return float(travel.rounded(np.ptp(turned, axis=0).max()))
    if travel.metric in ("euclidean", "EUC_2D", "CEIL_2D", "ATT"):
        corners = _corners(points)
        return float(travel.rounded(metric(corners[:, None], corners[None, :])).max())
    return float(travel.rounded(2.0 * metric(points[:1], points).max()))


def _corners(points: Floats) -> Floats:
    """The points of the convex hull; the corners of the box around them, which are no nearer, where these lie in a line or are too many."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        corners = points[ConvexHull(points).vertices]
    except QhullError:
        corners = np.empty((CORNERS + 1, 2))
    return corners if len(corners) <= CORNERS else np.array([points.min(axis=0), points.max(axis=0)])
