"""Arrays of numbers as they come from a user: made of one type, and refused in one line where they hold what they must not."""

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]
Indices = NDArray[np.int32]
T = TypeVar("T", bound=np.generic)

LARGEST_NUMBER = 2**31 - 2
"""Largest number of anything that is counted: indices have 32 bits."""

MOST_UNUSED = 1_000_000
"""More things that nothing refers to than this are a slip, such as ids in place of numbers from 0, or a claim in a file."""


def whole_numbers(what: str, values: ArrayLike, expected: str | None = None) -> NDArray[np.int64]:
    """A list of whole numbers, of any type that holds them exactly, within 32 bits; ``expected`` is a hint for the message."""
    try:
        array = np.asarray(values)
    except ValueError:  # lists of different lengths
        raise InputError(f"{what} must be a list of whole numbers", expected=expected, found="lists of different lengths") from None
    if array.ndim != 1:
        raise InputError(f"{what} must be a list of whole numbers", "wrong-shape", expected=expected, found=f"shape {array.shape}")
    if array.size == 0:
        return np.zeros(0, dtype=np.int64)
    if array.dtype.kind == "O" and all(isinstance(v, int) and not isinstance(v, bool) for v in array.tolist()):
        raise InputError(f"{what} holds a number that is too large", "out-of-range", expected=f"at most {LARGEST_NUMBER}")
    if array.dtype.kind not in "iuf":
        raise InputError(f"{what} must be a list of whole numbers", expected=expected, found=repr(array.tolist()[0])[:40])
    if array.dtype.kind == "f" and not (np.isfinite(array).all() and (array == np.floor(array)).all()):
        wrong = ~np.isfinite(array) | (array != np.floor(array))
        raise InputError(
            f"{what} must be a list of whole numbers", "out-of-range", expected=expected, found=str(array[int(np.argmax(wrong))])
        )
    beyond = (array > LARGEST_NUMBER) | (array < -LARGEST_NUMBER)
    if beyond.any():
        found = str(array[int(np.argmax(beyond))])
        raise InputError(f"{what} holds a number that is too large", "out-of-range", expected=f"at most {LARGEST_NUMBER}", found=found)
    return array.astype(np.int64)


def indices(what: str, values: ArrayLike) -> Indices:
    """A list of whole numbers as 32-bit integers; one that is so already is not copied."""
    if isinstance(values, np.ndarray) and values.dtype == np.int32 and values.ndim == 1:
        return np.ascontiguousarray(values)
    return whole_numbers(what, values).astype(np.int32)


def reals(what: str, values: ArrayLike) -> Floats:
    """Numbers as float64; an array that is so already is not copied."""
    try:
        if isinstance(values, np.ndarray) and values.dtype.kind == "c":  # numpy would drop the imaginary parts
            raise TypeError
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what} must hold numbers", found=repr(values)[:40]) from None
    return np.ascontiguousarray(array) if array.ndim else array


BLOCK = 1 << 15
"""Numbers that are looked at together: few enough to stay in a processor's memory."""


class Spread(NamedTuple):
    """Least and largest of some numbers, 0 without any, and whether all are whole; an infinity or NaN among them is ``largest``."""

    least: float
    largest: float
    whole: bool


def spread(values: Floats) -> Spread:
    """``Spread`` of a list of numbers, in one sweep over the memory."""
    return _swept(values, values)


def copied(values: Floats) -> tuple[Floats, Spread]:
    """A copy as a list of numbers that cannot be written to, and its ``Spread``, in one sweep."""
    copy = np.empty(values.size)
    found = _swept(values.reshape(-1), copy)
    copy.setflags(write=False)
    return copy, found


def _swept(values: Floats, copy: Floats) -> Spread:
    """Fill in ``copy``, unless it is ``values``, and look at it block by block, up to the first that holds infinity or NaN."""
    if not values.size:
        return Spread(0.0, 0.0, True)
    least, largest, whole = math.inf, -math.inf, True
    for begin in range(0, values.size, BLOCK):
        some = copy[begin : begin + BLOCK]
        if copy is not values:
            some[:] = values[begin : begin + BLOCK]
        low, high = some.min(), some.max()
        if not high < math.inf:
            return Spread(float(low), float(high), False)
        least, largest = min(least, low), max(largest, high)
        whole = whole and bool((np.floor(some) == some).all())
    return Spread(float(least), float(largest), whole)


def unchanging(values: NDArray[Any]) -> bool:
    """Whether neither this array nor any that it is a view of can be written to."""
    array: Any = values
    while isinstance(array, np.ndarray) and not array.flags.writeable:
        if array.base is None:
            return True
        array = array.base
    return False


def frozen(values: NDArray[T]) -> NDArray[T]:
    """A view that cannot be written through; the caller's own array stays as it is."""
    view = values.view()
    view.setflags(write=False)
    return view


def size(what: str, value: Any) -> int:
    """Check a count, a whole number of at least 0."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not 0 <= value <= LARGEST_NUMBER:
        raise InputError(f"{what} must be a whole number from 0 to {LARGEST_NUMBER}", "out-of-range", found=repr(value)[:40])
    return int(value)


def refuse_unused(what: str, count: int, used: int, users: str) -> None:
    """Raise InputError if more than ``MOST_UNUSED`` of ``count`` entries are unused, before anything of that size is allocated."""
    if count - used > MOST_UNUSED:
        raise InputError(
            f"there are {count} {what}, but only {used} {users}", "too-large", expected=f"at most {MOST_UNUSED} more {what} than {users}"
        )


def _placed(what: str, k: int) -> str:
    """``what`` with the place ``k``: rows and entries are counted from 1, as lines of a file are; in brackets as programs count."""
    return what.format(k if "[{}]" in what else k + 1)


def refuse_outside(what: str, values: NDArray[Any], count: int, thing: str) -> None:
    """Raise InputError for the first of ``values`` that is not from 0 to ``count`` - 1; ``what`` has a place for its position."""
    if values.size and not (values.min() >= 0 and values.max() < count):
        k = int(np.argmax((values < 0) | (values >= count)))
        expected = f"0 to {count - 1}" if count else f"none, for there is no {thing}"
        raise InputError(f"{_placed(what, k)} does not exist", "unknown-name", expected=expected, found=str(values[k]))


def refuse_negative(what: str, values: Floats) -> None:
    """Raise InputError for the first of ``values`` that is negative, infinite or NaN; ``what`` has a place for its position."""
    wrong = ~(values >= 0) | np.isinf(values)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(f"{_placed(what, k)} must be finite and not negative", "out-of-range", found=str(values[k]))


def refuse_overflow(what: str, values: NDArray[Any]) -> None:
    """Raise InputError where the sum of ``values`` >= 0, which some answer may be worth, exceeds all floating-point numbers."""
    if values.size and not math.isfinite(float(values.max()) * values.size):
        with np.errstate(over="ignore"):
            total = float(values.sum(dtype=np.float64))
        if not math.isfinite(total * 1.5):  # for sums in another order, and bounds above them
            raise InputError(f"{what} add up to more than a floating-point number can hold", "out-of-range",
                             expected="a sum below 1e308", found=f"{total:g}")  # fmt: skip


def check_csr(indptr: Indices, columns: Indices, count: int, row: str, column: str, entries: str) -> None:
    """Raise InputError unless the arrays are rows of ascending numbers from 0 to ``count`` - 1, none twice in a row.

    ``row``, ``column`` and ``entries`` say what they are, for the message: action, target, edges.
    """
    if not len(indptr) or indptr[0] != 0 or indptr[-1] != len(columns) or (np.diff(indptr) < 0).any():
        raise InputError(f"the starts of the {row}s do not ascend from 0 to the number of {entries}")
    refuse_outside(f"{column} of entry {{}}", columns, count, column)
    falls = columns[1:] <= columns[:-1]
    starts = indptr[1:-1]
    falls[starts[(starts > 0) & (starts < len(columns))] - 1] = False  # from one row to the next
    if falls.any():
        raise InputError(f"the {column}s of each {row} must ascend, none twice")


def row_starts(rows: NDArray[np.integer[Any]], count: int) -> NDArray[np.int64]:
    """Starts of ``count`` rows of a CSR matrix, and the number of entries, from the row of each entry."""
    return np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=count))])


def entries_of(indptr: NDArray[np.integer[Any]], rows: NDArray[np.integer[Any]]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Places of all entries of some rows of a CSR matrix, row after row, and how many each row has."""
    counts = (indptr[rows + 1] - indptr[rows]).astype(np.int64)
    before = np.cumsum(counts) - counts
    return np.repeat(indptr[rows] - before, counts) + np.arange(int(counts.sum())), counts


def names(what: str, values: Iterable[object] | None, count: int) -> tuple[str, ...] | None:
    """Check names: one per entry, printable and all different; None stays None."""
    if values is None:
        return None
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise InputError(f"the names of {_several(what)} must be a list", found=repr(values)[:40])
    labels = tuple(str(g) for g in values)
    if len(labels) != count:
        raise InputError(f"there must be one name for each {what}", "wrong-shape", expected=str(count), found=str(len(labels)))
    for name in labels:
        if not name or not name.isprintable() or name != name.strip():
            raise InputError(f"the name of each {what} must be printable, not empty, without blanks at its ends", found=ascii(name)[:40])
    if len(set(labels)) != count:
        seen: set[str] = set()
        twice = next(n for n in labels if n in seen or seen.add(n))  # type: ignore[func-returns-value]
        raise InputError(f"two {_several(what)} have the name {twice!r}", "duplicate", expected="different names")
    return labels


def _several(thing: str) -> str:
    return "vertices" if thing == "vertex" else f"{thing}s"


def positions(what: str, points: ArrayLike | None, count: int, known: Sequence[str] | None = None, dimensions: int = 2) -> Floats | None:
    """Places, one each, as an array of shape (count, 2), or (count, 3) where that many ``dimensions`` are allowed; None stays None.

    ``known`` are names for messages.
    """
    if points is None:
        return None
    places = reals(f"{what} positions", points)
    if places.ndim != 2 or len(places) != count or not 2 <= places.shape[1] <= dimensions:
        several = "two" if dimensions == 2 else "two or three"
        raise InputError(
            f"{what} positions must be {several} numbers each", "wrong-shape", expected=f"({count}, 2)", found=str(places.shape)
        )
    wrong = ~np.isfinite(places).all(axis=1)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(
            f"the position of {what} {k + 1 if known is None else known[k]} must be finite", "out-of-range", found=str(places[k])
        )
    return frozen(places.copy())
