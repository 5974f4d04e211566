"""Tethers: where a line between a reel and a vehicle bends around obstacles, as the vehicle moves.

Source: Xiao (2019), algorithm 4 with its gaps filled; docs/formulations/risky-path.md#tethers.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..number_arrays import Floats
from .obstacles import blocked, boxes_of

Point = tuple[float, float]
Contacts = tuple[Point, ...]
"""The reel, and the corners that the tether bends around since; the last one is that from which it leads to the vehicle."""


@dataclass(frozen=True, eq=False)
class Tether:
    """A straight line from the reel, around obstacles of shape (boxes, 4) where it must, to the vehicle.

    Moves are cut into pieces of at most ``spacing``: line of sight is tested at their ends only, so that a tether swings past an obstacle
    that is smaller than a piece. None tests at the states of the path alone, as the source does.
    """

    reel: Point
    obstacles: Floats
    spacing: float | None = None

    def __post_init__(self) -> None:
        boxes = boxes_of(self.obstacles)
        if len(boxes) and boxes.shape[2] != 2:
            raise InputError(
                "tethers bend around obstacles in the plane", "unsupported", expected="boxes of 4 numbers", found="boxes in space"
            )
        if self.spacing is not None and not 0 < self.spacing < math.inf:
            raise InputError("the spacing of a tether must be positive", "out-of-range", found=str(self.spacing))
        reel = tuple(map(float, self.reel))
        if len(reel) != 2 or not all(map(math.isfinite, reel)):
            raise InputError("the reel of a tether must be a point of the plane", "wrong-shape", found=str(self.reel))
        object.__setattr__(self, "reel", reel)
        object.__setattr__(self, "obstacles", boxes.reshape(len(boxes), -1) if len(boxes) else np.zeros((0, 4)))
        object.__setattr__(self, "_boxes", boxes)
        corners = boxes[:, [[0, 0], [0, 1], [1, 1], [1, 0]], [0, 1]].reshape(-1, 2) if len(boxes) else np.zeros((0, 2))
        object.__setattr__(self, "_corners", np.unique(corners, axis=0))

    _boxes: Floats = None  # type: ignore[assignment]
    _corners: Floats = None  # type: ignore[assignment]

    def moved(self, contacts: Contacts, before: Sequence[float], after: Sequence[float]) -> Contacts | None:
        """The contacts once the vehicle has gone straight from ``before`` to ``after``; None if it cannot."""
        if bool(blocked(before, after, self._boxes)[0]):
            return None
        a, b = np.asarray(before, dtype=np.float64), np.asarray(after, dtype=np.float64)
        pieces = 1 if self.spacing is None else max(1, math.ceil(float(np.hypot(*(b - a))) / self.spacing * (1.0 - 1e-12)))
        current: Contacts | None = contacts
        for k in range(pieces):
            current = self._piece(current, a + (b - a) * (k / pieces), a + (b - a) * ((k + 1) / pieces)) if current is not None else None
        return current

    def begun(self, at: Sequence[float]) -> Contacts | None:
        """The contacts of a vehicle set down at ``at``: none, where it can be seen from the reel; None elsewhere."""
        return None if bool(blocked(self.reel, at, self._boxes)[0]) else (self.reel,)

    def length(self, contacts: Contacts, at: Sequence[float]) -> float:
        """Length of the tether from the reel along all contacts to the vehicle."""
        return math.fsum(math.dist(a, b) for a, b in zip(contacts, (*contacts[1:], tuple(at)), strict=True))

    def along(self, waypoints: Sequence[Sequence[float]]) -> list[tuple[Contacts, float]]:
        """Contacts and length at each waypoint of a path; raises InputError where the reel does not see the first or an obstacle is met."""
        contacts = self.begun(waypoints[0])
        if contacts is None:
            raise InputError("the first waypoint cannot be seen from the reel", "contradiction", found=str(tuple(waypoints[0])))
        steps = [(contacts, self.length(contacts, waypoints[0]))]
        for before, after in itertools.pairwise(waypoints):
            contacts = self.moved(contacts, before, after)
            if contacts is None:
                raise InputError(f"no tether can follow the move to {tuple(after)}: it leads through an obstacle", "contradiction")
            steps.append((contacts, self.length(contacts, after)))
        return steps

    def _piece(self, contacts: Contacts, before: Floats, after: Floats) -> Contacts | None:
        stack = list(contacts)
        while len(stack) > 1 and self._relaxes(stack[-2], stack[-1], after):
            stack.pop()
        swung = before
        while bool(blocked(stack[-1], after, self._boxes)[0]):
            swept = self._first_swept(stack[-1], swung, after)
            if swept is None or len(stack) > len(contacts) + len(self._corners):
                return None
            corner, swung = swept
            stack.append(corner)
        return tuple(stack)

    def _relaxes(self, last: Point, current: Point, vehicle: Floats) -> bool:
        """True if the contact ``current`` is released: ``last`` sees the vehicle, and no obstacle is between."""
        if bool(blocked(last, vehicle, self._boxes)[0]):
            return False
        triangle = np.array([last, current, vehicle])
        apart = np.zeros(len(self._boxes), dtype=bool)  # by an axis, or a side of the triangle
        size = float(np.ptp(triangle, axis=0).max())
        for axis in (0, 1):
            apart |= (self._boxes[:, 1, axis] <= triangle[:, axis].min()) | (self._boxes[:, 0, axis] >= triangle[:, axis].max())
        box = self._boxes[:, [[0, 0], [0, 1], [1, 1], [1, 0]], [0, 1]]
        for k in range(3):
            side = triangle[(k + 1) % 3] - triangle[k]
            third = _cross(side, triangle[(k + 2) % 3] - triangle[k])
            if abs(third) <= _GRAZE * size * size:
                return True  # in line: nothing is between
            heights = _cross(side, box - triangle[k]) * math.copysign(1.0, third)
            apart |= (heights <= _GRAZE * size * size).all(axis=1)
        return bool(apart.all())

    def _first_swept(self, current: Point, before: Floats, after: Floats) -> tuple[Point, Floats] | None:
        """The corner met first when the tether swings from ``before`` to ``after`` around ``current``, and where the vehicle is then."""
        c = np.asarray(current)
        u, w = before - c, after - c
        turn = float(_cross(u, w))
        if turn == 0.0 or not len(self._corners):
            return None
        sign = math.copysign(1.0, turn)
        rays = self._corners - c
        reach = sign * _cross(after - before, rays - u)  # not beyond the vehicle's way
        size = abs(turn)
        inside = (sign * _cross(u, rays) >= -_GRAZE * size) & (sign * _cross(rays, w) >= -_GRAZE * size) & (reach >= -_GRAZE * size)
        inside &= (rays != 0.0).any(axis=1)
        inside[inside] = ~blocked(c, self._corners[inside], self._boxes)
        if not inside.any():
            return None
        at = np.nonzero(inside)[0]
        angle = np.round(np.arctan2(sign * _cross(u, rays[at]), rays[at] @ u), 12)
        chosen = int(at[np.lexsort((-np.hypot(*rays[at].T), angle))[0]])
        ray, way = rays[chosen], after - before
        met = float(_cross(ray, way))
        part = float(np.clip(_cross(-u, ray) / -met, 0.0, 1.0)) if met != 0.0 else 0.0
        return (float(self._corners[chosen, 0]), float(self._corners[chosen, 1])), before + part * way


_GRAZE = 1e-12


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
