"""References to things by name or index, as users write them."""

import sys
from collections.abc import Iterable, Mapping
from operator import index as whole
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..instances.errors import InputError, UsageError
from ..instances.number_arrays import reals
from ..instances.printable import printable
from ..instances.text import an


def indices_of(given: Iterable[Any], names: Mapping[str, int], thing: str) -> list[int]:
    """Indices of the things meant: text is a name; whole numbers are all indices, or all names where they cannot be indices.

    ``names``: from name to index. ``thing``: what they are, for the message. Raises UsageError for what is neither or does not exist, and
    for whole numbers that could be both and would mean different things.
    """
    every = list(given)
    numbers: list[int] = []
    for item in every:
        if isinstance(item, str):
            if item not in names:
                raise UsageError(f"there is no {thing} {printable(item, 80)!r}", "unknown-name")
            continue
        try:
            if isinstance(item, bool):
                raise TypeError
            numbers.append(whole(item))
        except TypeError:
            raise UsageError(f"{an(thing)} is given by its name or its index, not by {printable(repr(item), 80)}", "malformed") from None
    named = [names.get(str(number), -1) for number in numbers]
    counts = all(0 <= number < len(names) for number in numbers)
    if not counts and -1 in named:
        raise UsageError(f"there is no {thing} {numbers[named.index(-1)]}", "unknown-name")
    if counts and -1 not in named and named != numbers:
        raise UsageError(f"whole numbers could be names or indices of {thing}s here, which differ; give names as text", "ambiguous")
    meant = iter(numbers if counts else named)
    return [names[item] if isinstance(item, str) else next(meant) for item in every]


def is_number(value: object) -> bool:
    """Whether a value out of JSON is a number that a double can hold."""
    return isinstance(value, float) or (isinstance(value, int) and not isinstance(value, bool) and abs(value) <= sys.float_info.max)


def vector_of(given: Any) -> NDArray[np.float64]:
    """The numbers in a list or an array; of shape (0, 0), which no vector has, where there are none."""
    try:
        return reals("an answer", given)
    except InputError:
        return np.zeros((0, 0))
