"""Time windows, shipments and groups as users give them: lists and mappings, or frames with one row per window, a shipment, a member."""

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import numpy as np

from ..clock import Times
from ..errors import InputError
from ..suggestions import did_you_mean
from .foreign_names import hint
from .frame_columns import id_text
from .sites import Group, Shipment, Window

LOADS = ("load", *(f"load{k}" for k in range(2, 10)))
COLUMNS = {"windows": ("site", "ready", "due"), "shipments": ("pickup", "delivery", *LOADS), "groups": ("group", "site", "required")}
"""Titles of each frame; the first of windows, the first two of the others have to be there."""

Index = Mapping[str, int]

READ_FROM = "waybound.read_from"
"""Attribute of a frame out of a file: the file, and the lines of its titles and of each row."""


@contextmanager
def placed(frame: Any, row: int = -1) -> Iterator[None]:
    """Errors inside get the file of a frame that was read from one, with the line of ``row``, or of the titles."""
    try:
        yield
    except InputError as error:
        file, lines = getattr(frame, "attrs", {}).get(READ_FROM, (None, None))
        raise error if lines is None else error.at(file, lines[row + 1]) from None


def see_windows(windows: Any, times: Times) -> None:
    """Let the moments of windows count for the origin of time."""
    if hasattr(windows, "columns"):
        for title in ("ready", "due"):
            if title in windows.columns:
                times.see(windows[title])
    else:
        times.see(list(_by_site(windows).values()))


def windows_of(windows: Any, index: Index, times: Times) -> dict[int, list[Window]]:
    """Windows by site index, from a mapping of ids to pairs or a frame; a missing end is no limit."""
    if not hasattr(windows, "columns"):
        return {
            _at(site, index, "windows"): [_window(pair, str(site), times) for pair in _listed(listed, f"windows of {site}", "[(0, 4)]")]
            for site, listed in _by_site(windows).items()
        }
    windows_by_site: dict[int, list[tuple[Window, int]]] = {}
    for k, row in enumerate(_rows(windows, "windows")):
        with placed(windows, k):
            window = _window((row.get("ready"), row.get("due")), row["site"], times)
            if window[0] > window[1]:
                raise InputError(f"a window of {row['site']} closes before it opens", "contradiction", found=str(window))
            windows_by_site.setdefault(_at(row["site"], index, "windows"), []).append((window, k))
    names = list(index)
    for site, held in windows_by_site.items():
        for (one, _), (after, k) in pairwise(sorted(held)):
            with placed(windows, k):
                if after[0] <= one[1]:
                    raise InputError(f"windows of {names[site]} are not apart from each other", "contradiction", found=f"{one} and {after}")
    return {site: [window for window, _ in held] for site, held in windows_by_site.items()}


def _by_site(windows: Any) -> Mapping[Any, Any]:
    if windows is not None and not isinstance(windows, Mapping):
        raise InputError("windows must be a mapping or a frame", expected="{'a': [(0, 4), (9, 20)]}", found=str(windows)[:80])
    return windows or {}


def _listed(entries: Any, what: str, expected: str) -> list[Any]:
    """The entries of a list or any other iterable; None has none."""
    if isinstance(entries, str | Mapping) or not isinstance(entries, Iterable | None):
        raise InputError(f"{what} must be a list", expected=expected, found=str(entries)[:80])
    return [] if entries is None else list(entries)


def _window(pair: Any, site: str, times: Times) -> Window:
    ends = () if isinstance(pair, str) or not isinstance(pair, Iterable) else tuple(pair)
    if len(ends) != 2:
        raise InputError(f"a window of {site} has an opening and a close", found=str(pair)[:80])
    opens, closes = (times.moment(end, f"window of {site}") for end in ends)
    return 0.0 if math.isnan(opens) else opens, math.inf if math.isnan(closes) else closes


def shipments_of(shipments: Any, index: Index) -> list[Shipment]:
    """Shipments from pairs of ids, perhaps with a load, or from a frame."""
    if hasattr(shipments, "columns"):
        loads = LOADS[: max((k for k, title in enumerate(LOADS, start=1) if title in shipments.columns), default=0)]
        listed: list[Any] = [
            (row["pickup"], row["delivery"], [0.0 if row.get(title) is None else row[title] for title in loads] or 0.0)
            for row in _rows(shipments, "shipments")
        ]
    else:
        listed = _listed(shipments, "shipments", "[('a', 'b', 2)], or a frame")
    read = []
    for k, one in enumerate(listed):
        with placed(shipments, k):
            read.append(_shipment(one, index))
    return read


def _shipment(one: Any, index: Index) -> Shipment:
    parts = () if isinstance(one, str) or not isinstance(one, Iterable) else tuple(one)
    if len(parts) not in (2, 3):
        raise InputError("a shipment has a pickup, a delivery and perhaps a load", found=str(one)[:80])
    pickup, delivery = (_at(site, index, "shipments") for site in parts[:2])
    try:
        return Shipment(pickup, delivery, parts[2] if len(parts) == 3 else (0.0,))
    except (TypeError, ValueError):
        raise InputError(f"load of the shipment from {parts[0]} to {parts[1]} must be a number", found=str(parts[2])[:80]) from None


def groups_of(groups: Any, index: Index) -> list[Group]:
    """Groups from lists of ids, from mappings with ``sites`` and ``required``, or from a frame."""
    if hasattr(groups, "columns"):
        return _groups(groups, index)
    read = []
    for one in _listed(groups, "groups", "[['a', 'b']], or a frame"):
        if isinstance(one, Mapping) and not {"sites"} <= one.keys() <= {"sites", "required"}:
            expected = "{'sites': ['a', 'b'], 'required': False}"
            raise InputError("a group has sites and perhaps required", expected=expected, found=str(one)[:80])
        members, required = (one["sites"], one.get("required", True)) if isinstance(one, Mapping) else (one, True)
        if not isinstance(required, bool | np.bool_):
            raise InputError("required of a group must be True or False", found=repr(required)[:80])
        sites = (_at(site, index, "groups") for site in _listed(members, "sites of a group", "['a', 'b']"))
        read.append(Group(tuple(sites), bool(required)))
    return read


def _groups(frame: Any, index: Index) -> list[Group]:
    """Groups from a frame: rows of one name, required unless one of them says otherwise."""
    sites: dict[str, list[int]] = {}
    required: dict[str, bool] = {}
    for k, row in enumerate(_rows(frame, "groups")):
        with placed(frame, k):
            group, said = row["group"], row.get("required")
            sites.setdefault(group, []).append(_at(row["site"], index, "groups"))
            if said is not None and said not in (True, False):
                raise InputError("column required of groups must hold true and false", found=str(said))
            if said is not None and required.setdefault(group, bool(said)) != said:
                raise InputError(f"group {group} is required in one row and not in another", "contradiction", expected="one of them")
    return [Group(tuple(members), required.get(group, True)) for group, members in sites.items()]


def _rows(frame: Any, what: str) -> list[dict[str, Any]]:
    """The rows of a frame, None where a value is missing, and names as text."""
    import pandas as pd

    known, names = COLUMNS[what], COLUMNS[what][: 1 if what == "windows" else 2]
    with placed(frame):
        for title in frame.columns:
            if title not in known:
                message = f"{what} have an unknown column {str(title)!r}{hint(str(title), what, known)}"
                raise InputError(message, "unknown-name", expected=", ".join(known))
        lacking = next((title for title in names if title not in frame.columns), None)
        if lacking is not None:
            raise InputError(f"{what} have no column {lacking!r}", "missing", expected=", ".join(known))
        if what == "windows" and not {"ready", "due"} & set(frame.columns):
            raise InputError("windows have neither a column 'ready' nor 'due'", "missing", expected=", ".join(known))
    rows = []
    for k, held in enumerate(frame.to_dict("records")):
        row = {str(key): None if pd.api.types.is_scalar(value) and pd.isna(value) else value for key, value in held.items()}
        for title in names:
            if row[title] in (None, ""):
                raise InputError(f"row {k + 1} of {what} has no {title}", "missing", expected="a name in every row")
            row[title] = id_text(row[title])
        rows.append(row)
    return rows


def _at(site: Any, index: Index, what: str) -> int:
    if str(site) not in index:
        message = f"{what} name the unknown site {str(site)!r}{did_you_mean(str(site), index)}"
        raise InputError(message, "unknown-name", expected="the id of a site")
    return index[str(site)]
