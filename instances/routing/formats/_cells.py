"""Cells of tables as a frame holds them: numbers, moments, lengths of time, truth values, and whatever else is kept."""

from __future__ import annotations

import re
from typing import Any

from ...clock import moment_of as moment
from ...clock import span_of as span
from ...errors import InputError
from ...text import is_number, shown

__all__ = ["flag", "kept", "moment", "span"]

FLAGS = {"1": True, "true": True, "yes": True, "0": False, "false": False, "no": False}

_LEADING = re.compile(r"[+-]?0\d")


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
