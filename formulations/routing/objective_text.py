"""Objectives as text: ``vehicles then total-cost``, ``total-cost - 2*reward``."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from ...instances.errors import UsageError
from ...instances.printable import printable
from ...instances.suggestions import did_you_mean
from .objective import TERMS, Objective, Weighted

_PART = re.compile(
    r"\s*(?:(?P<weight>(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)|(?P<term>[a-z]+(?:[-_][a-z]+)*)|(?P<sign>[+-])|(?P<times>\*)|(?P<other>\S))",
    re.IGNORECASE,
)
_THEN = re.compile(r"\s*,?\s*\bthen\b\s*", re.IGNORECASE)


def objective_from(text: str) -> Objective:
    """The objective that a text says.

    Parameters
    ----------
    text : str
        Levels in order of priority, with ``then`` between them. A level is a sum of terms (``TERMS``), each with a weight before it where
        that is not 1: ``total-cost - 2*reward``. Its sense is that of its first term: costs are minimised, rewards maximised.

    Raises
    ------
    UsageError
        Naming what is wrong, and the term that may have been meant.
    """
    return Objective(tuple(_level(part, text) for part in _THEN.split(text.strip())))


def _level(part: str, text: str) -> Weighted:
    if not part.strip():
        raise UsageError(
            f"objective {_quoted(text)}: a level is empty; write terms such as {', '.join(list(TERMS)[:3])}, with then between levels"
        )
    found: list[tuple[float, str]] = []
    sign, weight, times, signed, leading = 1.0, None, False, True, True
    for kind, word in _parts(part):
        if kind == "sign" and (leading or not signed):
            sign, signed = -1.0 if word == "-" else 1.0, True
        elif kind == "weight" and weight is None and signed:
            weight = float(word)
        elif kind == "times" and weight is not None and not times:
            times = True
        elif kind == "term" and signed:
            found.append((sign * (1.0 if weight is None else weight), _known(word, text)))
            sign, weight, times, signed = 1.0, None, False, False
        else:
            raise UsageError(f"objective {_quoted(text)}: {_quoted(word)} is not expected there; write sums such as total-cost - 2*reward")
        leading = False
    if signed or weight is not None:
        raise UsageError(f"objective {_quoted(text)}: {_quoted(part)} ends without a term")
    names = [name for _, name in found]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"objective {_quoted(text)}: {name} stands twice in one level")
    for weight, name in found:
        if weight == 0 or not math.isfinite(weight):
            raise UsageError(f"objective {_quoted(text)}: the weight of {name} must be finite and not zero")
    return Weighted(tuple((weight, TERMS[name]()) for weight, name in found))


def _parts(level: str) -> Iterator[tuple[str, str]]:
    for match in _PART.finditer(level):
        yield str(match.lastgroup), str(match.group(str(match.lastgroup)))


def _known(word: str, text: str) -> str:
    name = word.lower().replace("_", "-")
    if name in TERMS:
        return name
    for term in TERMS:
        rest = name.removeprefix(f"{term}-")
        if rest in TERMS:
            raise UsageError(f"objective {_quoted(text)}: write blanks around - and +: {term} - {rest}")
    hint = did_you_mean(name, TERMS) or f"; choose from {', '.join(TERMS)}"
    raise UsageError(f"objective {_quoted(text)}: there is no term {_quoted(word)}{hint}")


def _quoted(text: str) -> str:
    return repr(printable(text.strip(), 80))
