"""Tracks through the components of a filter, their motion by Gaussian processes, and the distance of two sets of points."""

import math
from collections import deque
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from ..generators import Floats
from .phd_filter import Mixture


@dataclass(eq=False)
class Track:
    """The latest positions of one supposed target; ``component`` is its row in the latest mixture, None while it has none."""

    path: deque[Floats]
    component: int | None
    length: int = 1
    missing: int = 0


@dataclass(frozen=True)
class TrackRules:
    """Rules of tracks, and of their motion.

    A component of a weight above ``threshold`` is a target. A track goes on with a component within the squared Mahalanobis distance
    ``gate``, counts from a length of ``confirm`` steps, and outlives ``patience`` steps without a component. Motion is learnt from the
    latest ``window`` positions (0: tracks stay, as other components do) by a Gaussian process of ``length_scale`` steps and
    ``kernel_noise``, the standard deviation of a position as a share of that of the motion.

    Source: Sung (2019), sections 2.4 and 2.5, (2.7) and (2.8); docs/missions/search-and-track.md.
    """

    threshold: float = 0.5
    confirm: int = 3
    patience: int = 3
    gate: float = 10.0
    window: int = 20
    length_scale: float = 20.0
    kernel_noise: float = 0.5


@dataclass(eq=False)
class Tracks:
    """Tracks so far, the oldest first."""

    rules: TrackRules
    all: list[Track] = field(default_factory=list)

    @property
    def confirmed(self) -> list[Track]:
        """Tracks that count and have a component now."""
        return [track for track in self.all if track.length >= self.rules.confirm and track.component is not None]

    def predict(self, mixture: Mixture) -> Mixture:
        """Components of confirmed tracks moved to where the Gaussian processes of their coordinates expect them next."""
        rules, means = self.rules, mixture.means.copy()
        if rules.window:
            for track in self.confirmed:
                path = np.array(track.path)
                means[track.component] = forecast(path, rules.length_scale, rules.kernel_noise)
        return Mixture(mixture.weights, means, mixture.covariances)

    def follow(self, mixture: Mixture) -> None:
        """Give each track the nearest target in its gate, the nearest pair first; targets in no gate begin tracks of their own."""
        targets = np.nonzero(mixture.weights > self.rules.threshold)[0]
        ends = np.array([track.path[-1] for track in self.all]).reshape(-1, 2)
        apart = mixture.means[targets][:, None, :] - ends
        inverse = np.linalg.inv(mixture.covariances[targets])
        gated = np.einsum("tki,tij,tkj->tk", apart, inverse, apart) <= self.rules.gate
        taken: dict[int, int] = {}
        rows, columns = np.nonzero(gated)
        lengths = (apart[rows, columns] ** 2).sum(axis=1)
        for k in np.argsort(lengths, kind="stable").tolist():
            row, column = int(rows[k]), int(columns[k])
            if column not in taken and row not in taken.values():
                taken[column] = row
        for column, track in enumerate(self.all):
            track.component = int(targets[taken[column]]) if column in taken else None
            track.missing = 0 if column in taken else track.missing + 1
            if track.component is not None:
                track.length += 1
                track.path.append(mixture.means[track.component])
        self.all = [track for track in self.all if track.missing <= self.rules.patience]
        for row in np.nonzero(~gated.any(axis=1))[0].tolist():
            component = int(targets[row])
            self.all.append(Track(deque([mixture.means[component]], maxlen=max(self.rules.window, 1)), component))


def forecast(path: Floats, length_scale: float, noise: float) -> Floats:
    """The next position of a path, shape (steps, 2): the mean of a Gaussian process a coordinate, around the mean of the path.

    Source: Sung (2019), (2.7) and (2.8), where the prior mean is 0, so that predictions fall back to the origin.
    """
    centre = path.mean(axis=0)
    return np.asarray(centre + _weights(len(path), length_scale, noise) @ (path - centre))


@lru_cache(maxsize=256)
def _weights(steps: int, length_scale: float, noise: float) -> Floats:
    at = np.arange(steps, dtype=np.float64)
    kernel = np.exp(-0.5 * ((at[:, None] - at) / length_scale) ** 2) + noise**2 * np.eye(steps)
    return np.asarray(np.linalg.solve(kernel, np.exp(-0.5 * ((steps - at) / length_scale) ** 2)))


def ospa(ones: Floats, others: Floats, cutoff: float = 100.0, order: float = 2.0) -> float:
    """Optimal subpattern assignment distance between two sets of points, (n, 2) and (m, 2): Schuhmacher, Vo and Vo (2008).

    The mean of order ``order`` of the distances of the best assignment, each at most ``cutoff``, which also stands for every point left
    over. Source: Sung (2019), section 2.6.1.
    """
    from scipy.optimize import linear_sum_assignment

    most, least = max(len(ones), len(others)), min(len(ones), len(others))
    if not most:
        return 0.0
    apart = np.sqrt(((ones[:, None, :] - others) ** 2).sum(axis=2)) if least else np.zeros((0, 0))
    costs = np.minimum(apart, cutoff) ** order
    total = float(costs[linear_sum_assignment(costs)].sum()) + cutoff**order * (most - least)
    return math.pow(total / most, 1.0 / order)
