"""Points in a rectangle [0, width] x [0, height], in metres: where they may start, where they may be told to go, how they wander."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from ...errors import InputError
from ...generators import Draw, Flags, Floats
from ...text import an

TOLERANCE = 1e-9
"""Relative rounding error by which a robot's move may exceed its longest one."""


def placed(what: str, given: ArrayLike, count: int, area: Floats) -> Floats:
    """``given`` as one position per robot or target, shape (count, 2); raises InputError if it is none, or one lies outside."""
    points = np.array(given, dtype=np.float64)
    if points.shape != (count, 2):
        raise InputError(f"there must be one position {an(what)}", "wrong-shape", expected=f"({count}, 2)", found=str(points.shape))
    wrong = ~np.isfinite(points).all(axis=1) | outside(points, area)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(f"{what} {k + 1} starts outside the area", "out-of-range", expected=shown(area), found=str(points[k].tolist()))
    return points


def moved(robots: Floats, actions: Mapping[int, ArrayLike], longest: float, area: Floats) -> Floats:
    """The robots' positions after each was told one, or none and stays; raises InputError where that cannot be done."""
    to = robots.copy()
    for robot, position in actions.items():
        to[robot] = _reachable(robots, robot, position, longest, area)
    return to


def _reachable(robots: Floats, robot: int, position: ArrayLike, longest: float, area: Floats) -> Floats:
    if not 0 <= robot < len(robots):
        raise InputError(f"there is no robot number {robot}", "unknown-name", expected=f"0 to {len(robots) - 1}")
    try:
        point = np.array(position, dtype=np.float64)
    except (TypeError, ValueError):
        point = np.zeros(0)
    if point.shape != (2,) or not np.isfinite(point).all():
        raise InputError(f"robot number {robot} must be told a position", expected="two finite numbers", found=str(position)[:80])
    length = float(np.linalg.norm(point - robots[robot]))
    if length > longest * (1 + TOLERANCE):
        raise InputError(f"robot number {robot} cannot move {length:.9g} m in one step", "out-of-range", expected=f"at most {longest:g}")
    if outside(point[None], area)[0]:
        raise InputError(f"robot number {robot} must stay inside", "out-of-range", expected=shown(area), found=str(point.tolist()))
    return point


def wandered(draw: Draw, targets: Floats, headings: Floats, reach: Floats, area: Floats) -> tuple[Floats, Floats]:
    """Headings of targets that move by ``reach``, shape (targets, 1), and their moves; at walls others are drawn until one leads inside."""
    crossing = outside(targets + reach * direction(headings), area)
    while crossing.any():
        headings[crossing] = draw.uniform(-np.pi, np.pi, int(crossing.sum()))
        crossing = outside(targets + reach * direction(headings), area)
    return headings, reach * direction(headings)


def distances(here: Floats, there: Floats) -> Floats:
    """Distances between two lists of positions, shape (here, there)."""
    return np.asarray(np.sqrt(((here[:, None, :] - there[None, :, :]) ** 2).sum(axis=2)))


def direction(headings: Floats) -> Floats:
    """Unit vectors, shape (headings, 2)."""
    return np.column_stack([np.cos(headings), np.sin(headings)])


def outside(points: Floats, area: Floats) -> Flags:
    """Which points lie outside of the area."""
    return np.asarray(((points < 0) | (points > area)).any(axis=1))


def shown(area: Floats) -> str:
    """The area, for errors."""
    return f"within [0, {area[0]:g}] x [0, {area[1]:g}]"
