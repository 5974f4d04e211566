"""Options of one solver only, beside those that all share."""

from collections.abc import Mapping
from typing import Any

from ..instances.errors import UsageError
from ..instances.suggestions import did_you_mean
from ..instances.text import an

FEW = 12
"""Up to as many options are listed where one is not known; of more, the closest."""

TRUTHS = {"true": True, "on": True, "1": True, "false": False, "off": False, "0": False}


def own_options(
    label: str, given: Mapping[str, Any], known: Mapping[str, Any], common: Mapping[str, str] | None = None, word: str = "option"
) -> dict[str, Any]:
    """The user's options, mostly text, converted to the types of their defaults in ``known``; None there takes any.

    ``label`` is the solver's name in messages, ``word`` what it calls an option; ``common`` are names that stand for an option that all
    solvers share, and what that is called. Raises UsageError for the first one that is common, not known, or not of its type.
    """
    options = {}
    for name, value in given.items():
        if common and name in common:
            raise UsageError(f"{label}: set {common[name]} by its own option, not by {name}")
        if name not in known:
            raise UsageError(f"{label} has no {word} {name!r}{_hint(name, known)}", "unknown-name")
        kind = type(known[name])
        try:
            options[name] = value if known[name] is None else _converted(value, kind)
        except (KeyError, TypeError, ValueError, OverflowError):
            raise UsageError(f"{label}: {word} {name} takes {an(WORDS.get(kind, kind.__name__))}, not {value!r}", "malformed") from None
    return options


WORDS: dict[type, str] = {bool: "truth value", int: "whole number", float: "number", str: "text"}


def _hint(name: str, known: Mapping[str, Any]) -> str:
    if not known:
        return "; it takes none"
    listed = f"; it takes {', '.join(known)}" if len(known) <= FEW else ""
    return listed + did_you_mean(name, known)


def _converted(value: Any, kind: type) -> Any:
    if kind is bool:
        return TRUTHS[str(value).lower()]
    if kind is int:
        return int(str(value))  # no fraction, and no truth value
    return kind(value)
