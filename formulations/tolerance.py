"""Tolerances: the one place that decides when numbers are within a limit, equal or closed, relative to the sizes compared.

Data multiplied by any power of two give the same verdicts. Nothing here is in units of the data.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

INTEGRALITY = 1e-5
"""Largest distance to an integer that a solver's point may have and still be read as an answer."""


LIMIT = 1e-11
"""Part of a limit by which a check lets it be exceeded, for the rounding of sums: 0.1 + 0.2 fits into 0.3. Whole numbers are compared
exactly."""

VECTOR = 1e-6
"""Part by which a solver's vector may break a row or a bound, as solvers count. Such an answer is priced at its nearest point that breaks
none, so that it gains nothing."""

EQUAL = 1e-9
"""Relative difference up to which two values count as the same: sums of the same numbers in another order differ by less."""

ROUNDING = 4.0 * float(np.finfo(np.float64).eps)
"""Rounding error of a term of a sum, relative to the largest number in it."""

_WHOLE = 2.0**53
"""Below it doubles hold every whole number, and sums of whole numbers are exact."""


def allowance(limit: ArrayLike, total: ArrayLike, size: ArrayLike = 0.0) -> NDArray[np.float64]:
    """Amount by which ``total`` may exceed ``limit`` and still count as within it.

    Parameters
    ----------
    limit, total : float or array
    size : float or array
        Of what was added up to ``total``, where it is larger than the limit.

    Returns
    -------
    array
        0 where both are whole numbers, ``LIMIT`` of the limit or of ``size`` elsewhere, 0 for infinite limits.
    """
    bound, value = np.asarray(limit, dtype=np.float64), np.asarray(total, dtype=np.float64)
    whole = (np.floor(bound) == bound) & (np.floor(value) == value) & (np.abs(bound) < _WHOLE) & (np.abs(value) < _WHOLE)
    return np.where(whole, 0.0, widening(bound, size))


def widening(limit: ArrayLike, size: ArrayLike = 0.0) -> NDArray[np.float64]:
    """Upper bound on the amount by which ``allowance`` lets a total exceed ``limit``: a bound has to concede that much."""
    most = np.maximum(np.abs(np.asarray(limit, dtype=np.float64)), size)
    return np.where(np.isfinite(most), LIMIT * most, 0.0)


def widened(limit: ArrayLike) -> NDArray[np.float64]:
    """The largest totals that may count as within ``limit``."""
    return np.asarray(limit, dtype=np.float64) + widening(limit)


def room(costs: ArrayLike, budget: float) -> float:
    """The largest sum of ``costs`` that counts as within ``budget``: the budget itself where all are whole numbers, else ``LIMIT`` more."""
    every = np.asarray(costs, dtype=np.float64)
    whole = bool((np.floor(every) == every).all()) and float(budget).is_integer() and max(float(every.sum()), budget) < _WHOLE
    return budget if whole else float(budget + widening(budget))


def same(a: float, b: float, size: float = 0.0, precision: float = EQUAL) -> bool:
    """Whether two values are equal but for rounding, ``size`` being that of the terms that were added up to either."""
    return a == b or abs(a - b) <= precision * max(abs(a), abs(b), size) < math.inf


def gap(objective: float, bound: float, size: float = 0.0, precision: float = EQUAL) -> float:
    """``|bound - objective|`` in parts of ``|objective|``, or of 1e-9 of the larger of ``bound`` and ``size`` where that is more.

    Where the two are the same, in parts of the larger of all three: then it is ``precision`` at most.
    """
    most = max(abs(bound), abs(objective), size)
    if bound == objective or most == 0.0:
        return 0.0
    apart = abs(bound / most - objective / most)  # in parts of the larger, so that nothing overflows or vanishes
    return apart if same(objective, bound, size, precision) else apart / max(abs(objective) / most, EQUAL)


def ratio(value: float, bound: float, size: float = 0.0, precision: float = EQUAL) -> float | None:
    """Worse over better, 1 where they are the same; None where their signs differ, one is 0, or the quotient is beyond all doubles."""
    if same(value, bound, size, precision):
        return 1.0
    better, worse = sorted((abs(value), abs(bound)))
    if better == 0.0 or (value > 0) != (bound > 0):
        return None
    with np.errstate(over="ignore"):
        quotient = float(np.float64(worse) / np.float64(better))
    return quotient if math.isfinite(quotient) else None
