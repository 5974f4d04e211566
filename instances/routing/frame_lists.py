"""Time windows, shipments and groups as users give them: lists and mappings, or frames with one row a window, a shipment, a member."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..clock import Times
from ..errors import InputError
from ..suggestions import did_you_mean
from .frame_columns import id_text
from .sites import Group, Shipment, Window

LOADS = ("load", *(f"load{k}" for k in range(2, 10)))
COLUMNS = {"windows": ("site", "ready", "due"), "shipments": ("pickup", "delivery", *LOADS), "groups": ("group", "site", "required")}
"""Titles of each frame; the first of windows, the first two of the others have to be there."""

Index = Mapping[str, int]


def see_windows(given: Any, times: Times) -> None:
    """Let the moments of windows count for the origin of time."""
    if hasattr(given, "columns"):
        for title in ("ready", "due"):
            if title in given.columns:
                times.see(given[title])
    else:
        times.see([list(listed) for listed in (given or {}).values()])


def windows_of(given: Any, index: Index, times: Times) -> dict[int, list[Window]]:
    """Windows by site index, of a mapping from ids to pairs or a frame; a missing end is no limit."""
    if hasattr(given, "columns"):
        rows, given = _rows(given, "windows"), {}
        for row in rows:
            given.setdefault(row["site"], []).append((row.get("ready"), row.get("due")))
    return {_at(site, index, "windows"): [_window(pair, str(site), times) for pair in listed] for site, listed in (given or {}).items()}


def _window(pair: Sequence[Any], site: str, times: Times) -> Window:
    if isinstance(pair, str) or len(pair) != 2:
        raise InputError(f"a window of {site} has an opening and a close", found=str(pair)[:80])
    opens, closes = (times.moment(end, f"window of {site}") for end in pair)
    return 0.0 if math.isnan(opens) else opens, math.inf if math.isnan(closes) else closes


def shipments_of(given: Any, index: Index) -> list[Shipment]:
    """Of pairs of ids, perhaps with a load, or of a frame."""
    if hasattr(given, "columns"):
        loads = [title for title in LOADS if title in given.columns]
        given = [
            (row["pickup"], row["delivery"], [0.0 if row[title] is None else row[title] for title in loads] or 0.0)
            for row in _rows(given, "shipments")
        ]
    made = []
    for one in given:
        if isinstance(one, str) or len(one) not in (2, 3):
            raise InputError("a shipment has a pickup, a delivery and perhaps a load", found=str(one)[:80])
        pickup, delivery = (_at(site, index, "shipments") for site in one[:2])
        try:
            made.append(Shipment(pickup, delivery, one[2] if len(one) == 3 else (0.0,)))
        except (TypeError, ValueError):
            raise InputError(f"load of the shipment from {one[0]} to {one[1]} must be a number", found=str(one[2])[:80]) from None
    return made


def groups_of(given: Any, index: Index) -> list[Group]:
    """Of lists of ids, or mappings with ``sites`` and ``required``, or of a frame."""
    if hasattr(given, "columns"):
        given = _groups(_rows(given, "groups"))
    made = []
    for one in given:
        members = one["sites"] if isinstance(one, Mapping) else one
        required = one.get("required", True) if isinstance(one, Mapping) else True
        made.append(Group(tuple(_at(site, index, "groups") for site in members), bool(required)))
    return made


def _groups(rows: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of one name are one group, required where nothing else is said in any of them."""
    made: dict[Any, dict[str, Any]] = {}
    for row in rows:
        held = made.setdefault(row["group"], {"sites": []})
        held["sites"].append(row["site"])
        said = row.get("required")
        if said is not None and said not in (True, False):
            raise InputError("column required of groups must hold true and false", found=str(said))
        if said is not None and held.setdefault("required", said) != said:
            raise InputError(f"group {row['group']} is required in one row and not in another", expected="one of them")
    return list(made.values())


def _rows(frame: Any, what: str) -> list[dict[str, Any]]:
    """The rows of a frame, None where a value is missing, and names as text."""
    import pandas as pd

    known, names = COLUMNS[what], COLUMNS[what][: 1 if what == "windows" else 2]
    for title in frame.columns:
        if title not in known:
            raise InputError(f"{what} have an unknown column {str(title)!r}{did_you_mean(str(title), known)}", expected=", ".join(known))
    lacking = next((title for title in names if title not in frame.columns), None)
    if lacking is not None:
        raise InputError(f"{what} have no column {lacking!r}", expected=", ".join(known))
    made = []
    for k, held in enumerate(frame.to_dict("records")):
        row = {str(key): None if pd.api.types.is_scalar(value) and pd.isna(value) else value for key, value in held.items()}
        for title in names:
            if row[title] in (None, ""):
                raise InputError(f"row {k} of {what} has no {title}", expected="a name in every row")
            row[title] = id_text(row[title])
        made.append(row)
    return made


def _at(site: Any, index: Index, what: str) -> int:
    if str(site) not in index:
        raise InputError(f"{what} name the unknown site {str(site)!r}{did_you_mean(str(site), index)}", expected="the id of a site")
    return index[str(site)]
