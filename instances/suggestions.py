"""What a misspelt name may have been meant for."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

CLOSE = 0.7
"""Least ratio of ``difflib`` at which a name counts as misspelt."""


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The name of ``known`` that ``name`` is closest to, whatever its case; None where none is close."""
    folded = {other.casefold(): other for other in known}
    found = difflib.get_close_matches(name.casefold(), folded, n=1, cutoff=CLOSE)
    return folded[found[0]] if found else None


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """``; did you mean 'demand'?`` for the end of a message; empty where no name is close."""
    found = nearest(name, known)
    return "" if found is None else f"; did you mean {found!r}?"
