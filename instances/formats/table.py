"""Tables in text, which all CSV formats are: settings in comment lines, a line of titles, and rows."""

import csv
import io
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError, UsageError
from ..instance import Instance
from ..number_arrays import Floats
from ..text import label, number, shown

Settings = dict[str, tuple[int, str]]
"""Line and value of each setting."""

CORNER = "robot/bin"
"""First title of a matrix, whose other titles are names of bins, whatever they are."""


@dataclass(frozen=True)
class Table:
    """Rows of cells, stripped; ``at`` holds the line of each row."""

    titles: list[str]
    rows: list[list[str]]
    at: list[int]

    def column(self, title: str) -> list[str] | None:
        """The cells under a title, or None where it is missing."""
        if title not in self.titles:
            return None
        k = self.titles.index(title)
        return [row[k] for row in self.rows]

    def columns(self, titles: Sequence[str], line: int, expected: Sequence[str]) -> list[list[str]]:
        """The cells under each of ``titles``; InputError with the line of the titles where one is missing."""
        for title in titles:
            if title not in self.titles:
                found = ", ".join(self.titles)
                raise InputError(f"column {title} is missing", "missing", line=line, expected=", ".join(expected), found=found)
        return [self.column(title) or [] for title in titles]

    def numbers(self, title: str, rows: Iterable[int] | None = None) -> Floats:
        """The finite numbers under a title, in some rows or in all."""
        column = self.column(title) or []
        return np.array([number(column[k], self.at[k], title) for k in (range(len(column)) if rows is None else rows)])


def delimiter_of(line: str) -> str:
    """The delimiter ``, ; |`` or tab that occurs most often."""
    return max(",;\t|", key=line.count)


def titles_of(text: str) -> frozenset[str]:
    """Titles in the first line that is no comment, for recognising a format; none of a matrix."""
    start = 0
    while start < len(text):
        end = text.find("\n", start)
        line = text[start:] if end < 0 else text[start:end]
        if line.strip() and not line.lstrip().startswith("#"):
            titles = [cell.strip().strip('"').lower() for cell in line.split(delimiter_of(line))]
            return frozenset(titles if titles[0] != CORNER else ())
        start += len(line) + 1
    return frozenset()


def settings_of(
    text: str, known: Collection[str], columns: Collection[str], choices: Mapping[str, Collection[str]] | None = None
) -> tuple[Settings, int]:
    """Settings in the comment lines above the table, with values out of their ``choices``, and the index of the table's first line."""
    settings: Settings = {}
    for k, line in enumerate(text.split("\n")):
        if not line.strip():
            continue
        if not line.lstrip().startswith("#"):
            for key, values in (choices or {}).items():
                at, value = settings.get(key, (0, ""))
                if key in settings and value not in values:
                    raise InputError(f"{key} {shown(value)} is unknown", "unknown-name", line=at, expected=", ".join(values))
            return settings, k
        key, colon, value = line.strip().lstrip("#").partition(":")
        key = key.strip().lower().replace("_", "-")
        if not colon:
            continue  # a remark
        if key not in known:
            raise InputError(f"setting {shown(key)} is unknown", "unknown-name", line=k + 1, expected=", ".join(known))
        if key in settings:
            raise InputError(f"setting {key} stands twice, first in line {settings[key][0]}", "duplicate", line=k + 1)
        if not value.strip():
            raise InputError(f"setting {key} has no value", "missing", line=k + 1)
        settings[key] = k + 1, value.strip()
    raise InputError("holds no table", "missing", expected=f"a line of titles out of {', '.join(columns)}", found="the end of the file")


def name_of(settings: Settings, path: Path) -> str:
    """The name of the instance: the setting ``name``, or else that of the file."""
    return label(settings["name"][1] if "name" in settings else path.stem)


def rows_of(text: str, start: int) -> Iterator[tuple[int, list[str]]]:
    """Line and stripped cells of each row from line ``start`` on (from 0) that is not empty."""
    lines = text.split("\n")[start:]
    reader = csv.reader(io.StringIO("\n".join(lines)), delimiter=delimiter_of(lines[0]), strict=True)
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if any(cells):
                yield start + reader.line_num, cells
    except csv.Error as error:
        raise InputError(f"is no CSV: {error}", line=start + reader.line_num) from None


def table_of(text: str, start: int, columns: Collection[str] | Callable[[str], str], what: str) -> Table:
    """The table that begins in line ``start`` (from 0), whose rows are called ``what`` in messages.

    Its titles are out of ``columns`` in any case, or whatever a function makes of them.
    """
    table = Table([], [], [])
    for line, cells in rows_of(text, start):
        if not table.titles:
            table.titles.extend(_titles(cells, line, columns))
        elif len(cells) != len(table.titles):
            raise InputError(
                "row has a wrong length", "wrong-shape", line=line, expected=f"{len(table.titles)} values", found=f"{len(cells)} values"
            )
        else:
            table.rows.append(cells)
            table.at.append(line)
    if not table.rows:
        raise InputError(
            f"holds no {what}", "missing", line=start + 1, expected="at least one row below the titles", found="the end of the file"
        )
    return table


def _titles(cells: list[str], line: int, columns: Collection[str] | Callable[[str], str]) -> list[str]:
    titles = [columns(cell) if callable(columns) else cell.lower() for cell in cells]
    for k, title in enumerate(titles):
        if not title:
            raise InputError(f"column {k + 1} has no title", "missing", line=line)
        if not callable(columns) and title not in columns:
            raise InputError(f"column {shown(title)} is unknown", "unknown-name", line=line, expected=", ".join(columns))
        if title in titles[:k]:
            raise InputError(f"column {title} stands twice", "duplicate", line=line)
    return titles


def check_name(what: str, cell: str, line: int, *, optional: bool = False) -> None:
    """Raise InputError for a cell that is no printable name; an empty one may be ``optional``."""
    if not cell.isprintable() or not (cell or optional):
        message, found = f"{what} must have a name", ascii(cell)[:40]
        raise InputError(message, "malformed" if cell else "missing", line=line, expected="a printable name", found=found)


def check_kind(instance: Any, kind: type, lacks: str, format_name: str) -> None:
    """Raise UsageError unless ``instance`` is of the kind that a format writes."""
    if not isinstance(instance, kind):
        name = getattr(instance, "name", "this")
        raise UsageError(f"{name} holds no {lacks}, so it cannot be written as {format_name}; use json", "unsupported")


def no_place(instance: Instance, format_name: str, what: str) -> UsageError:
    """The error for an instance with something that a format cannot hold."""
    return UsageError(f"{instance.name} cannot be written as {format_name}, which has no place for {what}; use json", "unsupported")


def written(settings: Iterable[tuple[str, str]], titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """The text of a table with its settings."""
    out = io.StringIO()
    out.writelines(f"# {key}: {value}\n" for key, value in settings)
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(titles)
    writer.writerows(rows)
    return out.getvalue()
