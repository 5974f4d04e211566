"""Columns of pandas frames that users hand over: checked titles, names and numbers."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .text import shown


def columns_of(what: str, frame: Any, known: Sequence[str], needed: Sequence[str]) -> dict[str, Any]:
    """Columns of a frame by title; raises InputError for what is no frame, and for unknown, repeated and missing titles."""
    if not hasattr(frame, "columns") or not hasattr(frame, "iloc"):
        raise InputError(f"{what} must be a pandas frame", found=type(frame).__name__)
    titles = [str(column) for column in frame.columns]
    for title in titles:
        if title not in known:
            raise InputError(f"column {title!r} of {what} is unknown", "unknown-name", expected=", ".join(known))
        if titles.count(title) > 1:
            raise InputError(f"column {title!r} of {what} stands twice", "duplicate")
    for title in needed:
        if title not in titles:
            raise InputError(
                f"{what} lacks the column {title!r}", "missing", expected=", ".join(known), found=", ".join(titles) or "no columns"
            )
    return {title: frame.iloc[:, k] for k, title in enumerate(titles)}


def numbers_of(what: str, title: str, column: Any) -> NDArray[np.float64]:
    """A column as numbers; raises InputError where it holds anything else."""
    import pandas as pd

    try:
        if (cells := pd.Series(column)).dtype.kind in "mM":
            raise TypeError("pandas takes moments and spans for nanoseconds")
        return np.array(pd.to_numeric(cells), dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"column {title!r} of {what} must hold numbers", found=shown(str(list(column[:3])))) from None


def name_of(cell: object) -> str:
    """The name that a cell holds: 3 and 3.0 are both the name "3", for an empty cell among whole numbers makes floats of them."""
    whole = isinstance(cell, float | np.floating) and float(cell).is_integer()
    return str(int(cell)) if whole else str(cell).strip()  # type: ignore[call-overload]
