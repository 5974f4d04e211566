"""Reading of instances: the format is recognised from the content, never from the file's name."""

import re
from os import PathLike
from pathlib import Path
from typing import Any

from .errors import InputError, UsageError
from .formats import FORMATS, Format
from .instance import Instance
from .text import read_text, shown


def read_instance(
    path: str | PathLike[str],
    format: str | None = None,  # noqa: A002
    problem: str | None = None,
    settings: dict[str, Any] | None = None,
) -> Instance:
    """The instance that a file holds, of the named ``format`` or else of the one recognised from the content.

    ``problem`` settles the format where the content allows several. The format's reader takes its own ``settings`` out of those of
    ``--set``. Raises InputError with file, line, what was expected and what was found, and UsageError for an unknown or ambiguous format.
    """
    chosen = FORMATS[format] if format is not None else None
    text = read_text(path)
    chosen = chosen or recognise(text, path, problem)
    taken = {key: settings.pop(key) for key in chosen.settings if key in settings} if settings else {}
    try:
        return chosen.read(text, Path(path), taken) if taken else chosen.read(text, Path(path))
    except InputError as error:
        raise error.at(file=path) from None
    except UsageError as error:  # a name inside the file that does not exist
        raise InputError(str(error), error.code, file=path) from None


def recognise(text: str, path: str | PathLike[str] = "input", problem: str | None = None) -> Format:
    """The one format whose marks ``text`` bears, and in which ``problem`` may be asked if it bears those of several."""
    recognising = [entry for entry in FORMATS.values() if entry.recognises(text)]
    able = [entry for entry in recognising if not entry.problems or problem in entry.problems] if len(recognising) > 1 else recognising
    if len(able) == 1:
        return able[0]
    if recognising:
        choices = "; ".join(f"{entry.name} ({', '.join(entry.problems) or 'as the file says'})" for entry in recognising)
        raise UsageError(
            f"{path}: the content allows more than one format; choose with --format, or --problem, from {choices}", "ambiguous"
        )
    if re.search(r"^\s*route\s*#?\s*\d+\s*:|^\s*TOUR_SECTION", text, re.I | re.M):
        raise InputError("is a solution file, not an instance", "foreign", file=path)
    first = next(line for line in text.split("\n") if line.strip())
    near = ((entry.name, entry.lacks(text)) for entry in FORMATS.values() if entry.lacks is not None)
    name, lacking = next(((name, lacking) for name, lacking in near if lacking), ("", ", ".join(FORMATS.names())))
    what = f"is of no known format, but nearly {name}" if name else "is of no known format"
    raise InputError(what, file=path, line=1, expected=lacking, found=shown(first.strip()))
