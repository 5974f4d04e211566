"""A table of texts, as it is shown, printed or written."""

import html
import io
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from ...formulations.rendering import number
from ...instances.printable import printable

Row = tuple[str, str]
"""A name and its value."""

SHOWN_CELL = 200
"""Characters of a cell that are shown, unless its column is wide."""


@dataclass(frozen=True)
class Column:
    """Heading of a column: numbers stand to the right, and ``wide`` columns take the remaining room and show texts of any length."""

    name: str
    right: bool = False
    wide: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", printable(self.name, SHOWN_CELL))


@dataclass(frozen=True)
class Table:
    """A titled table of printable texts; ``total`` is a last row set apart, ``most`` the rows shown unless all are asked for, ``rest`` the
    word for the others."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    total: tuple[str, ...] = field(default=())
    most: int | None = None
    rest: str = "more rows"

    def __post_init__(self) -> None:
        def cleaned(row: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(printable(c, len(c) if column.wide else SHOWN_CELL) for c, column in zip(row, self.columns, strict=True))

        object.__setattr__(self, "title", printable(self.title))
        object.__setattr__(self, "rows", tuple(cleaned(row) for row in self.rows))
        object.__setattr__(self, "total", cleaned(self.total) if self.total else ())


def short(value: float) -> str:
    """A quantity with at most three decimals: tables are for reading, files hold the digits."""
    return number(round(value, 3))


T = TypeVar("T")

SHOWN_ROWS = 100
"""Rows of a table that are shown: more are for machines, and take seconds to lay out."""

PLAIN_WIDTH = 120
"""Columns of a table as text."""


def table_rich(table: Table, rows: int = SHOWN_ROWS) -> Any:
    """A ``rich`` renderable of the first rows."""
    from rich import box
    from rich.table import Table as Grid
    from rich.text import Text

    headed = any(column.name for column in table.columns)
    grid = Grid(
        title=Text(table.title, style="bold"), title_justify="left", box=box.SIMPLE_HEAD if headed else None, show_header=headed,
        show_footer=bool(table.total), pad_edge=False, padding=(0, 1),
    )  # fmt: skip
    for k, column in enumerate(table.columns):
        grid.add_column(
            column.name, footer=table.total[k] if table.total else "", justify="right" if column.right else "left", overflow="fold",
            no_wrap=column.right, ratio=1 if column.wide else None,
        )  # fmt: skip
    for row in table.rows[:rows]:
        grid.add_row(*(Text(cell) for cell in row))
    return grid


def table_plain(table: Table) -> str:
    """Plain text, without colours and of the same width everywhere."""
    from rich.console import Console

    held = io.StringIO()
    console = Console(
        file=held, width=PLAIN_WIDTH, color_system=None, highlight=False, markup=False, emoji=False, legacy_windows=False,
        force_jupyter=False,  # in a notebook rich would show the table there and then
    )  # fmt: skip
    console.print(table_rich(table))
    more = len(table.rows) - SHOWN_ROWS
    text = "\n".join(line.rstrip() for line in held.getvalue().splitlines())
    return text.strip("\n") + (f"\nand {more:,} more rows" if more > 0 else "")


def table_html(table: Table) -> str:
    """An HTML table; all text is escaped. What follows the first ``most`` rows is folded."""
    cell = "padding:1px 10px 1px 0;vertical-align:top"
    sides = [f"text-align:{'right' if column.right else 'left'};{cell}" for column in table.columns]

    def line(entries: Iterable[str], tag: str) -> str:
        return "<tr>" + "".join(f'<{tag} style="{s}">{html.escape(e)}</{tag}>' for e, s in zip(entries, sides, strict=True)) + "</tr>"

    names = [column.name for column in table.columns]
    head = f"<thead>{line(names, 'th')}</thead>" if any(names) else ""
    lines = [line(row, "td") for row in table.rows[:SHOWN_ROWS]]
    body, folded = "".join(lines[: table.most]), [] if table.most is None else lines[table.most :]
    foot = f"<tfoot>{line(table.total, 'th')}</tfoot>" if table.total else ""
    more = len(table.rows) - SHOWN_ROWS
    rest = f"<p>and {more:,} more rows</p>" if more > 0 else ""
    if folded:
        table_of = f'<table style="border-collapse:collapse">{head}<tbody>{"".join(folded)}</tbody></table>'
        rest = f"<details><summary>and {len(folded)} {html.escape(table.rest)}</summary>{table_of}{rest}</details>"
    title = f'<caption style="text-align:left;font-weight:bold">{html.escape(table.title)}</caption>' if table.title else ""
    return f'<table style="border-collapse:collapse">{title}{head}<tbody>{body}</tbody>{foot}</table>{rest}'


class Listing(list[T], Generic[T]):
    """A list that shows itself as a table in a notebook, in a terminal and as text; ``table`` makes one of the list."""

    def __init__(self, entries: Iterable[T], table: "Callable[[Listing[T]], Table]") -> None:
        super().__init__(entries)
        self._table = table

    @property
    def table(self) -> Table:
        return self._table(self)

    def __reduce__(self) -> Any:
        return list, (list(self),)

    def __repr__(self) -> str:
        return table_plain(self.table)

    def _repr_html_(self) -> str:
        return table_html(self.table)

    def __rich__(self) -> Any:
        return table_rich(self.table)
