"""Obstacles as boxes along the axes, and what of a map a straight line can reach."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..number_arrays import Flags, Floats, reals


def boxes_of(obstacles: ArrayLike) -> Floats:
    """Boxes as an array of shape (boxes, 2, dimensions), least and largest corner, from one of shape (boxes, 4) or (boxes, 6).

    Touching a box is allowed, passing through it is not.
    """
    flat = reals("obstacles", obstacles)
    if flat.size == 0:
        return np.zeros((0, 2, 2))
    if flat.ndim != 2 or flat.shape[1] not in (4, 6):
        raise InputError("obstacles must be boxes of 4 numbers in the plane or 6 in space", "wrong-shape", found=f"shape {flat.shape}")
    boxes = flat.reshape(len(flat), 2, -1)
    wrong = ~np.isfinite(flat).all(axis=1) | ~(boxes[:, 0] < boxes[:, 1]).all(axis=1)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(f"obstacle {k} must have finite corners, the least one first", "out-of-range", found=str(flat[k].tolist()))
    return boxes


def blocked(start: ArrayLike, end: ArrayLike, boxes: Floats) -> Flags:
    """Mask of the straight segments that pass through the inside of a box, or between two that touch, shape (segments,).

    Ends have the shape (dimensions,) or (segments, dimensions).
    """
    a, b = np.broadcast_arrays(np.atleast_2d(np.asarray(start, dtype=np.float64)), np.atleast_2d(np.asarray(end, dtype=np.float64)))
    if not len(boxes):
        return np.zeros(len(a), dtype=bool)
    along = (b - a)[:, None, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = ((boxes[None, :, side] - a[:, None]) / along for side in (0, 1))
    flat = along == 0.0
    inside = (boxes[None, :, 0] < a[:, None]) & (a[:, None] < boxes[None, :, 1])
    enter = np.where(flat, np.where(inside, -np.inf, np.inf), np.minimum(low, high))
    leave = np.where(flat, np.where(inside, np.inf, -np.inf), np.maximum(low, high))
    first, last = np.maximum(enter.max(axis=2), 0.0), np.minimum(leave.min(axis=2), 1.0)
    through: Flags = (last - first > _GRAZE).any(axis=1)
    for k in np.nonzero(~through & flat[:, 0].any(axis=1) & ~(flat[:, 0].all(axis=1)))[0].tolist():
        through[k] = _along_a_seam(a[k], b[k], boxes)
    return through


_GRAZE = 1e-12
"""Part of a segment within an obstacle that counts as touching it: coordinates are known to about that."""


def _along_a_seam(a: Floats, b: Floats, boxes: Floats) -> bool:
    """True if a segment along an axis runs between two boxes that touch, one at each side of it."""
    (axis,) = np.nonzero(a != b)[0].tolist()[:1]
    low, high = sorted((float(a[axis]), float(b[axis])))
    for side in np.nonzero(a == b)[0].tolist():
        others = [d for d in range(len(a)) if d not in (axis, side)]
        near = ((boxes[:, 0, others] < a[others]) & (a[others] < boxes[:, 1, others])).all(axis=1)
        below, above = (boxes[near & (boxes[:, edge, side] == a[side])][:, :, axis] for edge in (1, 0))
        if len(below) and len(above):
            begin = np.maximum(np.maximum.outer(below[:, 0], above[:, 0]), low)
            if (np.minimum(np.minimum.outer(below[:, 1], above[:, 1]), high) > begin).any():
                return True
    return False


def visible(reel: ArrayLike, points: ArrayLike, obstacles: ArrayLike) -> Flags:
    """Mask of the points that a straight tether from ``reel`` reaches: reachable space reduced by ray casting.

    A tether that moves from one such point to another may still brush an obstacle between them; ``Tether`` tells. Obstacles have the shape
    (boxes, 2 * dimensions). Source: Xiao (2019), section 5.3.1; docs/formulations/risky-path.md#tethers.
    """
    return ~blocked(np.asarray(reel, dtype=np.float64), points, boxes_of(obstacles))


def merged_boxes(occupied: NDArray[Any], cell: float = 1.0) -> Floats:
    """Occupied cells of a map in the plane as boxes, runs of a row and then equal runs of rows joined: shape (boxes, 4).

    Cell (r, c) covers ``[c, c + 1] x [r, r + 1]`` times the side ``cell``.
    """
    open_: dict[tuple[int, int], int] = {}
    boxes: list[tuple[float, ...]] = []
    for row in range(occupied.shape[0] + 1):
        runs: set[tuple[int, int]] = set()
        if row < occupied.shape[0]:
            edges = np.diff(np.concatenate([[0], occupied[row].astype(np.int8), [0]]))
            runs = set(zip(np.nonzero(edges == 1)[0].tolist(), np.nonzero(edges == -1)[0].tolist(), strict=True))
        for run in sorted(open_.keys() - runs):
            boxes.append((run[0] * cell, open_.pop(run) * cell, run[1] * cell, row * cell))
        for run in runs - open_.keys():
            open_[run] = row
    return np.array(sorted(boxes), dtype=np.float64).reshape(-1, 4)
