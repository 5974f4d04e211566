"""Local force vectors: robots are drawn to targets and pushed off by each other (A-CMOMMT)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ....instances.errors import UsageError
from ....instances.number_arrays import Floats
from ....instances.sata.worlds.tracking import TrackingObservation

STILL = 1e-9
"""A sum of forces shorter than this has no direction, and the robot stays."""


@dataclass(frozen=True)
class ForceRules:
    """Breakpoints of the two forces, as multiples of the sensing range.

    A target pushes off below ``do1``, draws with full force from ``do2`` to ``do3``, the sensing range itself, and not at all from
    ``predictive`` on, as far as targets seen by others are followed. A robot pushes off with full force below ``dr1``, and not at all from
    ``dr2`` on. ``shared`` is the weight of a target that another robot sees, too. The defaults are this package's: the source names the
    breakpoints and not their values.
    """

    do1: float = 0.15
    do2: float = 0.3
    do3: float = 1.0
    predictive: float = 1.2
    dr1: float = 0.5
    dr2: float = 0.75
    shared: float = 0.5

    def __post_init__(self) -> None:
        if not (0 < self.do1 < self.do2 <= self.do3 < self.predictive and 0 < self.dr1 < self.dr2 and 0 <= self.shared <= 1):
            raise UsageError(f"force rules need 0 < do1 < do2 <= do3 < predictive, 0 < dr1 < dr2 and 0 <= shared <= 1, not {self}")


def attraction(distance: ArrayLike, do1: float, do2: float, do3: float, predictive: float) -> Floats:
    """Force of a target along the way to it: -1 at distance 0, 0 at ``do1``, 1 from ``do2`` to ``do3``, 0 from ``predictive`` on."""
    return np.asarray(np.interp(np.asarray(distance, dtype=np.float64), [0.0, do1, do2, do3, predictive], [-1.0, 0.0, 1.0, 1.0, 0.0]))


def repulsion(distance: ArrayLike, dr1: float, dr2: float) -> Floats:
    """Force of a robot along the way to it: -1 up to ``dr1``, 0 from ``dr2`` on."""
    return np.asarray(np.interp(np.asarray(distance, dtype=np.float64), [dr1, dr2], [-1.0, 0.0]))


def forces(observation: TrackingObservation, rules: ForceRules | None = None) -> Floats:
    """Sum of the forces on each robot, shape (robots, 2).

    A robot feels the robots that it can hear, directly or relayed, and the targets that it or they see, each where those who see it measure
    it on average. Two things at one place exert no force on each other: they have no direction.

    Source: Parker (2002), "Distributed algorithms for multi-robot observation of multiple moving targets", Autonomous Robots 12, in
    formulas: docs/missions.md#force-vectors.
    """
    r, o = rules or ForceRules(), observation
    s = o.rules.sensing
    hears = o.components[:, None] == o.components[None, :]
    # Where the members of each robot's component see each target, on average.
    witnesses = hears.astype(float) @ o.seen
    summed = np.einsum("ij,jtk->itk", hears.astype(float), np.where(o.seen[:, :, None], o.measured, 0.0))
    known = witnesses > 0
    ways = np.where(known[:, :, None], summed / np.maximum(witnesses, 1.0)[:, :, None] - o.positions[:, None, :], 0.0)
    lengths = np.sqrt((ways**2).sum(axis=2))
    others = witnesses - o.seen > 0
    weight = np.where(known, np.where(others, r.shared, 1.0), 0.0)
    pull = weight * attraction(lengths, r.do1 * s, r.do2 * s, r.do3 * s, r.predictive * s)
    apart = o.positions[None, :, :] - o.positions[:, None, :]
    gaps = np.sqrt((apart**2).sum(axis=2))
    push = np.where(hears, repulsion(gaps, r.dr1 * s, r.dr2 * s), 0.0)
    return _along(pull, ways, lengths) + _along(push, apart, gaps)


def _along(sizes: Floats, ways: Floats, lengths: Floats) -> Floats:
    """Sum over the second axis of forces of these sizes along these ways; a way of length 0 has no direction."""
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = np.where(lengths > 0, sizes / lengths, 0.0)
    return np.asarray((scale[:, :, None] * ways).sum(axis=1))


def moves(observation: TrackingObservation, rules: ForceRules | None = None) -> dict[int, Floats]:
    """The place where each robot goes: along the sum of its forces as far as it can in one step, and no farther than the wall."""
    o, pull = observation, forces(observation, rules)
    size = np.sqrt((pull**2).sum(axis=1))
    going = size > STILL
    step = o.rules.robot_step * pull / np.where(going, size, 1.0)[:, None]
    to = np.clip(np.where(going[:, None], o.positions + step, o.positions), 0.0, o.rules.area)
    return {int(robot): to[k] for k, robot in enumerate(o.ids)}
