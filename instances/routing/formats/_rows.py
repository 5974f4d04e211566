"""Rows of numbers in formats without titles: the head that a format is known by, and tables of fixed width."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...text import is_number, lines_of, number, numbers, shown

Floats = NDArray[np.float64]


def head(text: str, count: int) -> list[list[str]]:
    """Tokens of the first ``count`` lines that are not blank, fewer where there are fewer."""
    found: list[list[str]] = []
    start = 0
    while start < len(text) and len(found) < count:
        end = text.find("\n", start)
        line = text[start:end] if end >= 0 else text[start:]
        if line.strip():
            found.append(line.split())
        start += len(line) + 1
    return found


def widths(lines: Sequence[Sequence[str]]) -> list[int]:
    """Number of tokens of each line, -1 for one that holds anything but numbers."""
    return [len(line) if all(map(is_number, line)) else -1 for line in lines]


@dataclass
class Rows:
    """Lines of a text, read one after the other."""

    lines: list[tuple[int, str]]
    at: int = 0

    @classmethod
    def of(cls, text: str) -> Rows:
        return cls(lines_of(text))

    def next(self, what: str) -> tuple[int, str]:
        """The next line and its number; InputError at the end of the file."""
        if self.at >= len(self.lines):
            raise InputError("ends early", line=self.lines[-1][0], expected=what, found="the end of the file")
        self.at += 1
        return self.lines[self.at - 1]

    def values(self, what: str, names: Sequence[str]) -> tuple[int, list[float]]:
        """The next line as one number for each of ``names``."""
        line, text = self.next(what)
        found = numbers(text, line, what)
        if len(found) != len(names):
            raise InputError(f"{what} has a wrong length", line=line, expected=", ".join(names), found=f"{len(found)} values")
        return line, found

    def keyed(self, key: str) -> tuple[int, str]:
        """The value of a line ``key value``."""
        line, text = self.next(f"{key} and its value")
        tokens = text.split()
        if len(tokens) != 2 or tokens[0].lower() != key:
            raise InputError(f"{key} is missing", line=line, expected=f"{key} and its value", found=shown(text))
        return line, tokens[1]

    def table(self, what: str, names: Sequence[str], count: int | None = None) -> tuple[Floats, list[int]]:
        """All lines that are left, and the number of each.

        Parameters
        ----------
        what : str
            What a row is, for messages.
        names : sequence of str
            Of the columns.
        count : int, optional
            Number of rows that the file claims.
        """
        left = self.lines[self.at :]
        if count is not None and len(left) != count:
            line = left[count][0] if len(left) > count else self.lines[-1][0]
            raise InputError(f"wrong number of rows: {what}", line=line, expected=str(count), found=str(len(left)))
        rows = [self.values(what, names) for _ in left]
        return np.array([row for _, row in rows], dtype=np.float64).reshape(len(rows), len(names)), [line for line, _ in rows]

    def end(self) -> None:
        """InputError unless all lines are read."""
        if self.at < len(self.lines):
            line, text = self.lines[self.at]
            raise InputError("goes on after its end", line=line, expected="the end of the file", found=shown(text))


def positive(token: str, line: int, what: str) -> float:
    """A finite number above 0."""
    value = number(token, line, what)
    if value <= 0:
        raise InputError(f"{what} must be positive", line=line, expected="more than 0", found=shown(token))
    return value
