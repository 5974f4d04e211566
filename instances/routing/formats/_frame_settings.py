"""What a table of sites has no place for, as text: settings of ``--set`` or of lines above the table, for ``instance_from_frame``."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...clock import unit_named
from ...errors import InputError, UsageError
from ...formats.table import delimiter_of, table_of
from ...text import is_number, number, read_text, refuse, shown, whole
from ..foreign_names import hint
from ..frame_columns import pairs_of
from ..frame_fleet import SHIFT, SPANS
from ..frame_lists import LOADS, READ_FROM
from ..routing_service import unit_of_distance
from ..travel import METRICS
from . import _cells

if TYPE_CHECKING:
    import pandas as pd

Given = Mapping[str, tuple[int | None, Any]]
"""Line and value of each setting; without a line it is one of ``--set``, and files are named from the working directory."""

COSTS = ("max-distance", "fixed-cost", "unit-cost")
MATRICES = {"matrix": "distance", "durations": "duration", "variances": "variance", "closing": "closing time"}
"""What the numbers of each are."""
INFINITE = {"matrix": ", or inf for no move", "durations": ", or inf for no move", "closing": ", or inf for no limit"}
TABLES = ("fleet", "windows", "shipments", "groups")
KEYS = (
    "vehicles", "min-vehicles", "capacity", "max-duration", *COSTS, "speed", "time-unit", "distance-unit", "metric", *MATRICES, *TABLES,
    "columns", "extra",
)  # fmt: skip


def of_set(settings: Mapping[str, Any]) -> dict[str, tuple[int | None, Any]]:
    """Settings of ``--set`` as those of a file."""
    return {key: (None, value) for key, value in settings.items() if value is not None}


def arguments(given: Given, folder: Path, n: int) -> dict[str, Any]:
    """Arguments of ``instance_from_frame`` for ``n`` sites.

    Raises
    ------
    InputError
        With the line of the setting, or with the file that it names and the line there.
    """
    made: dict[str, Any] = {}
    for key, (line, value) in given.items():
        try:
            made.update(_argument(key, line, value, folder, n))
        except InputError as error:
            if error.line or error.file is not None:
                raise
            raise InputError(f"--set {error.message}", expected=error.expected, found=error.found) from None
    if "matrix" in given and "metric" in given:
        raise InputError("metric stands beside a matrix", line=given["metric"][0], expected="one of them")
    return made


def _argument(key: str, line: int | None, value: Any, folder: Path, n: int) -> dict[str, Any]:
    name = key.replace("-", "_")
    if not isinstance(value, str | int | float) or (isinstance(value, bool) and key == "extra"):
        return {"travel" if key == "matrix" else name: value}  # from Python, as from_frame takes it
    text = str(value).lower() if isinstance(value, bool) else str(value)
    if isinstance(value, bool) and key in (*MATRICES, *TABLES):
        raise InputError(f"{key} takes a file", line=line, expected=f"{key}=FILE", found=text)
    if key == "vehicles":
        return {} if text.lower() == "unlimited" else {name: whole(text, line or 0, key, least=1)}
    if key == "min-vehicles":
        return {name: whole(text, line or 0, key, least=0)}
    if key == "capacity":
        loads = [_limit(key, part, line) for part in text.split(",")]
        return {name: loads if len(loads) > 1 else loads[0]}
    if key in COSTS:
        return {name: _limit(key, text, line)}
    if key == "speed":
        return {name: number(text, line or 0, key)}
    if key == "max-duration":
        spent = _cells.span(text, line, key)
        if isinstance(spent, float) and spent < 0:
            raise InputError(f"{key} is negative", line=line, expected="0 or more", found=text)
        return {name: spent}
    if key == "metric":
        if text not in METRICS:
            raise InputError(f"metric {shown(text)} is unknown", line=line, expected=", ".join(METRICS))
        return {"travel": text}
    if key in MATRICES:
        return {"travel" if key == "matrix" else key: _matrix(_file(key, line, text, folder), key, line, text, n)}
    if key in TABLES:
        return {name: _table(_file(key, line, text, folder), key, line, text)}
    if key == "columns":
        try:
            return {name: pairs_of(text)}
        except InputError as error:
            raise error if line is None else error.at(line=line) from None
    if key == "extra":
        return {name: True if text.lower() == "true" else [title.strip() for title in text.split(",")]}
    return {name: named(unit_named if key == "time-unit" else unit_of_distance, line, text)}


def named(find: Callable[[str], str], line: int | None, text: str) -> str:
    """The name that ``find`` knows for ``text``; what it refuses is refused with the line."""
    try:
        return find(text)
    except UsageError as error:
        if line is None:
            raise
        raise InputError(str(error), line=line) from None


def _limit(key: str, text: str, line: int | None) -> float:
    value = number(text, line or 0, key)
    if value < 0:
        raise InputError(f"{key} is negative", line=line, expected="0 or more", found=text)
    if value == 0 and key == "capacity":
        raise InputError("capacity must be positive", line=line, expected="more than 0", found=text)
    return value


def _file(key: str, line: int | None, name: str, folder: Path) -> Path:
    file = Path(name) if line is None else folder / name
    if os.path.exists(file) and not file.is_file():  # noqa: PTH110 - a name may be too long; a file must not make the reader wait at a pipe
        raise InputError(f"{key} {shown(name)} is no plain file", line=line)
    return file


def _text(file: Path, key: str, line: int | None, name: str) -> str:
    """What the file holds; one that cannot be read is refused where it is named."""
    try:
        return read_text(file)
    except InputError as error:
        if error.line is not None:
            raise
        raise InputError(f"{key} {shown(name)} {error.message}", line=line, found=error.found) from None


def _matrix(file: Path, key: str, line: int | None, name: str, n: int) -> NDArray[np.float64] | str:
    """A square table of numbers, in some with ``inf``; a routing service's JSON is read by ``instance_from_frame``."""
    if file.suffix.lower() == ".json" and key == "matrix":
        return str(file)
    lines = [(k, row) for k, row in enumerate(_text(file, key, line, name).split("\n"), start=1) if row.strip()]
    if len(lines) != n:
        raise InputError(f"{key} has a wrong number of rows", file=file, line=lines[min(n, len(lines) - 1)][0], expected=str(n),
                         found=str(len(lines)))  # fmt: skip
    made = np.empty((n, n))
    delimiter = delimiter_of(lines[0][1])
    for k, (at, row) in enumerate(lines):
        cells = [cell.strip() for cell in (row.split(delimiter) if delimiter in row else row.split())]
        bad = next((cell for cell in cells if not is_number(cell) and (cell.lower() != "inf" or key not in INFINITE)), None)
        if bad is not None:
            raise InputError(f"{key} holds something that is no finite number", file=file, line=at,
                             expected=f"a number{INFINITE.get(key, '')}", found=shown(bad))  # fmt: skip
        if len(cells) != n:
            raise InputError("row of the matrix has a wrong length", file=file, line=at, expected=str(n), found=str(len(cells)))
        made[k] = [float(cell) for cell in cells]
        try:
            refuse((made[k] < 0) & (np.arange(n) != k), [at] * n, f"{MATRICES[key]} is negative", made[k], "0 or more")
        except InputError as error:
            raise error.at(file=file) from None
    np.fill_diagonal(made, 0.0)
    return made


def _table(file: Path, key: str, line: int | None, name: str) -> pd.DataFrame:
    """A frame of vehicles, one row a type, or of windows, shipments or groups; it keeps the lines that it was read from."""
    import pandas as pd

    known, text = _READ[key], _text(file, key, line, name)
    titles = next((k for k, row in enumerate(text.split("\n"), start=1) if row.strip()), 1)
    try:
        table = table_of(text, 0, lambda cell: own if (own := cell.lower()) in known else cell, "vehicles" if key == "fleet" else key)
        held: dict[str, list[Any]] = {}
        strange = next((title for title in table.titles if title not in known and key != "fleet"), None)
        if strange is not None:
            raise InputError(f"column {shown(strange)} is unknown{hint(strange, key, known)}", line=titles, expected=", ".join(known))
        for k, title in enumerate(table.titles):
            cells = [(row[k], at) for row, at in zip(table.rows, table.at, strict=True)]
            read = known.get(title)
            held[title] = _cells.kept([cell for cell, _ in cells]) if read is None else [read(cell, at, title) for cell, at in cells]
    except InputError as error:
        raise error.at(file=file) from None
    frame = pd.DataFrame({title: pd.Series(values, dtype=object) for title, values in held.items()})
    frame.attrs[READ_FROM] = str(file), (titles, *table.at)
    return frame


def _word(cell: str, line: int | None, what: str) -> str:
    if not cell:
        raise InputError(f"{what} is empty", line=line, expected="a name in every row")
    return cell


def _load(cell: str, line: int | None, what: str) -> float:
    return _limit(what, cell, line) if cell else 0.0


_READ: dict[str, dict[str, Callable[[str, int | None, str], Any]]] = {
    "fleet": {**dict.fromkeys(SHIFT, _cells.moment), **dict.fromkeys(SPANS, _cells.span)},
    "windows": {"site": _word, "ready": _cells.moment, "due": _cells.moment},
    "shipments": {"pickup": _word, "delivery": _word, **dict.fromkeys(LOADS, _load)},
    "groups": {"group": _word, "site": _word, "required": _cells.flag},
}
"""How the columns of each table are read; others of the fleet are kept as they are."""


def in_file(error: InputError) -> InputError:
    """The same error with its cure as a user of the command line writes it."""
    if error.expected is None:
        return error
    text = re.sub(r"\bcolumns=\{'([^']*)': '([^']*)'\}", r"--set columns=\1=\2", error.expected)
    text = re.sub(r"\bextra=\['([^']*)'\]", r"--set extra=\1", text)
    text = re.sub(r"\btime_unit='(\w+)'", r"--set time-unit=\1", text)
    text = re.sub(r"\btravel=matrix", "--set matrix=FILE", text)
    text = re.sub(r"\bdurations=matrix", "--set durations=FILE", text)
    text = re.sub(r"(?<!-)\bspeed=", "--set speed=", text)
    if text == error.expected:
        return error
    return InputError(error.message, file=error.file, line=error.line, expected=text, found=error.found)
