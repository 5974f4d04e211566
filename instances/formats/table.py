"""Tables in text: settings in comment lines, a line of titles, and rows; what the CSV formats share."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass

from ..errors import InputError
from ..text import shown

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


def delimiter_of(line: str) -> str:
    """The one of ``, ; | tab`` that occurs most often."""
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


def settings_of(text: str, known: Collection[str], columns: Collection[str]) -> tuple[Settings, int]:
    """Settings in the comment lines above the table, and the index of its first line."""
    found: Settings = {}
    for k, line in enumerate(text.split("\n")):
        if not line.strip():
            continue
        if not line.lstrip().startswith("#"):
            return found, k
        key, colon, value = line.strip().lstrip("#").partition(":")
        key = key.strip().lower().replace("_", "-")
        if not colon:
            continue  # a remark
        if key not in known:
            raise InputError(f"setting {shown(key)} is unknown", line=k + 1, expected=", ".join(known))
        if key in found:
            raise InputError(f"setting {key} stands twice, first in line {found[key][0]}", line=k + 1)
        if not value.strip():
            raise InputError(f"setting {key} has no value", line=k + 1)
        found[key] = k + 1, value.strip()
    raise InputError("holds no table", expected=f"a line of titles out of {', '.join(columns)}", found="the end of the file")


def table_of(text: str, start: int, columns: Collection[str] | Callable[[str], str], what: str) -> Table:
    """The table that begins in line ``start`` (from 0), with titles out of ``columns`` in any case, or whatever a function makes of them.

    ``what`` is what its rows are, for messages.
    """
    lines = text.split("\n")[start:]
    reader = csv.reader(io.StringIO("\n".join(lines)), delimiter=delimiter_of(lines[0]), strict=True)
    table = Table([], [], [])
    try:
        for row in reader:
            cells, line = [cell.strip() for cell in row], start + reader.line_num
            if not any(cells):
                continue
            if not table.titles:
                table.titles.extend(_titles(cells, line, columns))
            elif len(cells) != len(table.titles):
                raise InputError("row has a wrong length", line=line, expected=f"{len(table.titles)} values", found=f"{len(cells)} values")
            else:
                table.rows.append(cells)
                table.at.append(line)
    except csv.Error as error:
        raise InputError(f"is no CSV: {error}", line=start + reader.line_num) from None
    if not table.rows:
        raise InputError(f"holds no {what}", line=start + 1, expected="at least one row below the titles", found="the end of the file")
    return table


def _titles(cells: list[str], line: int, columns: Collection[str] | Callable[[str], str]) -> list[str]:
    titles = [columns(cell) if callable(columns) else cell.lower() for cell in cells]
    for k, title in enumerate(titles):
        if not title:
            raise InputError(f"column {k + 1} has no title", line=line)
        if not callable(columns) and title not in columns:
            raise InputError(f"column {shown(title)} is unknown", line=line, expected=", ".join(columns))
        if title in titles[:k]:
            raise InputError(f"column {title} stands twice", line=line)
    return titles


def written(settings: Iterable[tuple[str, str]], titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """The text of a table with its settings."""
    out = io.StringIO()
    out.writelines(f"# {key}: {value}\n" for key, value in settings)
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(titles)
    writer.writerows(rows)
    return out.getvalue()
