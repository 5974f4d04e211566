"""Suggestions for misspelt names."""

import difflib
from collections.abc import Iterable

CLOSE = 0.7
"""Least ratio of ``difflib`` at which a name counts as misspelt."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The name of ``known`` that ``name`` is closest to, whatever its case; None where none is close."""
    folded = {other.casefold(): other for other in known}
    matches = difflib.get_close_matches(name.casefold(), folded, n=1, cutoff=CLOSE)
    return folded[matches[0]] if matches else None


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """``; did you mean 'demand'?`` for the end of a message; empty where no name is close."""
    match = nearest(name, known)
    return "" if match is None else f"; did you mean {match!r}?"
