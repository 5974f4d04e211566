"""Rows of Cordeau's format, which the files of the team orienteering problem with time windows took over."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...text import an, numbers, plain, refuse
from ._rows import Rows

HEADER = ("type", "m", "n", "t")


@dataclass
class Table:
    """Columns ``number, x, y, service, load, ready, due``; the visits that rows ask for, the list of their combinations, and the lines."""

    rows: list[list[float]] = field(default_factory=list)
    frequency: list[float] = field(default_factory=list)
    combinations: list[list[float]] = field(default_factory=list)
    at: list[int] = field(default_factory=list)

    @property
    def columns(self) -> NDArray[np.float64]:
        return np.array(self.rows, dtype=np.float64).reshape(len(self.rows), 7)

    def read(self, rows: Rows, what: str, first: int, count: int, windows: bool) -> None:
        """``count`` rows that are numbered from ``first``; a claim that the file does not keep ends it early."""
        for number in range(first, first + count):
            line, text = rows.next(f"{what} {number}")
            found = numbers(text, line, what)
            size = found[6] if len(found) > 6 else 0.0
            width = 7 + int(size) + 2 * windows if size in range(len(found)) else -1
            if len(found) != width:
                shape = "number, x, y, service, demand, f, a, a numbers" + ", ready, due" * windows
                raise InputError(f"row of {an(what)} has a wrong length", line=line, expected=shape, found=f"{len(found)} values")
            if found[0] != number:
                raise InputError(f"number of {an(what)} is out of order", line=line, expected=str(number), found=plain(found[0]))
            ready, due = found[-2:] if windows else (0.0, np.inf)
            self.rows.append([*found[:5], ready, due])
            self.frequency.append(found[5])
            self.combinations.append(found[7 : 7 + int(size)])
            self.at.append(line)

    def check(self, load: str) -> None:
        """Raise InputError for negative numbers and windows that close before they open; ``load`` names the fifth column."""
        table = self.columns
        refuse(table[:, 3] < 0, self.at, "service time is negative", table[:, 3], "0 or more")
        refuse(table[:, 4] < 0, self.at, f"{load} is negative", table[:, 4], "0 or more")
        refuse(table[:, 5] > table[:, 6], self.at, "time window closes before it opens", table[:, 5:], "ready time <= due date")
