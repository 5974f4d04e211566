"""Which of several sets of paths holds the cheapest one where paths share edges: the joint normal distribution, and sampling.

The costs c of n paths are A x, with x the random costs of edges and A telling which path uses which. Path i is the cheapest where all
c_i - c_j <= 0: an orthant of n - 1 dimensions, whose probability is integrated variable by variable (Genz 1992) over a lattice of
points.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...instances.errors import InputError, UsageError
from ...instances.number_arrays import Floats
from ...instances.risk.uncertain_graph import UncertainGraph

MOST_PATHS = 60
"""Most paths of an exact comparison: the lattice loses its evenness in more dimensions."""

POINTS, SHIFTS = 2039, 16
"""Points of the lattice, and its random shifts, whose spread is the error."""

CHUNK = 1 << 21
"""Random numbers that sampling holds at once."""


@dataclass(frozen=True)
class JointCosts:
    """Costs of paths that may share random costs: ``mean`` of shape (paths,), ``variance`` of shape (variables,).

    ``uses``, shape (paths, variables), is 1 where a path uses a random cost.
    """

    mean: Floats
    uses: Floats
    variance: Floats

    @classmethod
    def of_paths(cls, graph: UncertainGraph, paths: Sequence[Sequence[int]], observed: Floats | None = None) -> "JointCosts":
        """Costs of paths through a graph; raises InputError if a path uses an edge that does not exist.

        ``observed`` has one entry per edge, a cost that is known or NaN.
        """
        edges = [graph.edges_of(path) for path in paths]
        if any((used < 0).any() for used in edges):
            raise InputError("a path uses an edge that does not exist", "unknown-name")
        known = np.zeros(graph.num_edges, dtype=bool) if observed is None else ~np.isnan(observed)
        mean = graph.mean if observed is None else np.where(known, observed, graph.mean)
        variance = np.where(known, 0.0, graph.variance)
        row = np.repeat(np.arange(len(paths)), [len(used) for used in edges])
        flat = np.concatenate(edges)
        random = variance[flat] > 0
        variables, column = np.unique(graph.variables[flat[random]], return_inverse=True)
        uses, spread = np.zeros((len(paths), len(variables))), np.zeros(len(variables))
        uses[row[random], column], spread[column] = 1.0, variance[flat[random]]
        return cls(np.array([math.fsum(mean[used]) for used in edges]), uses, spread)

    @property
    def covariance(self) -> Floats:
        """Covariance of the paths' costs."""
        return np.asarray((self.uses * self.variance) @ self.uses.T)


def joint_probabilities(mean: ArrayLike, covariance: ArrayLike, groups: ArrayLike) -> tuple[Floats, Floats]:
    """Probability of each group that the least of jointly normal costs is in it, equals sharing it, and standard errors.

    ``groups``, of shape (paths,), are numbers from 0; the covariance may be singular. Each path's share is computed by itself, so that the
    sum differs from 1 by as much as the errors. Raises UsageError for more than ``MOST_PATHS`` paths. Source: Genz (1992), Numerical
    computation of multivariate normal probabilities; docs/formulations/uncertain-path.md#shared-edges.
    """
    m, c = np.asarray(mean, dtype=np.float64), np.asarray(covariance, dtype=np.float64)
    if len(m) > MOST_PATHS:
        raise UsageError(f"{len(m)} paths are too many to compare exactly (at most {MOST_PATHS}); sample them", "too-large")
    group = np.asarray(groups, dtype=np.int64)
    chance = np.zeros((int(group.max()) + 1, SHIFTS))
    for i in range(len(m)):
        others = np.arange(len(m)) != i
        upper = (m - m[i])[others]
        spread = (c - c[i] - c[:, [i]] + c[i, i])[np.ix_(others, others)]
        apart = np.sqrt(np.maximum(spread.diagonal(), 0.0))
        size = float(np.abs(c).max(initial=0.0)) ** 0.5
        fixed = apart <= 1e-8 * size  # the same costs, but for a constant
        equal = fixed & (np.abs(upper) <= 1e-12 * np.abs(m).max(initial=0.0))
        if (fixed & ~equal & (upper < 0)).any():
            continue
        chance[group[i]] += _by_shift(upper[~fixed], spread[np.ix_(~fixed, ~fixed)]) / (1 + int(equal.sum()))
    return chance.mean(axis=1), chance.std(axis=1, ddof=1) / math.sqrt(SHIFTS)


def _by_shift(upper: Floats, covariance: Floats) -> Floats:
    """P(Z <= upper) of a centred normal vector by each shift of the lattice, which is the same every time; shape (SHIFTS,)."""
    from scipy.special import ndtr, ndtri

    n = len(upper)
    if n == 0:
        return np.ones(SHIFTS)
    factor, u = _pivoted(upper, covariance)
    if n == 1:
        return np.full(SHIFTS, ndtr(u[0] / factor[0, 0]))
    steps = np.sqrt(np.array(_primes(n - 1), dtype=np.float64))
    shifts = np.random.Generator(np.random.PCG64(1)).random((SHIFTS, 1, n - 1))
    points = (np.arange(1, POINTS + 1)[:, None] * steps + shifts) % 1.0
    points = np.abs(2.0 * points - 1.0).reshape(-1, n - 1)  # as if the function were periodic
    y = np.zeros((len(points), n))
    whole = np.ones(len(points))
    for k in range(n):
        slack = u[k] - y[:, :k] @ factor[k, :k]
        if factor[k, k] > 0:
            part = ndtr(slack / factor[k, k])
            if k < n - 1:
                y[:, k] = ndtri(np.clip(points[:, k] * part, 1e-300, 1.0 - 1e-16))
        else:
            part = (slack >= -1e-9 * (1.0 + abs(u[k]))).astype(np.float64)  # settled by those before
        whole *= part
    return np.asarray(whole.reshape(SHIFTS, POINTS).mean(axis=1))


def _pivoted(upper: Floats, covariance: Floats) -> tuple[Floats, Floats]:
    """A triangular factor of the correlations, the least likely limits first, and the limits in its order.

    Entries that depend on those before have 0 on the diagonal.
    """
    from scipy.special import ndtr

    scale = np.sqrt(covariance.diagonal())
    u, c = upper / scale, covariance / np.outer(scale, scale)
    n, factor, y = len(u), np.zeros((len(u), len(u))), np.zeros(len(u))
    order = np.arange(n)
    for k in range(n):
        spread = np.maximum(1.0 - (factor[k:] ** 2).sum(axis=1), 0.0)
        spread[spread < 1e-12] = 0.0
        slack = u[k:] - factor[k:] @ y
        with np.errstate(divide="ignore", invalid="ignore"):
            j = k + int(np.argmin(np.where(spread > 0, ndtr(slack / np.sqrt(spread)), 2.0)))
        for values in (order, u, factor):
            values[[k, j]] = values[[j, k]]
        c[[k, j]] = c[[j, k]]
        c[:, [k, j]] = c[:, [j, k]]
        if spread[j - k] == 0.0:
            break
        factor[k, k] = math.sqrt(spread[j - k])
        factor[k + 1 :, k] = (c[k + 1 :, k] - factor[k + 1 :] @ factor[k]) / factor[k, k]
        most = slack[j - k] / factor[k, k]
        y[k] = -math.exp(-0.5 * most * most) / math.sqrt(2.0 * math.pi) / max(float(ndtr(most)), 1e-300)
    return factor, u


def _primes(count: int) -> list[int]:
    primes: list[int] = []
    k = 2
    while len(primes) < count:
        if all(k % p for p in primes):
            primes.append(k)
        k += 1
    return primes


def sampled_probabilities(costs: JointCosts, groups: ArrayLike, samples: int, rng: "np.random.Generator") -> tuple[Floats, Floats]:
    """``joint_probabilities`` by drawing the random costs of the edges ``samples`` times."""
    group = np.asarray(groups, dtype=np.int64)
    order = np.argsort(group, kind="stable")
    starts = np.searchsorted(group[order], np.arange(int(group.max()) + 1))
    loads = (costs.uses * np.sqrt(costs.variance))[order].T
    won = np.zeros(len(starts))
    missing, most = samples, max(1, CHUNK // max(1, len(costs.variance), len(group)))
    while missing > 0:
        count = min(missing, most)
        drawn = costs.mean[order] + rng.standard_normal((count, len(costs.variance))) @ loads
        least = np.minimum.reduceat(drawn, starts, axis=1)
        winners = least == least.min(axis=1, keepdims=True)
        won += (winners / winners.sum(axis=1, keepdims=True)).sum(axis=0)
        missing -= count
    chance = won / samples
    return chance, np.sqrt(chance * (1.0 - chance) / samples)
