"""Arguments of ``from_frame`` that are one number or one text: anything else is refused in one line, before anything is made of it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from ..errors import InputError


def text_given(value: Any, what: str) -> str:
    """A text."""
    if not isinstance(value, str):
        raise InputError(f"{what} must be a text", found=repr(value)[:60])
    return value


def number_given(value: Any, what: str) -> float:
    """A number; what it may be is checked where it is used."""
    try:
        if not isinstance(value, str | bytes):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{what} must be a number", found=repr(value)[:60])


def whole_given(value: Any, what: str) -> int:
    """A whole number."""
    made = math.nan if isinstance(value, bool) else number_given(value, what)
    if not made.is_integer():
        raise InputError(f"{what} must be whole", found=repr(value)[:60])
    return int(made)


def loads_given(value: Any, what: str) -> list[float]:
    """One number, or one a load dimension."""
    several = isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)
    made = [number_given(each, what) for each in value] if several else [number_given(value, what)]
    if not made:
        raise InputError(f"{what} is empty", expected="one number a load dimension")
    return made


def titles_given(value: Any, what: str) -> list[Any] | bool:
    """Titles, or whether all are meant."""
    if isinstance(value, str):
        return [value]
    if not isinstance(value, bool) and (not isinstance(value, Iterable) or isinstance(value, bytes)):
        raise InputError(f"{what} must be a list of titles, or True", found=repr(value)[:60])
    return value if isinstance(value, bool) else list(value)
