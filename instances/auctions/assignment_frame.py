"""Costs of robots and bins out of pandas frames: one row per pair, or a matrix."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..frames import name_of
from ..number_arrays import Floats, Integers
from ..suggestions import did_you_mean
from ..text import number, shown

if TYPE_CHECKING:
    import pandas as pd


COLUMNS = ("robot", "bin", "cost")
"""Titles of a table of pairs."""

FURTHER = {"filled": "bin", "robot-x": "robot", "robot-y": "robot", "bin-x": "bin", "bin-y": "bin"}
"""Columns that may be there, and of what they tell something: the same in every row of it."""

CORNERS = ("robot/bin", "robot", "robots")
"""Titles of a matrix's column that holds the names of its robots."""

ABSENT = ("", "-")
"""Texts of a cell that holds nothing."""

LAYOUTS = "columns robot, bin and cost, one row a pair, or one row a robot and one column of numbers a bin"


def arguments_of(frame: pd.DataFrame) -> tuple[bool, dict[str, Any]]:
    """True for a table of pairs, False for a matrix, with the arguments of ``from_pairs`` or ``from_matrix``."""
    if not hasattr(frame, "columns") or not hasattr(frame, "iloc"):
        raise InputError("costs must be a pandas frame", found=type(frame).__name__)
    index_names = [_title(name) for name in frame.index.names if name is not None]
    titles = [_title(title) for title in frame.columns]
    if set(index_names) & {"robot", "bin"} and _of_pairs([*index_names, *titles]):
        frame = frame.reset_index()
        titles = [_title(title) for title in frame.columns]
    return (True, _pairs(frame, titles)) if _of_pairs(titles) else (False, _matrix(frame, titles))


def _title(name: Any) -> str:
    return str(name).strip().lower().replace("_", "-")


def _of_pairs(titles: list[str]) -> bool:
    """Costs under a title of their own, or robots beside bins, are no matrix."""
    return "cost" in titles or {"robot", "bin"} <= set(titles)


def _pairs(frame: pd.DataFrame, titles: list[str]) -> dict[str, Any]:
    known = (*COLUMNS, *FURTHER)
    for k, title in enumerate(titles):
        if title in titles[:k]:
            raise InputError(f"column {title} stands twice", "duplicate", expected="different titles")
    for theirs, title in zip(frame.columns, titles, strict=True):
        if title not in known:
            lacking = [name for name in COLUMNS if name not in titles]
            cure = f"; rename it: there is no {' and no '.join(lacking)}" if lacking else "; leave it out"
            hint = did_you_mean(title, known)
            raise InputError(f"column {shown(str(theirs))} is unknown{hint or cure}", "unknown-name", expected=", ".join(known))
    for title in COLUMNS:
        if title not in titles:
            raise InputError(f"column {title} is missing", "missing", expected=", ".join(COLUMNS), found=", ".join(map(str, frame.columns)))
    columns = {title: frame.iloc[:, k] for k, title in enumerate(titles)}
    robots, robot_names = _numbered(columns["robot"])
    bins, bin_names = _numbered(columns["bin"])
    costs = _numbers("cost", columns["cost"])
    named = (robots >= 0) & (bins >= 0)
    for wrong, why, expected in (
        ((robots < 0) & (bins < 0), "names neither a robot nor a bin", "the names of both"),
        (named & np.isnan(costs), "has no cost", "a number, or infinity for a forbidden pair"),
        (~named & ~np.isnan(costs), "has a cost, and no pair of a robot and a bin", "the names of both"),
    ):
        if wrong.any():
            raise InputError(f"row {int(np.argmax(wrong)) + 1} {why}", "missing", expected=expected)
    owners = {"robot": (robots, robot_names), "bin": (bins, bin_names)}
    columns_of_owners = {title: _told(title, columns[title], *owners[what]) for title, what in FURTHER.items() if title in titles}
    arguments: dict[str, Any] = {"filled": columns_of_owners["filled"]} if "filled" in columns_of_owners else {}
    for what in ("robot", "bin"):
        x, y = columns_of_owners.get(f"{what}-x"), columns_of_owners.get(f"{what}-y")
        if (x is None) != (y is None):
            raise InputError(f"places of {what}s need both {what}-x and {what}-y", "missing", found=", ".join(map(str, frame.columns)))
        if x is not None and y is not None:
            arguments[f"{what}_positions"] = np.column_stack([x, y])
    return {
        "num_robots": len(robot_names), "num_bins": len(bin_names), "robots": robots[named], "bins": bins[named], "costs": costs[named],
        "robot_names": robot_names, "bin_names": bin_names, **arguments,
    }  # fmt: skip


def _numbered(column: Any) -> tuple[Integers, tuple[str, ...]]:
    """A number from 0 for each cell, as they first appear, -1 for none; and the names."""
    import pandas as pd

    codes, distinct = pd.factorize(column)
    place: dict[str, int] = {}
    at = [place.setdefault(name, len(place)) if (name := name_of(value)) else -1 for value in distinct]
    return np.array([*at, -1], dtype=np.int64)[codes], tuple(place)


def _numbers(title: str, column: Any, expected: str = "a number, or inf") -> Floats:
    """Numbers, NaN for cells that hold nothing; raises InputError for the first that is no number, by its row."""
    import pandas as pd

    if pd.api.types.is_numeric_dtype(column.dtype):
        return np.array(column.to_numpy(dtype=np.float64, na_value=np.nan))
    numbers = np.full(len(column), np.nan)
    for k, value in enumerate(column.tolist()):
        if isinstance(value, str):
            text = value.strip().lower()
            if text not in ABSENT:
                numbers[k] = math.inf if text == "inf" else _number(value, k, title, expected)
        elif not pd.isna(value):
            numbers[k] = _number(value, k, title, expected)
    return numbers


def _number(value: Any, row: int, title: str, expected: str) -> float:
    try:
        return number(value, row, title) if isinstance(value, str) else float(value)
    except (InputError, TypeError, ValueError, OverflowError):
        raise InputError(f"column {title} holds no number in row {row + 1}", expected=expected, found=shown(str(value))) from None


def _told(title: str, column: Any, owner: Integers, names: tuple[str, ...]) -> Floats:
    """One number per robot or bin, out of all its rows."""
    values = _numbers(title, column)
    numbers, row = np.full(len(names), np.nan), np.zeros(len(names), dtype=np.int64)
    for k in np.nonzero(owner >= 0)[0][::-1]:  # the first row of each stands last
        numbers[owner[k]], row[owner[k]] = values[k], k
    stray = (owner < 0) & ~np.isnan(values)
    if stray.any():
        raise InputError(
            f"{title} stands in row {int(np.argmax(stray)) + 1}, which names no {FURTHER[title]}", "contradiction", expected="an empty cell"
        )
    rows = np.nonzero(owner >= 0)[0]
    same = (values[rows] == numbers[owner[rows]]) & ~np.isnan(values[rows])
    if not same.all():
        k = int(rows[int(np.argmin(same))])
        what, first = f"{title} of {FURTHER[title]} {names[owner[k]]}", int(row[owner[k]])
        if np.isnan(values[k]):
            raise InputError(f"{what} is missing in row {k + 1}", "missing", expected="a number")
        raise InputError(
            f"{what} is another one in row {k + 1} than in row {first + 1}", "contradiction", expected=f"{numbers[owner[k]]:g}",
            found=f"{values[k]:g}",
        )  # fmt: skip
    return numbers


def _matrix(frame: pd.DataFrame, titles: list[str]) -> dict[str, Any]:
    corner = next((k for k, title in enumerate(titles) if title in CORNERS), 0 if titles and _is_text(frame.iloc[:, 0]) else None)
    kept = [k for k in range(len(titles)) if k != corner]
    costs = np.empty((len(frame), len(kept)))
    for at, k in enumerate(kept):
        costs[:, at] = _numbers(shown(str(frame.columns[k])), frame.iloc[:, k], LAYOUTS)
    costs[np.isnan(costs)] = math.inf  # a cell without a number forbids a pair, as in a file
    robots = frame.index if corner is None else frame.iloc[:, corner]
    return {"costs": costs, "robot_names": tuple(map(name_of, robots)), "bin_names": tuple(str(frame.columns[k]).strip() for k in kept)}


def _is_text(column: Any) -> bool:
    """True for a column of names: text alone, and not numbers or ``inf`` written as text."""
    values = [value.strip() if isinstance(value, str) else None for value in column.tolist()]
    if not values or None in values:
        return False
    return not all(_is_cost(value) for value in values if value is not None)


def _is_cost(text: str) -> bool:
    try:
        return text.lower() in (*ABSENT, "inf") or math.isfinite(number(text, 0, ""))
    except InputError:
        return False
