"""Settings of generators, as they come from Python or as text from the command line."""

import math
from dataclasses import dataclass
from typing import Any

from ..errors import UsageError


@dataclass(frozen=True)
class Setting:
    """One setting.

    Parameters
    ----------
    default : object
        Also tells the type: text, flag, whole number or number; None leaves it to ``type``.
    help : str
        One line, with the unit.
    type : type, optional
        ``int, float, bool`` or ``str``; that of the default where it is given.
    least, most : float, optional
        Bounds of a number, both included.
    choices : tuple of str, optional
        Values of a text.
    """

    default: Any
    help: str
    type: Any = None
    least: float = -math.inf
    most: float = math.inf
    choices: tuple[str, ...] = ()

    def value(self, name: str, given: Any) -> Any:
        """``given`` as a valid value."""
        kind = self.type or type(self.default)
        text = str(given).strip()
        if given is None or (self.default is None and text.lower() in ("none", "unlimited")):
            if self.default is None:
                return None
            raise UsageError(f"{name} must have a value", "missing")
        if kind is bool:
            flags = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
            if text.lower() not in flags:
                raise UsageError(f"{name} must be true or false, not {given!r}", "malformed")
            return flags[text.lower()]
        if kind is str:
            if self.choices:
                for choice in self.choices:
                    if text.lower() == choice.lower():
                        return choice
                raise UsageError(f"{name} must be one of {', '.join(self.choices)}, not {given!r}", "unknown-name")
            if not text or not text.isprintable() or len(text) > 100:
                raise UsageError(f"{name} must be printable, of 1 to 100 characters, not {given!r}", "malformed")
            return text
        try:
            number: float = int(text) if kind is int else float(text)
        except ValueError:
            raise UsageError(f"{name} must be a {'whole ' if kind is int else ''}number, not {given!r}", "malformed") from None
        if not self.least <= number <= self.most or not math.isfinite(number):
            raise UsageError(f"{name} must lie between {self.least:g} and {self.most:g}, not {given!r}", "out-of-range")
        return number
