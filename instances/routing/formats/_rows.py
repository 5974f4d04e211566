"""Rows of numbers in formats without titles: the head that a format is known by, and tables of fixed width."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import Code, InputError
from ...number_arrays import Flags, Floats, Integers
from ...text import is_number, lines_of, numbers, shown


def head(text: str, count: int) -> list[list[str]]:
    """Tokens of the first ``count`` lines that are not blank, fewer where there are fewer."""
    lines: list[list[str]] = []
    start = 0
    while start < len(text) and len(lines) < count:
        end = text.find("\n", start)
        line = text[start:end] if end >= 0 else text[start:]
        if line.strip():
            lines.append(line.split())
        start += len(line) + 1
    return lines


def widths(lines: Sequence[Sequence[str]]) -> list[int]:
    """Number of tokens of each line, -1 for one that holds anything but numbers."""
    return [len(line) if all(map(is_number, line)) else -1 for line in lines]


@dataclass
class Rows:
    """Lines of a text, read one after the other."""

    lines: list[tuple[int, str]]
    at: int = 0

    @classmethod
    def of(cls, text: str) -> "Rows":
        return cls(lines_of(text))

    def next(self, what: str) -> tuple[int, str]:
        """The next line and its number; InputError at the end of the file."""
        if self.at >= len(self.lines):
            raise InputError("ends early", "missing", line=self.lines[-1][0], expected=what, found="the end of the file")
        self.at += 1
        return self.lines[self.at - 1]

    def tokens(self, what: str, expected: str, count: int) -> tuple[int, list[str]]:
        """The next line, which is called ``what``, as ``count`` tokens."""
        line, text = self.next(expected)
        tokens = text.split()
        if len(tokens) != count:
            raise InputError(f"{what} has a wrong length", "wrong-shape", line=line, expected=expected, found=f"{len(tokens)} values")
        return line, tokens

    def values(self, what: str, names: Sequence[str]) -> tuple[int, list[float]]:
        """The next line as one number for each of ``names``."""
        line, text = self.next(what)
        values = numbers(text, line, what)
        if len(values) != len(names):
            message = f"{what} has a wrong length"
            raise InputError(message, "wrong-shape", line=line, expected=", ".join(names), found=f"{len(values)} values")
        return line, values

    def keyed(self, key: str) -> tuple[int, str]:
        """The value of a line ``key value``."""
        line, text = self.next(f"{key} and its value")
        tokens = text.split()
        if len(tokens) != 2 or tokens[0].lower() != key:
            raise InputError(f"{key} is missing", "missing", line=line, expected=f"{key} and its value", found=shown(text))
        return line, tokens[1]

    def table(self, what: str, names: Sequence[str], count: int | None = None) -> tuple[Floats, list[int]]:
        """All remaining lines as rows of the columns ``names``, and the number of each line; ``count`` is what the file claims."""
        rest = self.lines[self.at :]
        if count is not None and len(rest) != count:
            line = rest[count][0] if len(rest) > count else self.lines[-1][0]
            raise InputError(f"wrong number of rows: {what}", "wrong-shape", line=line, expected=str(count), found=str(len(rest)))
        rows = [self.values(what, names) for _ in rest]
        return np.array([row for _, row in rows], dtype=np.float64).reshape(len(rows), len(names)), [line for line, _ in rows]

    def end(self) -> None:
        """InputError unless all lines are read."""
        if self.at < len(self.lines):
            line, text = self.lines[self.at]
            raise InputError("goes on after its end", line=line, expected="the end of the file", found=shown(text))


def refuse(
    bad: Flags | np.bool_, lines: Sequence[int] | Integers, message: str, found: Iterable[object], expected: str,
    code: Code = "out-of-range",
) -> None:  # fmt: skip
    """Raise InputError for the first row that is ``bad``, with its line and what it holds."""
    if np.any(bad):
        k = int(np.argmax(bad))
        raise InputError(message, code, line=int(lines[k]), expected=expected, found=str(list(found)[k]))


def refuse_negative(lines: Sequence[int] | np.ndarray, **columns: Floats) -> None:
    """Raise InputError for the first negative number of each column, which is named by its keyword, and its line."""
    for name, values in columns.items():
        refuse(values < 0, lines, f"{name.replace('_', ' ')} is negative", values, "0 or more")


def refuse_closed(lines: Sequence[int] | np.ndarray, windows: Floats) -> None:
    """Raise InputError for the first window, shape (rows, 2), that closes before it opens."""
    refuse(windows[:, 0] > windows[:, 1], lines, "time window closes before it opens", windows, "ready time <= due date", "contradiction")


def refuse_other_size(name: str, what: str, sizes: Collection[int], count: int, line: int) -> None:
    """Raise InputError where the name of a published file stands for another number: not ``count``, but one of ``sizes``."""
    if count not in sizes:
        message = f"ends early or is changed: the name {name} stands for another number of {what}; rename it if this is meant"
        raise InputError(message, "wrong-shape", line=line, expected=" or ".join(map(str, sizes)), found=str(count))
