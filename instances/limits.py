"""Upper limits of the numbers that users set: larger ones are slips of the keyboard, refused before anything starts."""

from numbers import Integral, Real
from typing import Any

from .errors import UsageError

MOST: dict[str, float] = {
    "time_limit": 1e9,  # seconds: 31 years, and what locks and timers can wait for
    "bound_time": 1e9,
    "memory_limit": 1e9,  # MB: a petabyte
    "gap": 1e9,
    "iterations": 2**31 - 1,  # what solvers count in
    "no_improvement": 2**31 - 1,
    "steps": 2**31 - 1,
    "instances": 2**31 - 1,
    "seed": 2**63 - 1,
    "threads": 1024,
    "overtime": 1e9,  # seconds
    "jobs": 1024,
}
"""Largest value of each number that a user may set."""


def check_number(name: str, value: Any, *, above: float | None = None, option: str | None = None) -> None:
    """Raise UsageError, which says ``option`` or ``name``, unless ``value`` is a number from 0, or above ``above``, to ``MOST[name]``."""
    said = option or name
    if isinstance(value, bool) or not issubclass(type(value), Real) or not (value >= 0 if above is None else value > above):
        raise UsageError(f"{said} must be {'not negative' if above is None else 'positive'}, not {value!r}", "out-of-range")
    if value > MOST[name]:
        raise UsageError(f"{said} must be at most {MOST[name]:g}, not {_short(value)}", "out-of-range")


def check_whole(name: str, value: Any, *, least: int = 0, option: str | None = None) -> None:
    """Raise UsageError unless ``value`` is a whole number between ``least`` and ``MOST[name]``; see ``check_number``."""
    if isinstance(value, bool) or not issubclass(type(value), Integral) or not least <= value <= MOST[name]:
        raise UsageError(f"{option or name} must be a whole number between {least} and {MOST[name]}, not {_short(value)}", "out-of-range")


def _short(value: Any) -> str:
    return f"a number of {value.bit_length()} bits" if isinstance(value, int) and value.bit_length() > 400 else repr(value)
