"""Settings in the comment lines of text formats of risky graphs: the objective, and elements of risk by a few numbers each."""

from collections.abc import Callable, Sequence
from typing import Any

from ...errors import InputError
from ...formats.table import Settings
from ...text import is_number, shown
from ..element import RiskElement
from ..elements import GROWTHS, MEASURES, LengthRisk, TurnRisk
from ..risky_graph import OBJECTIVES
from ..tether import Tether
from ..traverse_elements import TetherRisk, TravelledRisk

COMMON = ("name", "objective", "conditional", "discount", "length", "turn", "travelled", "tether")
"""Settings of both formats."""

YES = {"yes": True, "true": True, "no": False, "false": False}


def numbers_of(settings: Settings, key: str, least: int, most: int, words: Sequence[str] = ()) -> tuple[list[float], str]:
    """The numbers of a setting, ``least`` to ``most`` of them, and the word of ``words`` that may follow, "" for none."""
    line, text = settings[key]
    tokens = text.split()
    word = tokens.pop() if tokens and words and not is_number(tokens[-1]) else ""
    if word and word not in words:
        raise InputError(f"{key} has an unknown word {shown(word)}", "unknown-name", line=line, expected=", ".join(words))
    wrong = next((token for token in tokens if not is_number(token)), None)
    if wrong is not None or not least <= len(tokens) <= most:
        count = str(least) if least == most else f"{least} to {most}"
        raise InputError(f"{key} needs {count} numbers", line=line, found=shown(text if wrong is None else wrong))
    return [float(token) for token in tokens], word


def graph_settings(settings: Settings) -> dict[str, Any]:
    """Keyword arguments of a graph: name, objective, discount, and whether risks are conditional, which must be said."""
    if "conditional" not in settings:
        raise InputError("it must be said whether risks are conditional", "missing", line=1, expected="a line '# conditional: yes', or no")
    line, text = settings["conditional"]
    if text.lower() not in YES:
        raise InputError("conditional must be yes or no", line=line, found=shown(text))
    arguments: dict[str, Any] = {"conditional": YES[text.lower()]}
    if "objective" in settings:
        line, arguments["objective"] = settings["objective"]
        if arguments["objective"] not in OBJECTIVES:
            found = shown(arguments["objective"])
            raise InputError("the objective is unknown", "unknown-name", line=line, expected=", ".join(OBJECTIVES), found=found)
    if "discount" in settings:
        (arguments["discount"],), _ = numbers_of(settings, "discount", 1, 1)
    return arguments


def at_line(settings: Settings, key: str, make: Callable[[], Any]) -> Any:
    """The result of ``make``, whose errors get the line of the setting."""
    try:
        return make()
    except InputError as error:
        raise error.at(line=settings[key][0]) from None


def element_of(
    settings: Settings, key: str, least: int, most: int, make: Callable[..., RiskElement], words: Sequence[str] = ()
) -> list[RiskElement]:  # fmt: skip
    """The element that ``make`` makes of the numbers of a setting, and of its word where there are ``words``; none without the setting."""
    if key not in settings:
        return []
    numbers, word = numbers_of(settings, key, least, most, words)
    return [at_line(settings, key, lambda: make(*numbers, *([word] if words else [])))]


def elements_of(settings: Settings, obstacles: Any, spacing: float | None) -> list[RiskElement]:
    """The elements of action and traverse that the settings ask for."""
    return [
        *element_of(settings, "length", 1, 1, lambda rate, growth: LengthRisk(rate, growth or "exponential"), GROWTHS),
        *element_of(settings, "turn", 1, 1, lambda turn, measure: TurnRisk(turn, measure or "angle"), MEASURES),
        *element_of(settings, "travelled", 1, 2, lambda rate, free=0.0: TravelledRisk(rate, free)),
        *element_of(settings, "tether", 4, 4, lambda x, y, long, contact: TetherRisk(Tether((x, y), obstacles, spacing), long, contact)),
    ]
