"""Columns of a frame of sites: the meaning of each title, and the values below it."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..clock import Times
from ..errors import InputError
from ..number_arrays import Flags, Floats
from ..suggestions import did_you_mean, nearest
from ..text import shown
from .foreign_names import elsewhere, may_be_another_load, ours

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    "id", "x", "y", "lat", "lon", "node", "demand", "pickup", "ready", "due", "service", "reward", "required", "penalty", "depot", "skills",
)  # fmt: skip

ALIASES = {"latitude": "lat", "longitude": "lon", "lng": "lon", "long": "lon"}
"""Other spellings of titles, which can mean nothing else."""

NUMBERED = re.compile(r"(demand|pickup)[2-9]")
"""Titles of further loads."""


@dataclass
class Columns:
    """A frame of sites under waybound's titles: ``titles`` maps them to those of the frame, ``extra`` are kept and not used."""

    frame: pd.DataFrame
    titles: dict[str, Any]
    extra: tuple[Any, ...]
    ids: tuple[str, ...]
    depot: Flags = field(init=False)

    def __post_init__(self) -> None:
        self.depot = self.flags("depot") if "depot" in self.titles else np.arange(len(self.ids)) == 0

    def __contains__(self, title: str) -> bool:
        return title in self.titles

    def __getitem__(self, title: str) -> Any:
        return self.frame[self.titles[title]]

    def without(self, title: str) -> Columns:
        """A copy in which one more column is kept and not used."""
        others = {own: theirs for own, theirs in self.titles.items() if own != title}
        return Columns(self.frame, others, (*self.extra, self.titles[title]), self.ids)

    def reals(self, title: str) -> Floats:
        """Numbers; missing ones at a depot are 0, for nothing is done there."""
        try:
            values = np.array(self[title].to_numpy(dtype=np.float64, na_value=np.nan))
        except (TypeError, ValueError) as error:
            raise InputError(f"column {title} must hold numbers", found=str(error)) from None
        values[np.isnan(values) & self.depot] = 0.0
        return values

    def moments(self, title: str, times: Times, missing: float) -> Floats:
        """Points in time; ``missing`` where there is none."""
        moments = times.moments(self[title], f"column {title}")
        return np.where(np.isnan(moments), missing, moments)

    def spans(self, title: str, times: Times) -> Floats:
        """Lengths of time, 0 where there is none."""
        spans = times.spans(self[title], f"column {title}")
        return np.where(np.isnan(spans), 0.0, spans)

    def loads(self, title: str) -> Floats:
        """All load dimensions, shape (sites, dimensions), 0 for those without a column."""
        last = max([1, *(int(t[-1]) for t in self.titles if t[:-1] == title)])
        columns = [title, *(f"{title}{k}" for k in range(2, last + 1))]
        return np.column_stack([self.reals(c) if c in self else np.zeros(len(self.ids)) for c in columns])

    def flags(self, title: str) -> Flags:
        """Truth values; missing ones are true for ``required``, false for ``depot``."""
        flags = []
        for value in self[title].tolist():
            absent = value is None or value != value
            if not absent and value not in (True, False):
                raise InputError(f"column {title} must hold true and false", found=str(value))
            flags.append(title == "required" if absent else bool(value))
        return np.array(flags)

    def skills(self) -> dict[int, list[str]]:
        """Words that a site asks for, by its index."""
        return {k: words for k, value in enumerate(self["skills"].tolist()) if (words := words_of(value, "column skills"))}

    def attributes(self) -> dict[str, list[Any]]:
        """The other columns that are kept, as plain values."""
        return {str(title): [_plain(value) for value in self.frame[title].tolist()] for title in self.extra}


def pairs_of(text: str) -> dict[str, str]:
    """A mapping of titles from a text such as ``demand=crates, id=shop``."""
    pairs = [part.split("=") for part in text.split(",")]
    if any(len(pair) != 2 for pair in pairs):
        raise InputError("columns must pair titles", expected="demand=crates, id=shop", found=shown(text))
    return {own.strip(): theirs.strip() for own, theirs in pairs}


def columns_of(frame: pd.DataFrame, mapping: Mapping[Any, Any] | str | None, extra: Iterable[Any] | bool) -> Columns:
    """The columns of ``frame``; see ``instance_from_frame``."""
    import pandas as pd

    if not hasattr(frame, "columns"):
        raise InputError("sites must be a pandas frame, one row a site", expected="a DataFrame", found=type(frame).__name__)
    if len(frame) == 0:
        raise InputError("the frame has no rows", "missing")
    if frame.columns.nlevels > 1:
        raise InputError("titles of columns have several levels", "unsupported", expected="one: frame.columns.droplevel(0)")
    mapping = pairs_of(mapping) if isinstance(mapping, str) else mapping
    titles = list(frame.columns)
    if len(set(titles)) < len(titles):
        raise InputError(f"column {next(t for t in titles if titles.count(t) > 1)!r} stands twice", "duplicate")
    titles_by_own = mapped(titles, mapping or {})
    mapped_titles = {own for own in titles_by_own if mapping and own in {*mapping, *mapping.values()}}
    granted = titles if extra is True else [] if extra is False else list(extra)
    for title in granted:
        if title not in titles:
            message = f"extra names the column {title!r}, which is not there{did_you_mean(str(title), map(str, titles))}"
            raise InputError(message, "unknown-name")
    for exact in (True, False):
        for title in titles:
            own = own_title(title)
            if own is None or title in titles_by_own.values() or own in mapped_titles or (own == title) != exact:
                continue
            if not exact and title in granted and extra is not True:
                continue  # the user says that it does not count
            if own not in titles_by_own:
                titles_by_own[own] = title
            elif own in ALIASES.values():
                raise InputError(f"columns {titles_by_own[own]!r} and {title!r} both tell {own}", "ambiguous", expected="one of them")
    named = next((t for t in titles if str(t).casefold() == "name"), None)
    counted = isinstance(frame.index, pd.RangeIndex)
    if "id" not in titles_by_own and counted and named is not None:
        names = frame[named].tolist()
        if all(isinstance(name, str | int) for name in names) and len(set(names)) == len(names):
            titles_by_own["id"] = named
    for level in frame.index.names:  # an index holds ids alone
        own = None if level is None else own_title(level) or ours(str(level))
        if own not in (None, "id") and own not in titles_by_own:
            message = f"the index is called {shown(str(level))}, and columns alone tell {own}"
            raise InputError(message, "unsupported", expected="frame.reset_index()")
    used = set(titles_by_own.values())
    kept = [title for title in titles if title not in used]
    for title in kept:
        if title not in granted:
            _refuse_dropping(title, titles_by_own, mapped_titles, frame[title])
    return Columns(frame, titles_by_own, tuple(kept), _ids(frame, titles_by_own))


def own_title(title: Any) -> str | None:
    """Waybound's title, in whatever case it is written; None for any other."""
    plain = str(title).casefold()
    plain = ALIASES.get(plain, plain)
    return plain if known(plain) else None


def mapped(titles: list[Any], mapping: Mapping[Any, Any]) -> dict[str, Any]:
    """``mapping`` from waybound's titles to the frame's, whichever way round it is given."""
    if not isinstance(mapping, Mapping):
        raise InputError("columns must be a mapping of titles", expected="{'demand': 'crates'}", found=str(mapping)[:80])
    titles_by_own: dict[str, Any] = {}
    own: Any
    for one, other in mapping.items():
        own, theirs = (one, other) if known(one) else (other, one) if known(other) else (None, None)
        if own is None:
            pair = f"{one!r}: {other!r}"
            raise InputError(f"columns={{{pair}}} names no title of waybound", "unknown-name", expected=", ".join(COLUMNS), found=str(one))
        if theirs not in titles and own in titles and known(theirs):
            own, theirs = theirs, own
        if theirs not in titles:
            listed = ", ".join(map(str, titles[:12]))
            hint = did_you_mean(str(theirs), map(str, titles))
            message = f"columns maps {own!r} to the column {theirs!r}, which is not there{hint}"
            raise InputError(message, "unknown-name", found=f"columns {listed}")
        if own in titles_by_own:
            raise InputError(f"columns maps {own!r} twice", "duplicate", found=f"{titles_by_own[own]!r} and {theirs!r}")
        titles_by_own[own] = theirs
    return titles_by_own


def known(title: Any) -> bool:
    """True if it is one of waybound's titles."""
    return isinstance(title, str) and (title in COLUMNS or NUMBERED.fullmatch(title) is not None)


def _refuse_dropping(title: Any, titles_by_own: Mapping[str, Any], mapped_titles: Collection[str], values: pd.Series) -> None:
    """Raise InputError for a column that would not count, though its title says that it should: that of others, or a misspelt one.

    ``mapped_titles`` are those for which the user says which column counts.
    """
    text, column = str(title), f"column {shown(str(title))} is unknown"
    keep = f"extra=[{title!r}] to keep it only"
    own, instead = ours(text), elsewhere(text)
    if instead is None and _plain_words(text) == "location" and not all(isinstance(v, str) for v in values.dropna()):
        instead = elsewhere("coordinates")  # an address is no place to compute with
    if own is not None and own in titles_by_own and may_be_another_load(text):
        own = next((further for k in range(2, 10) if (further := f"{own.rstrip('23456789')}{k}") not in titles_by_own), own)
    own = own or own_title(title) or next((o for o in titles_by_own if _plain_words(text).rstrip("s") == o.rstrip("s")), None)
    if own is not None and own in titles_by_own:
        if own not in mapped_titles:
            cure = f"one of them, or extra=[{title!r}] to keep the other only"
            raise InputError(f"columns {titles_by_own[own]!r} and {title!r} both tell {own}", "ambiguous", expected=cure)
        return
    elsewhere_placed = (own in ("x", "y") and "lat" in titles_by_own) or (own in ("lat", "lon") and "x" in titles_by_own)
    meant = None if elsewhere_placed else own or _misspelt(text, titles_by_own)
    if meant is not None:
        message = f"{column}; did you mean {meant!r}?"
        raise InputError(message, "unknown-name", expected=f"columns={{{meant!r}: {title!r}}} to use it, {keep}")
    if instead is not None:
        raise InputError(f"{column}; {instead}", "unknown-name", expected=keep)


def _plain_words(title: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", title.casefold()).strip("_")


def _misspelt(title: str, titles_by_own: Mapping[str, Any]) -> str | None:
    """The known title, not there, that an unknown one is likely meant for."""
    plain = _plain_words(title)
    absent = [c for c in COLUMNS if c not in titles_by_own and len(c) > 2]
    long = [c for c in (*absent, *ALIASES) if len(c) > 4]  # short words are near to too many: a note is no node
    word = next((word for word in plain.split("_") if word in absent), None) or nearest(plain, long)
    return next((known for known in (word, ALIASES.get(word or "")) if known in absent), None)


def _ids(frame: pd.DataFrame, titles_by_own: Mapping[str, Any]) -> tuple[str, ...]:
    values = frame[titles_by_own["id"]] if "id" in titles_by_own else frame.index
    if values.ndim > 1 or getattr(values, "nlevels", 1) > 1:
        raise InputError("the index has several levels", "unsupported", expected="ids in one: a column id, or frame.reset_index()")
    if values.isna().any():
        raise InputError(f"row {int(np.argmax(np.asarray(values.isna()))) + 1} has no id", "missing", expected="a name in every row")
    return tuple(id_text(v) for v in values.tolist())


def id_text(value: Any) -> str:
    """An id as text; whole numbers that a missing value elsewhere made floats are whole again."""
    return str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)


def words_of(value: Any, what: str) -> list[str]:
    """Words with commas between, or a list of words; none where the value is missing."""
    if isinstance(value, str):
        return [word.strip() for word in value.split(",") if word.strip()]
    if isinstance(value, Iterable):
        return [str(word) for word in value]
    if value is not None and value == value:
        raise InputError(f"{what} must hold words with commas between", found=str(value))
    return []


def _plain(value: Any) -> Any:
    """A value as JSON has it; None where it is missing."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    import pandas as pd

    if value is None or value is pd.NA or value is pd.NaT or (isinstance(value, float) and math.isnan(value)):
        return None
    if isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return value.isoformat() if hasattr(value, "isoformat") else str(value)
