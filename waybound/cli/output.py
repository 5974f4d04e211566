"""Standard output: tables and lines for people, one JSON object for machines; nothing a solver prints gets in between."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..formulations.rendering import Line
    from ..reports.tables import Table

PIPE_WIDTH = 120
"""Columns of a table that is not written to a terminal."""


def _console() -> Any:
    from rich.console import Console

    known = sys.stdout.isatty() or "COLUMNS" in os.environ
    return Console(file=sys.stdout, width=None if known else PIPE_WIDTH, highlight=False, markup=False, emoji=False)


def print_json(data: Any) -> None:
    """The one object that ``--json`` promises."""
    from ..formulations.answers import json_text

    sys.stdout.write(json_text(data))
    sys.stdout.flush()


def print_table(table: Table) -> None:
    """A table, its title above it."""
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
    for row in table.rows:
        grid.add_row(*(Text(cell) for cell in row))
    _console().print(grid)


def print_lines(title: str, lines: Sequence[Line]) -> None:
    """A certificate or the like."""
    from ..formulations.rendering import as_rich

    _console().print(as_rich(title, lines))


def print_text(text: str = "") -> None:
    """One line."""
    from ..instances.printable import printable

    _console().print(printable(text), soft_wrap=True)


@contextlib.contextmanager
def stdout_is_ours() -> Iterator[None]:
    """Send to standard error whatever native code writes to file descriptor 1 meanwhile."""
    try:
        sys.stdout.flush()
        kept = os.dup(1)
    except (OSError, ValueError):  # closed, or no real file
        yield
        return
    try:
        os.dup2(2, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
