"""Which of several sets of paths holds the cheapest one: probabilities for independent normal costs, by quadrature.

With survivals S_i(x) = P(c_i > x), the product T of all of them and densities f_i, path i is the cheapest of all with probability

    p_i = integral of T(x) f_i(x) / S_i(x) dx,

and a set with the sum over its paths. For two sets this is (5.3) of Skeele (2016) with the variance in (5.5) in place of the standard
deviation that is printed there. A path of no variance ends the integral at its cost.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from ...instances.errors import InputError, UsageError
from ...instances.number_arrays import Floats

FIRST_EDGES = ("separate", "shared")
"""Cost of the first edge: each path of a set has a copy of it to itself (Skeele 2016), or all share one."""

REACH = 7.0
"""Standard deviations beyond which, on either side, a normal cost lies with a probability of 1.3e-12."""

TOLERANCE = 1e-8
"""Most by which the probabilities of all sets may miss 1 before the integral is computed on more points."""

STEP, NARROW = 0.45, 90.0
"""First length of equal steps, and most length of an integral by them, in standard deviations of the narrowest cost."""

POINTS = 16
"""Points of Gauss and Legendre's rule in each piece."""

HALVINGS = 8
"""Most halvings of steps or pieces."""

_CUTS = np.array([-REACH, -4.0, -2.0, 0.0, 2.0, 4.0, REACH])
"""Ends of pieces about a cost, in its standard deviations."""

_TINY, _ROOT = 1e-300, math.sqrt(2.0 * math.pi)


@dataclass(frozen=True)
class PathSet:
    """Normal costs of some paths that begin with one edge: ``means`` and ``variances`` of shape (paths,) of the costs beyond it.

    ``first_mean`` and ``first_variance`` are those of the first edge's cost; once it is observed, its value and 0.
    """

    means: Floats
    variances: Floats
    first_mean: float = 0.0
    first_variance: float = 0.0

    @classmethod
    def of(cls, costs: ArrayLike, first: tuple[float, float] = (0.0, 0.0)) -> "PathSet":
        """A set from pairs (mean, variance), and that of the first edge; raises InputError for no pair or numbers that are none."""
        pairs = np.array(costs, dtype=np.float64).reshape(-1, 2)
        every = np.vstack([pairs, first])
        if not len(pairs) or not np.isfinite(every).all() or (every[:, 1] < 0).any():
            raise InputError(
                "a set of paths needs pairs of a finite mean and a variance of at least 0", "out-of-range", found=str(costs)[:80]
            )
        return cls(pairs[:, 0], pairs[:, 1], *map(float, first))


def cheapest_set_probabilities(sets: Sequence[PathSet], first_edges: str = "separate") -> Floats:
    """Probability of each set that the cheapest of all paths is in it, shape (sets,), summing to 1; equals share it.

    All costs are independent, but for what ``first_edges``, a name of ``FIRST_EDGES``, says of first edges that are not observed yet.
    Source: Skeele (2016), (5.3) to (5.5), corrected; docs/formulations/uncertain-path.md#which-set-holds-the-cheapest-path.
    """
    if first_edges not in FIRST_EDGES:
        raise UsageError(f"first_edges must be one of {', '.join(FIRST_EDGES)}, not {first_edges!r}", "unknown-name")
    if first_edges == "shared" and any(len(s.means) > 1 and s.first_variance > 0 for s in sets):
        return _sharing(sets)
    sizes = [len(s.means) for s in sets]
    mean = np.concatenate([s.means + s.first_mean for s in sets])
    deviation = np.sqrt(np.concatenate([s.variances + s.first_variance for s in sets]))
    starts = np.cumsum([0, *sizes[:-1]])
    return np.add.reduceat(cheapest_path_probabilities(mean, deviation), starts)


def cheaper_probability(a: PathSet, b: PathSet, first_edges: str = "separate") -> float:
    """P(the cheapest path of ``a`` costs less than that of ``b``), a tie counting half; see ``cheapest_set_probabilities``."""
    return float(cheapest_set_probabilities((a, b), first_edges)[0])


def cheapest_path_probabilities(mean: Floats, deviation: Floats) -> Floats:
    """Probability of each of several independent normal costs to be the least, shape (paths,), summing to 1; equals share it.

    A deviation of 0 is a cost that is known.
    """
    known = deviation == 0.0
    if not known.any():
        return _shares(lambda x: _curves(mean, deviation, x), mean, deviation)
    some, chances = ~known, np.zeros(len(mean))
    least = float(mean[known].min())
    winners = known & (mean == least)
    m, d = mean[some], deviation[some]
    chances[winners] = _curves(m, d, np.array([least]))[0].prod() / winners.sum()
    chances[some] = _shares(lambda x: _curves(m, d, x), m, d, least, float(chances.sum()))
    return chances


def _curves(mean: Floats, deviation: Floats, x: Floats) -> tuple[Floats, Floats]:
    """Survival and density of each of several normal costs at each of x."""
    from scipy.special import ndtr

    z = (x - mean[:, None]) / deviation[:, None]
    return ndtr(-z), np.exp(-0.5 * z * z) / (deviation[:, None] * _ROOT)


# -- sets whose paths share the cost of the first edge -----------------------------------------------------------------


def _sharing(sets: Sequence[PathSet]) -> Floats:
    """``cheapest_set_probabilities`` with the first edge's cost common to all paths of a set, and independent of all else."""
    fixed = [float((s.means + s.first_mean)[s.variances == 0].min(initial=math.inf)) if s.first_variance == 0 else math.inf for s in sets]
    least, chances = min(fixed), np.zeros(len(sets))
    if least < math.inf:
        winners = np.array(fixed) == least
        chances[winners] = np.prod([_set_curves(s, np.array([least]))[0] for s in sets]) / winners.sum()
    mean = np.concatenate([s.means + s.first_mean for s in sets])
    deviation = np.sqrt(np.concatenate([s.variances + s.first_variance for s in sets]))

    def curves(x: Floats) -> tuple[Floats, Floats]:
        survivals, densities = zip(*(_set_curves(s, x) for s in sets), strict=True)
        return np.array(survivals), np.array(densities)

    return chances + _shares(curves, mean[deviation > 0], deviation[deviation > 0], least, float(chances.sum()))


def _set_curves(s: PathSet, x: Floats) -> tuple[Floats, Floats]:
    """Survival and density of the least cost in a set at each of x, leaving out what is known for certain: an integral over the first
    edge's cost, where that is none."""
    mean, variance, spread = s.means, s.variances, math.sqrt(s.first_variance)
    if len(mean) == 1 or spread == 0.0:
        some = variance + s.first_variance > 0
        survival, density = _curves(mean[some] + s.first_mean, np.sqrt(variance[some] + s.first_variance), x)
        whole = survival.prod(axis=0)
        return whole, (density / np.maximum(survival, _TINY)).sum(axis=0) * whole
    some = variance > 0
    m, d = mean[some], np.sqrt(variance[some])
    fixed = float(mean[~some].min(initial=math.inf))
    low, high = s.first_mean - REACH * spread, s.first_mean + REACH * spread
    cuts = [x[:, None] - about for about in (m[:, None] + d[:, None] * _CUTS[::2]).ravel()]  # where what follows the first edge changes
    cuts += [np.full((len(x), 1), end) for end in s.first_mean + spread * _CUTS]
    ends = np.sort(np.clip(np.hstack(cuts), np.clip(x - fixed, low, high)[:, None], high), axis=1)
    nodes, weights = _gauss(POINTS)
    half = np.diff(ends, axis=1)[:, :, None] / 2.0
    first = (ends[:, :-1, None] + half + half * nodes).reshape(len(x), -1)
    weights = (half * weights).reshape(first.shape)
    weights = weights * np.exp(-0.5 * ((first - s.first_mean) / spread) ** 2) / (spread * _ROOT)
    survival, density = _curves(m, d, (x[:, None] - first).ravel())
    whole = survival.prod(axis=0)
    changing = (density / np.maximum(survival, _TINY)).sum(axis=0) * whole
    density_of_set = (weights * changing.reshape(first.shape)).sum(axis=1)
    if fixed < math.inf:
        others = _curves(m, d, np.array([fixed]))[0].prod()
        density_of_set += others * np.exp(-0.5 * ((x - fixed - s.first_mean) / spread) ** 2) / (spread * _ROOT)
    return (weights * whole.reshape(first.shape)).sum(axis=1), density_of_set


# -- the integral -----------------------------------------------------------------------------------------------------


def _shares(
    curves: Callable[[Floats], tuple[Floats, Floats]], mean: Floats, deviation: Floats, end: float = math.inf, rest: float = 0.0
) -> Floats:
    """Probability of each of several independent costs to be the least, up to ``end``; with ``rest`` they sum to 1.

    ``curves`` gives survival and density of each at points x; ``mean`` and ``deviation`` are of normal costs that tell where these
    change, and how quickly at most.
    """
    reach = REACH * deviation
    low, high = float((mean - reach).min(initial=math.inf)), float((mean + reach).min(initial=math.inf))
    if not low < min(high, end):
        return np.zeros(len(curves(np.zeros(1))[0]))
    for halvings in range(HALVINGS):
        x, weights = _nodes(mean, deviation, low, high, end, halvings)
        survival, density = curves(x)
        shares = (density / np.maximum(survival, _TINY)) @ (survival.prod(axis=0) * weights)
        total = float(shares.sum())
        if abs(total + rest - 1.0) <= TOLERANCE:
            break
    return np.asarray(shares * ((1.0 - rest) / total)) if total > 0.0 else shares


def _nodes(mean: Floats, deviation: Floats, low: float, high: float, end: float, halvings: int) -> tuple[Floats, Floats | float]:
    """Points and weights of an integral from ``low`` to the lesser of ``high`` and ``end``.

    Where the integrand vanishes at both ends and no cost is much narrower than the others, equal steps converge faster than any
    power; else Gauss and Legendre's rule on pieces about each cost.
    """
    narrowest = float(deviation.min())
    if end >= high and high - low <= NARROW * narrowest:
        count = math.ceil((high - low) / (STEP * narrowest)) * 2**halvings
        step = (high - low) / count
        return low + step * np.arange(count + 1), step
    last = min(high, end)
    ends = (mean + deviation * _CUTS[:, None]).ravel()
    pieces = np.unique(np.clip(np.append(ends, [low, last]), low, last))
    for _ in range(halvings):
        pieces = np.append(np.column_stack([pieces[:-1], (pieces[:-1] + pieces[1:]) / 2.0]).ravel(), pieces[-1])
    return _rule(pieces)


@cache
def _gauss(points: int) -> tuple[Floats, Floats]:
    nodes, weights = np.polynomial.legendre.leggauss(points)
    return nodes, weights


def _rule(pieces: Floats) -> tuple[Floats, Floats]:
    """Nodes and weights of Gauss and Legendre's rule on all pieces."""
    nodes, weights = _gauss(POINTS)
    half = np.diff(pieces)[:, None] / 2.0
    return (pieces[:-1, None] + half + half * nodes).ravel(), (half * weights).ravel()
