"""Gaussian-mixture filter of a probability hypothesis density: how many targets there are, and where, from detections in discs."""

import math
from dataclasses import dataclass, fields

import numpy as np

from ..errors import InputError
from ..generators import Flags, Floats, Integers

NODES, NODE_WEIGHTS = np.polynomial.legendre.leggauss(40)

REPULSIONS = ("all", "undetected", "none")

FAR = 9.0
"""Standard deviations beyond which a normal distribution is left out: less than 1e-18 of it."""


@dataclass(frozen=True, eq=False)
class Mixture:
    """Density of targets in the plane: ``weights`` (n,) times normal densities of ``means`` (n, 2) in m and ``covariances`` (n, 2, 2).

    Its integral over a region is the expected number of targets there. Source: Sung (2019), (2.1) and (2.4).
    """

    weights: Floats
    means: Floats
    covariances: Floats

    def part(self, rows: Flags | Integers) -> "Mixture":
        """The mixture of the given components alone."""
        return Mixture(self.weights[rows], self.means[rows], self.covariances[rows])

    def joined(self, other: "Mixture") -> "Mixture":
        """The components of both, its own first."""
        pairs = ((self.weights, other.weights), (self.means, other.means), (self.covariances, other.covariances))
        return Mixture(*(np.concatenate(pair) for pair in pairs))


@dataclass(frozen=True)
class PHDFilter:
    """Rules of the filter; a method a stage.

    A robot sees a disc of radius ``sensing`` (m). A target in it is detected, and one is there a step later, with the probabilities
    ``detection`` and ``survival``; ``clutter`` is that of a false detection in a step of a robot, uniform in the disc. ``noise`` and
    ``drift`` (m) are standard deviations of a measured coordinate, and of a coordinate's change in a step. Components of a weight below
    ``prune`` are dropped, those within the squared Mahalanobis distance ``merge`` merged, and each detection adds one of weight ``birth``.
    Of components at the border of the disc ``repulsion`` pushes out, by (2.11), ``all`` (the part of each that was not detected, as
    printed), the ``undetected`` (those alone that no detection is more likely to come from) or ``none``.

    Raises InputError if a probability lies outside [0, 1], or another number is negative.

    Source: Sung (2019), section 2.4, after Vo and Ma (2006); readings and errata: docs/missions/search-and-track.md.
    """

    sensing: float = 25.0
    detection: float = 0.98
    survival: float = 1.0
    clutter: float = 0.1
    noise: float = 1.0
    drift: float = 0.1
    prune: float = 1e-3
    merge: float = 10.0
    birth: float = 1.0
    repulsion: str = "all"

    def __post_init__(self) -> None:
        if self.repulsion not in REPULSIONS:
            raise InputError("no such repulsion", "unknown-name", expected=", ".join(REPULSIONS), found=str(self.repulsion))
        for name in ("detection", "survival", "clutter"):
            if not 0.0 <= (value := getattr(self, name)) <= 1.0:
                raise InputError(f"{name} is no probability", "out-of-range", expected="from 0 to 1", found=f"{value:g}")
        for field in fields(self):
            if field.name != "repulsion" and not (math.isfinite(value := getattr(self, field.name)) and value >= 0.0):
                raise InputError(f"{field.name} is negative or no number", "out-of-range", expected="0 at least", found=f"{value:g}")
        for name in ("sensing", "noise"):
            if getattr(self, name) == 0.0:
                raise InputError(f"{name} is 0: no density follows from detections", "out-of-range", expected="above 0", found="0")

    def predict(self, mixture: Mixture) -> Mixture:
        """A step later, (2.2): components stay where they are and spread; nothing is born but from detections."""
        return Mixture(self.survival * mixture.weights, mixture.means, mixture.covariances + self.drift**2 * np.eye(2))

    def detected(self, mixture: Mixture, places: Floats) -> Floats:
        """Probability that the target of each component is detected from each place, (2.9); shape (..., n) for places (..., 2)."""
        return self.detection * disc_mass(mixture, places, self.sensing)

    def gains(self, mixture: Mixture) -> tuple[Floats, Floats, Floats]:
        """For each component: inverse covariances of a measurement, gains, and covariances after it; each (n, 2, 2)."""
        covariances = mixture.covariances
        inverse = np.linalg.inv(covariances + self.noise**2 * np.eye(2))
        gain = covariances @ inverse
        after = covariances - gain @ covariances
        return np.asarray(inverse, dtype=np.float64), gain, 0.5 * (after + after.transpose(0, 2, 1))

    def update(self, mixture: Mixture, place: Floats, found: Floats) -> Mixture:
        """After a robot at ``place`` measured ``found``, shape (detections, 2), m: (2.3) with the field of view and (2.11).

        n components become n (detections + 1): not detected first, then those of each detection.
        """
        seen = self.detected(mixture, place)
        inverse, gain, after = self.gains(mixture)
        away = found[:, None, :] - mixture.means
        squares = np.einsum("kni,nij,knj->kn", away, inverse, away)
        joint = seen * mixture.weights * np.sqrt(np.linalg.det(inverse)) * np.exp(-0.5 * squares) / (2.0 * math.pi)
        total = joint.sum(axis=1, keepdims=True) + self.clutter / (math.pi * self.sensing**2)
        weights = np.divide(joint, total, out=np.zeros_like(joint), where=total > 0)
        pushed = (seen >= 0.4) & (seen <= 0.6) & (self.repulsion != "none")
        if self.repulsion == "undetected":
            pushed &= weights.sum(axis=0) < 0.5 * mixture.weights
        border = mixture.means + np.where(pushed, seen, 0.0)[:, None] * (mixture.means - place)
        means = mixture.means + np.einsum("nij,knj->kni", gain, away)
        missed = Mixture((1.0 - seen) * mixture.weights, border, mixture.covariances)
        return missed.joined(Mixture(weights.ravel(), means.reshape(-1, 2), np.tile(after, (len(found), 1, 1))))

    def reduced(self, mixture: Mixture) -> Mixture:
        """Drop light components; then merge those near the heaviest one with it, again and again: weights add up, moments are kept.

        Near is by the covariance of the component that is merged, as in Vo and Ma (2006), table II.
        """
        mixture = mixture.part(mixture.weights >= self.prune)
        order = np.argsort(-mixture.weights, kind="stable")
        mixture = mixture.part(order)
        apart = mixture.means[:, None, :] - mixture.means
        near = np.einsum("ijk,ikl,ijl->ij", apart, np.linalg.inv(mixture.covariances), apart) <= self.merge
        left, merged = np.ones(len(order), dtype=bool), []
        for k in range(len(order)):
            if left[k]:
                group = np.nonzero(near[:, k] & left)[0]
                left[group] = False
                merged.append((k, group))
        lone = mixture.part(np.array([k for k, _ in merged], dtype=np.int64))
        for row, (_, group) in enumerate(merged):
            if len(group) > 1:
                weights = mixture.weights[group]
                total = weights.sum()
                mean = weights @ mixture.means[group] / total
                off = mixture.means[group] - mean
                spread = mixture.covariances[group] + off[:, :, None] * off[:, None, :]
                lone.weights[row], lone.means[row] = total, mean
                lone.covariances[row] = np.einsum("k,kij->ij", weights, spread) / total
        return lone

    def born(self, found: Floats) -> Mixture:
        """A component for each detection."""
        return Mixture(np.full(len(found), self.birth), found, np.broadcast_to(self.noise**2 * np.eye(2), (len(found), 2, 2)))


def disc_mass(mixture: Mixture, places: Floats, radius: float) -> Floats:
    """Probability that a point of each normal distribution lies in the disc around each place; shape (..., n) for places (..., 2).

    By 40 nodes of Gauss and Legendre along the axis of the smaller variance, in which the rest is an error function. Source: Sung (2019),
    (2.10), whose bracket belongs inside the exponent.
    """
    from scipy.special import erf

    variances, axes = np.linalg.eigh(mixture.covariances)
    deviations = np.sqrt(variances)
    off = np.einsum("nij,...ni->...nj", axes, mixture.means - np.asarray(places)[..., None, :])
    x, y = off[..., 0], off[..., 1]
    low, high = (np.arcsin(np.clip(x + sign * FAR * deviations[:, 0], -radius, radius) / radius) for sign in (-1.0, 1.0))
    angle = 0.5 * (low + high)[..., None] + 0.5 * (high - low)[..., None] * NODES
    across, half = radius * np.sin(angle), radius * np.cos(angle)
    bell = np.exp(-0.5 * ((across - x[..., None]) / deviations[:, :1]) ** 2) / (math.sqrt(2.0 * math.pi) * deviations[:, :1])
    scale = math.sqrt(2.0) * deviations[:, 1:]
    inside = 0.5 * (erf((half - y[..., None]) / scale) + erf((half + y[..., None]) / scale))
    return np.asarray(np.clip(0.5 * (high - low) * ((bell * inside * half) @ NODE_WEIGHTS), 0.0, 1.0))
