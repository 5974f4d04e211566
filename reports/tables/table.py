"""A table of texts, as it is shown, printed or written."""

from __future__ import annotations

from dataclasses import dataclass, field

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


@dataclass(frozen=True)
class Table:
    """A titled table of printable texts; ``total`` is a last row set apart, ``most`` the rows shown unless all are asked for."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    total: tuple[str, ...] = field(default=())
    most: int | None = None

    def __post_init__(self) -> None:
        def cleaned(row: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(printable(c, len(c) if column.wide else SHOWN_CELL) for c, column in zip(row, self.columns, strict=True))

        object.__setattr__(self, "title", printable(self.title))
        object.__setattr__(self, "rows", tuple(cleaned(row) for row in self.rows))
        object.__setattr__(self, "total", cleaned(self.total) if self.total else ())


def short(value: float) -> str:
    """A quantity with at most three decimals: tables are for reading, files hold the digits."""
    return number(round(value, 3))
