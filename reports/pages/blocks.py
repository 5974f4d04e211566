"""Blocks of pages: text, code, facts, tables, figures, pictures, animations, sections and what is folded away."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...formulations.rendering import Line
from ...instances.errors import UsageError
from ...instances.printable import printable
from ..tables.table import Column, Table
from .rendering import Block, Rendering

if TYPE_CHECKING:
    import pandas as pd
    from markupsafe import Markup

MOST_ROWS = 5000
"""Rows of a table that a page holds; how many more there are is said below it."""

WIDE_TEXT = 40
"""Characters of a text above which its column takes more room."""

_KINDS = {b"\x89PNG": "image/png", b"GIF8": "image/gif", b"\xff\xd8\xff": "image/jpeg", b"RIFF": "image/webp"}


@dataclass(frozen=True)
class Text:
    """Paragraphs, separated by empty lines; lines that begin with ``- `` are a list. Shown as it is, without any markup."""

    text: str

    def html(self, made: Rendering) -> Markup:
        parts = []
        for paragraph in self.text.split("\n\n"):
            lines = [line.strip() for line in paragraph.strip().splitlines()]
            if lines and all(line.startswith("- ") for line in lines):
                parts.append((True, [printable(line[2:]) for line in lines]))
            elif lines:
                parts.append((False, [printable(" ".join(lines))]))
        return made.template("text.html", parts=parts)


@dataclass(frozen=True)
class Code:
    """Commands or other text whose lines are kept."""

    text: str

    def html(self, made: Rendering) -> Markup:
        return made.template("code.html", lines=[printable(line) for line in self.text.strip("\n").splitlines()])


@dataclass(frozen=True)
class Facts:
    """Names and values. A ``Line`` has a tone (``good, bad, quiet, plain``), a pair is plain."""

    lines: Sequence[Line | tuple[str, str]]
    title: str = ""

    def html(self, made: Rendering) -> Markup:
        lines = [line if isinstance(line, Line) else Line(*line) for line in self.lines]
        return made.template("facts.html", title=printable(self.title), lines=lines)


@dataclass(frozen=True, eq=False)
class DataTable:
    """A table that sorts by any column: one of ``reports.tables``, or a pandas frame, whose index is shown where it has a name.

    ``title`` replaces the table's own; ``note`` is a line below it.
    """

    data: Table | pd.DataFrame
    title: str | None = None
    note: str = ""

    def html(self, made: Rendering) -> Markup:
        made.scripts["table.js"] = None
        table, most = (self.data, len(self.data.rows)) if isinstance(self.data, Table) else (table_of(self.data), len(self.data))
        more = most - MOST_ROWS
        wide = [column.wide or any(len(row[k]) > WIDE_TEXT for row in table.rows) for k, column in enumerate(table.columns)]
        kinds = ["n" if column.right else "w" if roomy else "" for column, roomy in zip(table.columns, wide, strict=True)]
        notes = [f"and {more:,} more rows"] if more > 0 else []
        notes += [printable(self.note)] if self.note else []
        return made.template(
            "table.html", title=printable(table.title if self.title is None else self.title), table=table, rows=table.rows[:MOST_ROWS],
            kinds=kinds,
            sortable=any(column.name for column in table.columns) and len(table.rows) > 1, notes=notes,
        )  # fmt: skip


def table_of(frame: pd.DataFrame, most: int | None = MOST_ROWS) -> Table:
    """The first rows of a frame (all where ``most`` is None) as texts, numbers with six digits; missing values are empty."""
    shown = frame.head(len(frame) if most is None else most)
    if any(name is not None for name in frame.index.names):
        shown = shown.reset_index()
    numeric = [shown.iloc[:, k].dtype.kind in "iuf" for k in range(shown.shape[1])]

    def told(value: Any, right: bool) -> str:
        return str(value) if not right or isinstance(value, int) else f"{float(value):.6g}"

    rows = [
        tuple("" if lacks else told(value, right) for value, lacks, right in zip(row, lacking, numeric, strict=True))
        for row, lacking in zip(shown.itertuples(index=False), shown.isna().itertuples(index=False), strict=True)
    ]
    columns = tuple(Column(str(name), right) for name, right in zip(shown.columns, numeric, strict=True))
    return Table("", columns, tuple(rows))


@dataclass(frozen=True, eq=False)
class Figure:
    """A picture by matplotlib, given by its axes or its figure, as SVG; ``alt`` says in a sentence what it shows."""

    drawn: Any
    alt: str
    caption: str = ""

    def html(self, made: Rendering) -> Markup:
        from .figures import figure_svg

        svg, width, white = figure_svg(self.drawn, made)
        return made.template("figure.html", svg=svg, width=width, white=white, alt=printable(self.alt), caption=printable(self.caption))


@dataclass(frozen=True)
class Picture:
    """A PNG, GIF, JPEG or WebP picture: its bytes, or the path of its file."""

    data: bytes | str | PathLike[str]
    alt: str
    caption: str = ""

    def html(self, made: Rendering) -> Markup:
        data = self.data if isinstance(self.data, bytes) else Path(self.data).read_bytes()
        return made.template("picture.html", uri=_uri(data), alt=printable(self.alt), caption=printable(self.caption))


@dataclass(frozen=True)
class Animation:
    """Pictures of one size that follow each other, with a button and a slider; ``seconds`` is the time of each.

    ``captions`` has a line for each picture. Nothing moves before the button is pressed.
    """

    frames: Sequence[bytes]
    alt: str
    caption: str = ""
    seconds: float = 0.2
    captions: Sequence[str] = ()

    def __post_init__(self) -> None:
        if not self.frames or len(self.captions) not in (0, len(self.frames)):
            raise UsageError("an animation needs a picture, and as many captions as pictures or none", "wrong-shape")

    def html(self, made: Rendering) -> Markup:
        made.scripts["animation.js"] = None
        return made.template(
            "animation.html", uris=[_uri(frame) for frame in self.frames], alt=printable(self.alt), caption=printable(self.caption),
            milliseconds=round(1000.0 * self.seconds), captions=[printable(line) for line in self.captions], name=made.name("animation"),
        )  # fmt: skip


def _uri(data: bytes) -> str:
    for start, kind in _KINDS.items():
        if data.startswith(start):
            return f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"
    raise UsageError("a picture of a page must be PNG, GIF, JPEG or WebP", "unsupported")


@dataclass(frozen=True, eq=False)
class Section:
    """A heading, and what stands below it."""

    title: str
    blocks: Sequence[Block]

    def html(self, made: Rendering) -> Markup:
        return made.template("section.html", title=printable(self.title), inside=made.blocks(self.blocks))


@dataclass(frozen=True, eq=False)
class Folded:
    """Blocks that are shown on demand, by a click on their title."""

    title: str
    blocks: Sequence[Block]
    open: bool = field(default=False, kw_only=True)

    def html(self, made: Rendering) -> Markup:
        return made.template("folded.html", title=printable(self.title), inside=made.blocks(self.blocks), open=self.open)
