"""Probability that any of many jointly Gaussian constraints fails, with limits between which it lies.

Limits for any number of constraints follow from the probabilities that one fails and that two do: the sum less a spanning tree of pairs is
no less (Hunter 1976, Worsley 1982), the limits of Dawson and Sankoff (1967) and de Caen (1997) are no more. One or two are exact.

Between these it is sampled where it happens, however rare: one constraint is drawn by its probability to fail, then the noise given that
it does, and a sample counts one part in as many as fail there (Adler, Blanchet and Liu 2012; Owen, Maximov and Chertkov 2019). So each
sample is worth between nothing and the sum of the probabilities, whatever their size, and its mean has an interval whose confidence is
proved for bounded numbers, without a normal limit (Waudby-Smith and Ramdas 2023).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...instances.number_arrays import Floats, Integers as Ints
from .normal import ndtr, ndtri

POINTS, MORE_POINTS = 24_000, 96_000
"""Samples; more where an answer is judged by them."""

WORK = 4e8
"""Most multiplications for a probability: the more constraints, the fewer samples are drawn."""

PILOT = 8
"""One part in so many of the samples, the pilot, says how much to bet on the others."""

CONFIDENCE = 0.999
"""Least confidence of an interval by samples."""

ROUNDED = 1e-13
"""Part of the sum of the probabilities, for each constraint, by which tails and pairs may be rounded."""

BLURRED = 1e-6
"""Part of the sum of the probabilities by which a root of the covariance, rounded, may move what its samples say."""

_PORTION = 200_000
"""Numbers that are drawn at a time."""


@dataclass(frozen=True)
class Probability:
    """An estimate ``value``, and limits ``low`` and ``high`` of the truth.

    ``confidence`` is that the truth lies between these: 1 where both are proved, at least ``CONFIDENCE`` where samples say so. ``most`` is
    proved: the truth is no more.
    """

    value: float
    low: float
    high: float
    confidence: float
    most: float

    @property
    def exact(self) -> bool:
        """True if it is computed without samples, exact but for rounding."""
        return self.low == self.high

    def kept(self, risk: float) -> float:
        """The confidence that the truth is at most ``risk``: 1 where that is proved, 0 where the limits leave it open."""
        return 1.0 if self.most <= risk else self.confidence if self.high <= risk else 0.0


def any_fails(slack: Floats, covariance: Floats, constraint: Ints | None = None, *, seed: int = 1, points: int = POINTS) -> Probability:
    """Probability that a centred Gaussian vector with ``covariance`` exceeds ``slack`` anywhere.

    ``slack`` has the shape (rows,), ``covariance`` is positive semidefinite; rows without variance hold for certain, or fail. A constraint
    of several rows fails where all of its rows do; by default each row is one. At most ``points`` samples are drawn. The confidence of the
    limits is that of one look: choosing the best of many answers by the same samples chooses by their errors, too.
    """
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))  # which rounding may leave below 0
    scale = np.where(deviation > 0.0, deviation, 1.0)
    with np.errstate(over="ignore"):
        z = np.where(deviation > 0.0, slack / scale, np.where(slack < 0.0, -math.inf, math.inf))
    owner = np.arange(len(z)) if constraint is None else np.unique(constraint, return_inverse=True)[1]
    certain = np.full(int(owner.max(initial=-1)) + 1, -math.inf)
    np.maximum.at(certain, owner, z)
    if (certain == -math.inf).any():
        return _exactly(1.0)
    felt = (ndtr(-certain) > 1e-300)[owner] & (z > -math.inf)
    if not felt.any():
        return _exactly(float(ndtr(-certain).sum()))
    correlation = covariance[np.ix_(felt, felt)] / scale[felt][:, None] / scale[felt]
    np.fill_diagonal(correlation, 1.0)
    parts, z, owner = _independent(correlation, owner[felt]), z[felt], owner[felt]
    unions = [_Union(z[part], np.clip(correlation[np.ix_(part, part)], -1.0, 1.0), owner[part]) for part in parts]
    doubt = (1.0 - CONFIDENCE) / max(1, sum(union.sampled for union in unions))
    return _any_of([union.probability(np.random.default_rng([seed, k]), points, doubt) for k, union in enumerate(unions)])


def both_fail(z: Floats, correlation: Floats) -> Floats:
    """Probability that each two of some standard normal numbers exceed their ``z``; on the diagonal that each does.

    By Owen's (1956) function, wrong by some roundings of the larger tail of the two.
    """
    from scipy.special import owens_t

    h, tails, one, other = np.where(z == 0.0, 1e-300, z), ndtr(-z), *np.triu_indices(len(z), 1)
    r, (a, b) = correlation[one, other], (h[one], h[other])
    rest = 1.0 - np.abs(r)
    spread = np.maximum(np.sqrt(rest * (2.0 - rest)), 1e-150)
    like = np.where(r > 0.0, 1.0, -1.0)
    with np.errstate(over="ignore"):
        parts = owens_t(a, (b - like * a + like * rest * a) / (a * spread)) + owens_t(b, (a - like * b + like * rest * b) / (b * spread))
    pair = 0.5 * (tails[one] + tails[other]) - parts - np.where((a > 0.0) == (b > 0.0), 0.0, 0.5)
    pairs = np.diag(tails)
    pairs[one, other] = pairs[other, one] = np.clip(pair, 0.0, np.minimum(tails[one], tails[other]))
    return pairs


def _exactly(value: float) -> Probability:
    return Probability(value, value, value, 1.0, value)


def _independent(correlation: Floats, constraint: Ints) -> list[Ints]:
    """Rows, those of a constraint beside each other, by parts that have neither noise nor a constraint in common."""
    from scipy.sparse.csgraph import connected_components

    _, part = connected_components((correlation != 0.0) | (constraint[:, None] == constraint), directed=False)
    order = np.lexsort((constraint, part))
    return np.split(order, np.nonzero(np.diff(part[order]))[0] + 1)


def _any_of(parts: list[Probability]) -> Probability:
    """Probability that any of several independent events happens."""
    if len(parts) == 1:
        return parts[0]
    with np.errstate(divide="ignore"):
        any_fails = -np.expm1(np.log1p(-np.array([(p.value, p.low, p.high, p.most) for p in parts])).sum(axis=0))
    value, low, high, most = any_fails.tolist()
    return Probability(value, low, high, 1.0 - math.fsum(1.0 - p.confidence for p in parts), most)


class _Union:
    """Constraints, each a row or several of which all must fail, ascending; the likeliest to hold of its rows stands for it."""

    def __init__(self, z: Floats, correlation: Floats, constraint: Ints) -> None:
        self.z, self.correlation = z, correlation
        self.starts = np.nonzero(np.diff(constraint, prepend=-1))[0]
        ends = np.append(self.starts[1:], len(z))
        self.rows = np.array([a + int(np.argmax(z[a:b])) for a, b in zip(self.starts.tolist(), ends.tolist(), strict=True)])
        self.single = ends - self.starts == 1
        self.pairs = both_fail(z[self.rows], correlation[np.ix_(self.rows, self.rows)])
        self.tails = np.diag(self.pairs).copy()
        self.total = float(self.tails.sum())
        self.tree = _spanning_tree(self.pairs)
        self.base = self.total - float(self.pairs[self.tree].sum())

    @property
    def sampled(self) -> bool:
        """True if samples may be needed: there are more than two rows."""
        return len(self.z) > 2

    def probability(self, rng: "np.random.Generator", points: int, doubt: float) -> Probability:
        """Exact for one row or two; else between proved limits and those of samples, which hold but with the probability ``doubt``."""
        if not self.sampled:
            all_fail = len(self.z) == 2 and not self.single.any()
            either = min(max(self.base, float(self.tails.max())), 1.0)
            return _exactly(float(both_fail(self.z, self.correlation)[0, 1]) if all_fail else either)
        slip, bits = ROUNDED * len(self.tails) * self.total, math.log(2.0 / doubt)
        most = min(1.0, self.base + slip)
        least = min(max(0.0, self._least() - slip), most)
        root = self._root()
        many = int(min(points, max(1000, WORK / (len(self.z) * (root.shape[1] + 10)))))
        if most - least <= self.total * bits / many:  # finer than samples see
            return Probability(0.5 * (least + most), least, most, 1.0, most)
        pilot, counts = self._counted(many // PILOT, root, rng), self._counted(many - many // PILOT, root, rng)
        apart = [self.base - self.total * part for part in _mean_between(pilot, counts, bits)]
        blur = BLURRED * self.total
        value, high, low = (min(max(p, least), most) for p in (apart[0], apart[1] + blur, apart[2] - blur))
        return Probability(value, low, high, 1.0 - doubt, most)

    def _least(self) -> float:
        """Proved lower limit from the constraints of one row."""
        tails, pairs = self.tails[self.single], self.pairs[np.ix_(self.single, self.single)]
        if not len(tails):
            return 0.0
        total, twice = float(tails.sum()), float(pairs.sum() - tails.sum())
        size = 1.0 + math.floor(twice / total)
        return max(float(tails.max()), (2.0 * total - twice / size) / (size + 1.0), float((tails * (tails / pairs.sum(axis=1))).sum()))

    def _root(self) -> Floats:
        """A matrix whose product with its transpose is the correlation, which may be singular."""
        values, vectors = np.linalg.eigh(self.correlation)
        kept = values > len(values) * np.finfo(float).eps
        return np.asarray(vectors[:, kept] * np.sqrt(values[kept]))

    def _counted(self, many: int, root: Floats, rng: "np.random.Generator") -> "Counts":
        """Worths of samples of the noise, given a failure, and how often each was drawn.

        With c constraints whose row fails, t edges of the tree between them, and a = 1 if one of them fails with all of its rows:
        (c - t - a) / c, whose mean is the part of the sum by which the tree's limit is too large. One sample of each of ``many`` equal
        parts of the probability: they are independent, and the mean of their means is the one sought.
        """
        ends, size = np.cumsum(self.tails), len(self.tails)
        counts = np.zeros((size + 1) * (size + 1), dtype=np.int64)
        portion = max(1, _PORTION // len(self.z))
        for begin in range(0, many, portion):
            k = np.arange(begin, min(many, begin + portion))
            column = k - begin
            at = (k + rng.random(len(k))) / many * ends[-1]
            drawn = np.minimum(np.searchsorted(ends, at, side="right"), size - 1)
            row = self.rows[drawn]
            tail = np.clip(at - (ends - self.tails)[drawn], 1e-300, self.tails[drawn])
            noise = root @ rng.standard_normal((root.shape[1], len(k)))
            noise += self.correlation[:, row] * (-ndtri(tail) - noise[row, column])
            beyond = noise > self.z[:, None]
            beyond[row, column] = True
            fails = beyond[self.rows]
            failing = fails.sum(axis=0)
            apart = failing.copy()
            for one, other in zip(*self.tree, strict=True):
                apart -= fails[one] & fails[other]
            apart -= 1 if self.single.all() else np.logical_and.reduceat(beyond, self.starts, axis=0).any(axis=0)
            counts += np.bincount(failing * (size + 1) + apart, minlength=len(counts))
        kinds = np.nonzero(counts)[0]
        return (kinds % (size + 1)) / (kinds // (size + 1)), counts[kinds].astype(np.float64)


Counts = tuple[Floats, Floats]
"""Numbers, and how often each."""


def _spanning_tree(pairs: Floats) -> tuple[Ints, Ints]:
    """Edges of a tree of the largest probabilities that both fail (Prim 1957)."""
    size = len(pairs)
    best, source, outside = pairs[0].copy(), np.zeros(size, dtype=np.int64), np.ones(size, dtype=bool)
    outside[0] = False
    one, other = np.zeros(size - 1, dtype=np.int64), np.zeros(size - 1, dtype=np.int64)
    for k in range(size - 1):
        new = int(np.argmax(np.where(outside, best, -1.0)))
        one[k], other[k], outside[new] = source[new], new, False
        better = pairs[new] > best
        best, source = np.where(better, pairs[new], best), np.where(better, new, source)
    return one, other


def _mean_between(pilot: Counts, counts: Counts, bits: float) -> tuple[float, float, float]:
    """Mean of numbers from 0 to 1, and limits that hold their expectation but with the probability 2 exp(-bits).

    Whoever stakes a fixed part of their capital on each number, at even odds if the expectation is m, is expected to end with what they
    began with, so that exp(bits) times as much is as rare as exp(-bits) (Markov): an m that would make them so rich is refused. The parts
    come from other numbers, the pilot's.
    """
    numbers, often = counts
    many, mean = float(often.sum()), float(numbers @ often / often.sum())
    first = float(pilot[0] @ pilot[1] / pilot[1].sum())
    spread = float((pilot[0] - first) ** 2 @ pilot[1] / pilot[1].sum()) + 1.0 / float(pilot[1].sum())
    bet = math.sqrt(2.0 * bits / (many * spread))
    down, up = min(bet, 0.9 / (first + 1.0 / float(pilot[1].sum()))), min(bet, 0.9)

    def loses(m: float, part: float) -> bool:
        return float(often @ np.log1p(part * (numbers - m))) > bits

    low = _last(lambda m: loses(m, down), 0.0, min(mean, (1.0 - 1e-9) / down))
    high = _last(lambda m: loses(m, -up), 1.0, mean)
    return mean, low, high


def _last(refused: Callable[[float], bool], begin: float, end: float) -> float:
    """About the last number from ``begin`` towards ``end`` that is refused; ``begin`` if it is not."""
    if not refused(begin):
        return begin
    for _ in range(60):
        middle = 0.5 * (begin + end)
        begin, end = (middle, end) if refused(middle) else (begin, middle)
    return begin
