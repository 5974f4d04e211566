"""Cells of tables as a frame holds them: numbers, moments, lengths of time, truth values, and whatever else is kept."""

from __future__ import annotations

import contextlib
import datetime
import re
from typing import Any

from ...clock import ALIASES, SECONDS
from ...errors import InputError
from ...text import is_number, shown

FLAGS = {"1": True, "true": True, "yes": True, "0": False, "false": False, "no": False}

DAY = datetime.timedelta(days=1)

_DAY = re.compile(r"\d{4}-\d\d-\d\d")
_CLOCK = re.compile(r"(\d{1,2}):(\d\d)(?::(\d\d(?:\.\d{1,6})?))?\Z")
_SPAN = re.compile(r"(?:(\d{1,6}) days?,? )?(\d{1,6}):(\d\d):(\d\d(?:\.\d{1,9})?)\Z")
_PARTS = re.compile(r"(\d+(?:\.\d+)?)\s*([a-z]+)")
_LEADING = re.compile(r"[+-]?0\d")


def moment(cell: str, line: int | None, what: str) -> Any:
    """A point in time: a number, a time of day, or a timestamp; None where the cell is empty."""
    if not cell:
        return None
    if is_number(cell):
        return float(cell)
    try:
        if _DAY.match(cell):
            return datetime.datetime.fromisoformat(cell)
        if found := _CLOCK.match(cell):
            hours, minutes, seconds = int(found[1]), int(found[2]), float(found[3] or 0)
            whole = datetime.timedelta(hours=hours, minutes=minutes, seconds=seconds)
            if whole <= DAY and minutes < 60 and seconds < 60:
                return whole if whole == DAY else (datetime.datetime.min + whole).time()
    except ValueError:
        pass
    raise InputError(f"{what} must be a number or a moment", line=line, expected="480, 08:00 or 2026-05-04T08:00", found=shown(cell))


def span(cell: str, line: int | None, what: str) -> Any:
    """A length of time: a number or a timedelta; None where the cell is empty."""
    if not cell:
        return None
    if is_number(cell):
        return float(cell)
    with contextlib.suppress(OverflowError):  # longer than any calendar
        if found := _SPAN.match(cell):
            days, hours, minutes, seconds = int(found[1] or 0), int(found[2]), int(found[3]), float(found[4])
            return datetime.timedelta(days=days, hours=hours, minutes=minutes, seconds=seconds)
        parts = _PARTS.findall(cell.lower())
        units = [ALIASES.get(unit, unit) for _, unit in parts]
        if parts and not _PARTS.sub("", cell.lower()).strip() and set(units) <= SECONDS.keys():
            return datetime.timedelta(seconds=sum(float(size) * SECONDS[unit] for (size, _), unit in zip(parts, units, strict=True)))
    raise InputError(
        f"{what} must be a number or a length of time", line=line, expected="20, 20min, 1h 30min or 00:20:00", found=shown(cell)
    )


def flag(cell: str, line: int | None, what: str) -> bool | None:
    """A truth value; None where the cell is empty."""
    if cell and cell.lower() not in FLAGS:
        raise InputError(f"{what} must be true or false", line=line, expected=", ".join(FLAGS), found=shown(cell))
    return FLAGS[cell.lower()] if cell else None


def kept(cells: list[str]) -> list[Any]:
    """A column that is only kept: numbers where all of it are, and none is written as a code is (``007``); None where a cell is empty."""
    if all(is_number(cell) and not _LEADING.match(cell) for cell in cells if cell):
        return [None if not cell else int(cell) if cell.lstrip("+-").isdigit() and len(cell) < 16 else float(cell) for cell in cells]
    return [cell or None for cell in cells]
