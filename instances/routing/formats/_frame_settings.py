"""Settings and cells of tables of sites, as text: those of ``--set`` or of lines above the table, read for ``instance_from_frame``."""

import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...clock import moment_of, span_of, unit_named
from ...errors import InputError, UsageError
from ...formats.table import delimiter_of, table_of
from ...number_arrays import Floats
from ...text import is_number, number, read_text, shown, whole
from ..foreign_names import hint
from ..frame_columns import pairs_of
from ..frame_fleet import SHIFT, SPANS
from ..frame_lists import LOADS, READ_FROM
from ..routing_service import unit_of_distance
from ..travel import METRICS
from ._rows import refuse

if TYPE_CHECKING:
    import pandas as pd

Settings = Mapping[str, tuple[int | None, Any]]
"""Line and value of each setting; without a line it is one of ``--set``, and files are named from the working directory."""

Reader = Callable[[str, int | None, str], Any]
"""Reads a text; its line, None for none, and the name of what it stands for are for messages."""

COSTS = ("max-distance", "fixed-cost", "unit-cost")
MATRICES = {"matrix": "distance", "durations": "duration", "variances": "variance", "closing": "closing time"}
"""Names of the numbers of each matrix."""
INFINITE = {"matrix": ", or inf for no move", "durations": ", or inf for no move", "closing": ", or inf for no limit"}
TABLES = ("fleet", "windows", "shipments", "groups")
KEYS = (
    "vehicles", "min-vehicles", "capacity", "max-duration", *COSTS, "speed", "time-unit", "distance-unit", "metric", *MATRICES, *TABLES,
    "columns", "extra",
)  # fmt: skip
FLAGS = {"1": True, "true": True, "yes": True, "0": False, "false": False, "no": False}
_CODE = re.compile(r"[+-]?0\d")


def of_set(settings: Mapping[str, Any]) -> dict[str, tuple[int | None, Any]]:
    """Settings of ``--set`` as those of a file."""
    return {key: (None, value) for key, value in settings.items() if value is not None}


def arguments(settings: Settings, folder: Path, n: int) -> dict[str, Any]:
    """Arguments of ``instance_from_frame`` for ``n`` sites; an InputError has the line of the setting, or the file that it names and the
    line there."""
    read: dict[str, Any] = {}
    for key, (line, value) in settings.items():
        name = "travel" if key in ("matrix", "metric") else key.replace("-", "_")
        try:
            read[name] = _argument(key, line, value, folder, n)
        except InputError as error:
            if error.line or error.file is not None:
                raise
            raise InputError(f"--set {error.message}", error.code, expected=error.expected, found=error.found) from None
    if "matrix" in settings and "metric" in settings:
        raise InputError("metric stands beside a matrix", "contradiction", line=settings["metric"][0], expected="one of them")
    return read


def _argument(key: str, line: int | None, value: Any, folder: Path, n: int) -> Any:
    if not isinstance(value, str | int | float) or (isinstance(value, bool) and key == "extra"):
        return value  # from Python, as from_frame takes it
    text = str(value).lower() if isinstance(value, bool) else str(value)
    if key not in (*MATRICES, *TABLES):
        return _SETTINGS[key](text, line, key)
    if isinstance(value, bool):
        raise InputError(f"{key} takes a file", line=line, expected=f"{key}=FILE", found=text)
    file = Path(text) if line is None else folder / text
    if os.path.exists(file) and not file.is_file():  # noqa: PTH110 - a name may be too long; a file must not make the reader wait at a pipe
        raise InputError(f"{key} {shown(text)} is no plain file", "file", line=line)
    return _table(file, key, line, text) if key in TABLES else _matrix(file, key, line, text, n)


def named(find: Callable[[str], str], line: int | None, text: str) -> str:
    """The name that ``find`` knows for ``text``; an unknown one is refused with the line."""
    try:
        return find(text)
    except UsageError as error:
        if line is None:
            raise
        raise InputError(str(error), error.code, line=line) from None


def flag(cell: str, line: int | None, what: str) -> bool | None:
    """A truth value; None where the cell is empty."""
    if cell and cell.lower() not in FLAGS:
        raise InputError(f"{what} must be true or false", line=line, expected=", ".join(FLAGS), found=shown(cell))
    return FLAGS[cell.lower()] if cell else None


def kept(cells: list[str]) -> list[Any]:
    """A column that is only kept: numbers if all of it are, and none is written as a code is (``007``); None where a cell is empty."""
    if all(is_number(cell) and not _CODE.match(cell) for cell in cells if cell):
        return [None if not cell else int(cell) if cell.lstrip("+-").isdigit() and len(cell) < 16 else float(cell) for cell in cells]
    return [cell or None for cell in cells]


def _vehicles(text: str, line: int | None, what: str) -> int | None:
    return None if text.lower() == "unlimited" else whole(text, line or 0, what, least=1)


def _limit(text: str, line: int | None, what: str) -> float:
    value = number(text, line or 0, what)
    if value < 0:
        raise InputError(f"{what} is negative", "out-of-range", line=line, expected="0 or more", found=text)
    if value == 0 and what == "capacity":
        raise InputError("capacity must be positive", "out-of-range", line=line, expected="more than 0", found=text)
    return value


def _capacity(text: str, line: int | None, what: str) -> float | list[float]:
    loads = [_limit(part, line, what) for part in text.split(",")]
    return loads if len(loads) > 1 else loads[0]


def _duration(text: str, line: int | None, what: str) -> Any:
    span = span_of(text, line, what)
    if isinstance(span, float) and span < 0:
        raise InputError(f"{what} is negative", "out-of-range", line=line, expected="0 or more", found=text)
    return span


def _metric(text: str, line: int | None, what: str) -> str:
    if text not in METRICS:
        raise InputError(f"metric {shown(text)} is unknown", "unknown-name", line=line, expected=", ".join(METRICS))
    return text


def _columns(text: str, line: int | None, what: str) -> dict[str, str]:
    try:
        return pairs_of(text)
    except InputError as error:
        raise error if line is None else error.at(line=line) from None


def _word(cell: str, line: int | None, what: str) -> str:
    if not cell:
        raise InputError(f"{what} is empty", "missing", line=line, expected="a name in every row")
    return cell


_SETTINGS: dict[str, Reader] = {
    "vehicles": _vehicles,
    "min-vehicles": lambda text, line, what: whole(text, line or 0, what, least=0),
    "capacity": _capacity,
    **dict.fromkeys(COSTS, _limit),
    "speed": lambda text, line, what: number(text, line or 0, what),
    "max-duration": _duration,
    "metric": _metric,
    "columns": _columns,
    "extra": lambda text, line, what: True if text.lower() == "true" else [title.strip() for title in text.split(",")],
    "time-unit": lambda text, line, what: named(unit_named, line, text),
    "distance-unit": lambda text, line, what: named(unit_of_distance, line, text),
}
"""Readers of the settings that name no file."""

_COLUMNS: dict[str, dict[str, Reader]] = {
    "fleet": {**dict.fromkeys(SHIFT, moment_of), **dict.fromkeys(SPANS, span_of)},
    "windows": {"site": _word, "ready": moment_of, "due": moment_of},
    "shipments": {
        "pickup": _word, "delivery": _word,
        **dict.fromkeys(LOADS, lambda cell, line, what: _limit(cell, line, what) if cell else 0.0),
    },
    "groups": {"group": _word, "site": _word, "required": flag},
}  # fmt: skip
"""Readers of the columns of each table; others of the fleet are kept as they are."""


def _text(file: Path, key: str, line: int | None, name: str) -> str:
    """The text of a file; one that cannot be read is refused where it is named."""
    try:
        return read_text(file)
    except InputError as error:
        if error.line is not None:
            raise
        raise InputError(f"{key} {shown(name)} {error.message}", error.code, line=line, found=error.found) from None


def _matrix(file: Path, key: str, line: int | None, name: str, n: int) -> Floats | str:
    """A square table of numbers, in some with ``inf``; a routing service's JSON is read by ``instance_from_frame``."""
    if file.suffix.lower() == ".json" and key == "matrix":
        return str(file)
    lines = [(k, row) for k, row in enumerate(_text(file, key, line, name).split("\n"), start=1) if row.strip()]
    if len(lines) != n:
        at, count = lines[min(n, len(lines) - 1)][0], str(len(lines))
        raise InputError(f"{key} has a wrong number of rows", "wrong-shape", file=file, line=at, expected=str(n), found=count)
    matrix = np.empty((n, n))
    delimiter = delimiter_of(lines[0][1])
    for k, (at, row) in enumerate(lines):
        cells = [cell.strip() for cell in (row.split(delimiter) if delimiter in row else row.split())]
        bad = next((cell for cell in cells if not is_number(cell) and (cell.lower() != "inf" or key not in INFINITE)), None)
        if bad is not None:
            message, expected = f"{key} holds something that is no finite number", f"a number{INFINITE.get(key, '')}"
            raise InputError(message, file=file, line=at, expected=expected, found=shown(bad))
        if len(cells) != n:
            message = "row of the matrix has a wrong length"
            raise InputError(message, "wrong-shape", file=file, line=at, expected=str(n), found=str(len(cells)))
        matrix[k] = [float(cell) for cell in cells]
        try:
            refuse((matrix[k] < 0) & (np.arange(n) != k), [at] * n, f"{MATRICES[key]} is negative", matrix[k], "0 or more")
        except InputError as error:
            raise error.at(file=file) from None
    np.fill_diagonal(matrix, 0.0)
    return matrix


def _table(file: Path, key: str, line: int | None, name: str) -> "pd.DataFrame":
    """A frame of vehicles, one row per type, or of windows, shipments or groups; it keeps the lines that it was read from."""
    import pandas as pd

    known, text = _COLUMNS[key], _text(file, key, line, name)
    titles = next((k for k, row in enumerate(text.split("\n"), start=1) if row.strip()), 1)
    try:
        table = table_of(text, 0, lambda cell: own if (own := cell.lower()) in known else cell, "vehicles" if key == "fleet" else key)
        columns: dict[str, list[Any]] = {}
        strange = next((title for title in table.titles if title not in known and key != "fleet"), None)
        if strange is not None:
            message = f"column {shown(strange)} is unknown{hint(strange, key, known)}"
            raise InputError(message, "unknown-name", line=titles, expected=", ".join(known))
        for k, title in enumerate(table.titles):
            cells, read = [row[k] for row in table.rows], known.get(title)
            columns[title] = kept(cells) if read is None else [read(cell, at, title) for cell, at in zip(cells, table.at, strict=True)]
    except InputError as error:
        raise error.at(file=file) from None
    frame = pd.DataFrame({title: pd.Series(values, dtype=object) for title, values in columns.items()})
    frame.attrs[READ_FROM] = str(file), (titles, *table.at)
    return frame


CURES = (
    (r"\bcolumns=\{'([^']*)': '([^']*)'\}", r"--set columns=\1=\2"), (r"\bextra=\['([^']*)'\]", r"--set extra=\1"),
    (r"\btime_unit='(\w+)'", r"--set time-unit=\1"), (r"\btravel=matrix", "--set matrix=FILE"),
    (r"\bdurations=matrix", "--set durations=FILE"), (r"(?<!-)\bspeed=", "--set speed="),
)  # fmt: skip
"""Arguments of ``from_frame`` as messages name them, and the same on the command line."""


def in_file(error: InputError) -> InputError:
    """The same error with its cure as a user of the command line writes it."""
    if error.expected is None:
        return error
    text = error.expected
    for pattern, command in CURES:
        text = re.sub(pattern, command, text)
    if text == error.expected:
        return error
    return InputError(error.message, error.code, file=error.file, line=error.line, expected=text, found=error.found)
