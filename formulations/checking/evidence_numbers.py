"""Reading evidence: plain lists of finite numbers, or an error that says what is wrong."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...instances.errors import InputError
from ...instances.number_arrays import Floats


def number(data: Mapping[str, Any], key: str, default: float | None = None) -> float:
    """``data[key]`` as a finite float; ``default`` where the key is absent."""
    if key not in data and default is not None:
        return default
    return _finite(data.get(key), key)


def numbers(data: Mapping[str, Any], key: str, length: int) -> Floats:
    """``data[key]`` as a finite array of shape (length,); raises InputError for anything else.

    A list of all numbers, or ``{"at": [...], "values": [...]}`` with the positions and values of those that are not 0.
    """
    values = data.get(key)
    if isinstance(values, Mapping):
        return _sparse(values, key, length)
    if not isinstance(values, list | tuple):
        raise InputError(f"evidence lacks the list {key!r}", "missing", expected=f"{length} numbers", found=type(values).__name__)
    if len(values) != length:
        raise InputError(f"evidence list {key!r} has the wrong length", "wrong-shape", expected=str(length), found=str(len(values)))
    return _array(values, key)


def _sparse(given: Mapping[str, Any], key: str, length: int) -> Floats:
    at, values = given.get("at"), given.get("values")
    if given.keys() != {"at", "values"} or not isinstance(at, list) or not isinstance(values, list) or len(at) != len(values):
        raise InputError(f"evidence {key!r} is malformed", expected="lists at and values of one length")
    if not all(type(k) is int and 0 <= k < length for k in at) or len(set(at)) != len(at):
        raise InputError(f"evidence {key!r} names a position that does not exist, or twice", "unknown-name", expected=f"0 to {length - 1}")
    array = np.zeros(length)
    array[at] = _array(values, key)
    return array


def _array(values: Sequence[Any], key: str) -> Floats:
    if set(map(type, values)) <= {float}:
        array = np.array(values, dtype=np.float64)
        if np.isfinite(array).all():
            return array
    return np.array([_finite(value, key) for value in values], dtype=np.float64)


def _finite(value: object, key: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"evidence {key!r} must hold numbers", found=type(value).__name__)
    try:
        made = float(value)
    except OverflowError:
        made = math.inf
    if not math.isfinite(made):
        raise InputError(f"evidence {key!r} must hold finite numbers", "out-of-range", found=str(made))
    return made
