"""``check_submodular``: samples for diminishing returns of a set function, with a counterexample where it has none."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...formulations.sata.feasibility import CHUNK, allowed
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...instances.errors import UsageError
from ...instances.number_arrays import Flags as Masks, Integers
from ...instances.sata.constraints import Constraint
from ...instances.sata.set_functions import Floats, SetFunction, UserFunction

TOLERANCE = 1e-9
"""A gain may miss its side of an inequality by this share of the largest value seen: rounding is no violation."""

MOST_AT_ONCE = 1_000_000
"""Triples up to which all are tried instead of a sample."""


@dataclass(frozen=True)
class SubmodularityViolation:
    """Sets A within B and an element outside of B whose gains ``f(A + e) - f(A)`` and ``f(B + e) - f(B)`` break a property.

    ``submodular``: the gain over B is larger than that over A; ``monotone``: the gain over B is negative. Elements are counted from 0.
    """

    property: str
    a: tuple[int, ...]
    b: tuple[int, ...]
    element: int
    gain_a: float
    gain_b: float

    def __str__(self) -> str:
        if self.property == "monotone":
            return f"not monotone: element {self.element} changes the value of {_braces(self.b)} by {self.gain_b:.6g}"
        return (
            f"not submodular: element {self.element} adds {self.gain_a:.6g} to {_braces(self.a)}, but {self.gain_b:.6g} to "
            f"{_braces(self.b)}, which contains it"
        )


@dataclass(frozen=True)
class SubmodularityReport:
    """The result of ``check_submodular``; true where nothing speaks against either property.

    ``samples`` are the triples (A, B, e) that were looked at, and ``exhaustive`` tells that these were all that matter: then both
    properties are proved, but for rounding. ``violations`` holds the worst one of each property that is broken.
    """

    samples: int
    exhaustive: bool
    violations: tuple[SubmodularityViolation, ...] = field(default=())

    @property
    def submodular(self) -> bool:
        """True if no triple shows growing returns."""
        return all(v.property != "submodular" for v in self.violations)

    @property
    def monotone(self) -> bool:
        """True if no triple shows a loss."""
        return all(v.property != "monotone" for v in self.violations)

    def __bool__(self) -> bool:
        return not self.violations

    def __str__(self) -> str:
        if self.violations:
            return "; ".join(str(v) for v in self.violations)
        looked = f"all {self.samples}" if self.exhaustive else f"{self.samples} random"
        return f"no violation in {looked} triples"


def check_submodular(
    f: SubmodularSelection | SetFunction | Callable[[Masks], ArrayLike],
    elements: int | None = None,
    *,
    samples: int = 1000,
    seed: int = 1,
    constraint: Constraint | None = None,
) -> SubmodularityReport:
    """Look for sets A within B and an element e whose gain over B is larger than over A (or negative).

    Parameters
    ----------
    f : problem, set function or callable
        A callable gets a boolean array of shape (sets, elements) and returns the values, shape (sets,).
    elements : int, optional
        Size of the ground set; needed for a callable.
    samples : int
        Triples to draw. Where no more exist that matter (A, e, and B one element larger than A: together these decide), all are tried.
    seed : int
        Of the draws.
    constraint : Constraint, optional
        Only sets B + e that it allows are looked at.

    Returns
    -------
    SubmodularityReport
        It names the worst violating triple with its gains. That none was found proves nothing, unless all were tried.

    Raises
    ------
    UsageError
        For a callable without ``elements``, or numbers out of range.
    InputError
        If the function does not return one finite number a set.

    Notes
    -----
    Half of the triples have B = A and one more element, half any larger set. Source of the warning example (Cauchy-Schwarz quadratic
    mutual information, CSQMI): Mitchell (2020), chapter 3; docs/selection.md#is-it-submodular.
    """
    if isinstance(samples, bool) or not isinstance(samples, int | np.integer) or samples < 1:
        raise UsageError(f"samples must be a whole number of at least 1, not {samples!r}", "out-of-range")
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise UsageError(f"seed must be a whole number of at least 0, not {seed!r}", "out-of-range")
    values, n = _values_of(f, elements)
    if constraint is not None:
        constraint.check(n)
    rng, everything = np.random.default_rng(seed), n == 0 or (constraint is None and _number_of_adjacent(n) <= min(samples, MOST_AT_ONCE))
    worst: dict[str, tuple[float, SubmodularityViolation]] = {}
    looked, largest = 0, 1e-300
    step = int(samples) if everything else max(1, CHUNK // max(1, 8 * n))
    for first in range(0, int(samples), step):
        a, b, e = _all_adjacent(n) if everything else _triples(n, min(step, int(samples) - first), rng, constraint)
        if len(e) == 0:
            continue
        looked += len(e)
        every = np.arange(len(e))
        sets = [a, a.copy(), b, b.copy()]
        sets[1][every, e] = sets[3][every, e] = True
        fa, fae, fb, fbe = (values(s) for s in sets)
        gain_a, gain_b = fae - fa, fbe - fb
        largest = max(largest, *(float(np.abs(v).max()) for v in (fa, fae, fb, fbe)))
        for name, excess in (("submodular", gain_b - gain_a), ("monotone", -np.minimum(gain_a, gain_b))):
            k = int(np.argmax(excess))
            if name not in worst or excess[k] > worst[name][0]:
                # A loss is shown where it happens: at A, if that is where.
                at_a = name == "monotone" and gain_a[k] < gain_b[k]
                shown = _members((a if at_a else b)[k])
                gain = float((gain_a if at_a else gain_b)[k])
                worst[name] = float(excess[k]), SubmodularityViolation(name, _members(a[k]), shown, int(e[k]), float(gain_a[k]), gain)
    violations = tuple(violation for excess, violation in worst.values() if excess > TOLERANCE * largest)
    return SubmodularityReport(looked, everything, violations)


def _values_of(f: Any, elements: int | None) -> tuple[Callable[[Masks], Floats], int]:
    if isinstance(f, SubmodularSelection):
        f = f.function
    if not isinstance(f, SetFunction):
        if not callable(f):
            raise UsageError(
                f"check_submodular takes a problem, a set function or a callable over masks, not {type(f).__name__}", "malformed"
            )
        if isinstance(elements, bool) or not isinstance(elements, int | np.integer) or elements < 1:
            raise UsageError("elements must say how many elements the callable's masks have", "missing")
        f = UserFunction(f, int(elements))
    elif elements is not None and elements != f.num_elements:
        raise UsageError(f"the function has {f.num_elements} elements, not {elements!r}", "wrong-shape")
    whole, n = f.values, f.num_elements
    step = max(1, CHUNK // max(1, n))
    return lambda masks: np.concatenate([whole(masks[k : k + step]) for k in range(0, len(masks), step)]), n


def _number_of_adjacent(n: int) -> float:
    """Triples of A, one more element and e; for fewer than two elements one, {} and the only element."""
    return math.inf if n > 60 else n * (n - 1) * 2.0 ** (n - 2) if n > 1 else float(n)


def _triples(n: int, samples: int, rng: "np.random.Generator", constraint: Constraint | None) -> tuple[Masks, Masks, Integers]:
    # The first elements of a random order are B, the next is e, and some of the first are A.
    order = np.argsort(rng.random((samples, n)), axis=1)
    place = np.empty_like(order)
    np.put_along_axis(place, order, np.arange(n)[None, :], axis=1)
    room = np.full(samples, n) if constraint is None else _allowed(place, constraint)
    drawn = np.minimum(rng.integers(min(1, n - 1), n, samples), room - 1)
    keep = drawn >= 0
    order, place, drawn, count = order[keep], place[keep], drawn[keep], int(keep.sum())
    b = place < drawn[:, None]
    e = order[np.arange(count), drawn]
    smaller = np.where(rng.random(count) < 0.5, drawn - 1, np.floor(rng.random(count) * (drawn + 1)).astype(np.int64))
    a = place < np.maximum(smaller, 0)[:, None]
    return a, b, e


def _allowed(place: Integers, constraint: Constraint) -> Integers:
    """Number of the first elements of each order, given by their places in it, that the constraint allows together: by bisection."""
    low, high = np.zeros(len(place), dtype=np.int64), np.full(len(place), place.shape[1])
    while (low < high).any():
        middle = (low + high + 1) // 2
        fits = allowed(constraint, place < middle[:, None])
        low, high = np.where(fits, middle, low), np.where(fits, high, middle - 1)
    return low


def _all_adjacent(n: int) -> tuple[Masks, Masks, Integers]:
    """Every A, e outside of it, and B = A + one more element; with one element or none, the only triple there is."""
    if n < 2:
        return np.zeros((n, n), dtype=bool), np.zeros((n, n), dtype=bool), np.zeros(n, dtype=np.int64)
    bits = np.arange(1 << n)
    flags = (bits[:, None] >> np.arange(n)) & 1 == 1
    s, more, e = (v.ravel() for v in np.meshgrid(bits, np.arange(n), np.arange(n), indexing="ij"))
    keep = (more != e) & ~flags[s, more] & ~flags[s, e]
    s, more, e = s[keep], more[keep], e[keep]
    a = flags[s]
    b = a.copy()
    b[np.arange(len(s)), more] = True
    return a, b, e


def _members(mask: Masks) -> tuple[int, ...]:
    return tuple(np.nonzero(mask)[0].tolist())


def _braces(members: tuple[int, ...]) -> str:
    shown = ", ".join(str(m) for m in members[:10])
    return "{" + shown + (", ..." if len(members) > 10 else "") + "}"
