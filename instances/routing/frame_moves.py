"""Distances and durations from a frame with one row a move."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..clock import Times
from ..errors import InputError
from .foreign_names import hint, ours
from .frame_columns import id_text
from .sites import in_lines

Floats = NDArray[np.float64]
Ids = tuple[str, ...]

MOVES = ("from", "to", "distance", "duration")
"""Titles of a list of moves; durations may be missing."""
UNUSED = "columns of moves that are not used: "


def is_list(travel: Any, ids: Ids) -> bool:
    """Whether it is a frame of moves: its titles tell both ends of one, in our words or those of others, and are no sites."""
    if not hasattr(travel, "columns"):
        return False
    titles = [str(title) for title in travel.columns]
    own = {title.casefold() for title in titles}
    meant = {ours(title, "moves") for title in titles}
    return not set(titles) <= set(ids) and (bool({"from", "to"} & own) or {"from", "to"} <= meant)


def listed_moves(frame: Any, ids: Ids, times: Times) -> tuple[Floats, Floats | None, tuple[str, ...]]:
    """Distances, durations if there are any, and notes on unused columns; a pair of sites without a row is no move.

    Raises InputError for a column that is missing, or named as other toolkits name one that counts, and for rows that are no moves between
    the sites.
    """
    titles, idle = _titles(frame)
    index = {site: k for k, site in enumerate(ids)}
    ends = []
    for title in ("from", "to"):
        column = frame[titles[title]]
        if column.isna().any():
            row = int(np.argmax(np.asarray(column.isna()))) + 1
            raise InputError(f"row {row} of the moves has no {title}", expected="the id of a site")
        names = [id_text(v) for v in column.tolist()]
        strange = next((name for name in names if name not in index), None)
        if strange is not None:
            raise InputError(f"the list of moves names the unknown site {strange!r}", expected="an id of the sites")
        ends.append(np.array([index[name] for name in names], dtype=np.int64))
    place = ends[0] * len(ids) + ends[1]
    if len(np.unique(place)) < len(place):
        order = np.argsort(place, kind="stable")
        k = int(order[1:][np.diff(place[order]) == 0][0])
        raise InputError(f"the move from {ids[ends[0][k]]} to {ids[ends[1][k]]} stands twice in the list of moves")

    def square(values: Any, what: str) -> Floats:
        made = np.full(len(ids) ** 2, math.inf)
        made[place] = values
        matrix = made.reshape(len(ids), len(ids))
        np.fill_diagonal(matrix, 0.0)
        if (bad := ~(matrix >= 0)).any():
            i, j = np.argwhere(bad)[0].tolist()
            raise InputError(
                f"{what} of the move from {ids[i]} to {ids[j]} must be a number and not negative",
                expected="no row, or inf, for a move that cannot be made", found=str(matrix[i, j]),
            )  # fmt: skip
        return matrix

    try:
        lengths = np.asarray(frame[titles["distance"]], dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("column distance of the moves must hold numbers", found=str(error)) from None
    distances = square(lengths, "distance")
    durations = square(times.spans(frame[titles["duration"]], "column duration of the moves"), "duration") if "duration" in titles else None
    return distances, durations, in_lines(UNUSED, idle)


def _titles(frame: Any) -> tuple[dict[str, Any], list[str]]:
    """The frame's titles by ours, in any case, and those of columns that nobody uses."""
    found: dict[str, Any] = {}
    rest = []
    for title in frame.columns:
        own = str(title).casefold()
        if own not in MOVES:
            rest.append(str(title))
        elif own in found:
            raise InputError(f"columns {str(found[own])!r} and {str(title)!r} of the moves both tell {own}", expected="one of them")
        else:
            found[own] = title
    for title in rest:
        absent = [own for own in MOVES if own not in found]
        meant = ours(title, "moves")
        if meant is not None and meant in found:
            raise InputError(f"columns {str(found[meant])!r} and {title!r} of the moves both tell {meant}", expected="one of them")
        if told := hint(title, "moves", absent):
            expected = f"{', '.join(MOVES)}; leave out what shall not count"
            raise InputError(f"the moves have an unknown column {title!r}{told}", expected=expected)
    lacking = next((own for own in MOVES[:3] if own not in found), None)
    if lacking is not None:
        raise InputError(f"the moves have no column {lacking!r}", expected=", ".join(MOVES), found=", ".join(map(str, frame.columns))[:80])
    return found, rest
