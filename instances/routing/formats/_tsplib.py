"""Scanning of TSPLIB-like files: headers, sections, and the numbers in them, each with its line."""

import re
from collections.abc import Collection
from dataclasses import dataclass, field

import numpy as np

from ...errors import InputError
from ...number_arrays import Floats, Integers
from ...text import lines_of, number, numbers, shown, whole
from ._rows import refuse, refuse_negative

Lines = Integers

SET_X = re.compile(r"X-n\d+-k\d+\Z", re.I)
FLEET_IN_NAME = re.compile(r"-k(\d{1,9})\Z", re.I)

_HEADER = re.compile(r"([A-Za-z][A-Za-z0-9_]*)\s*:\s*(.*)\Z")
_SECTION = re.compile(r"([A-Za-z][A-Za-z0-9_]*_SECTION|CAPACITIES|FIXED_COSTS|VARIABLE_COSTS|NUMBER_OF_VEHICLES)\s*:?\s*\Z")


@dataclass
class Section:
    """Rows of a section with their line numbers, and the line of its title."""

    name: str
    line: int
    rows: list[tuple[int, str]] = field(default_factory=list)


@dataclass
class Specification:
    """Headers as (line, value) and sections of one file; ``end`` is the line where the data end, ``complete`` tells if EOF stands there."""

    headers: dict[str, tuple[int, str]]
    sections: dict[str, Section]
    end: int
    complete: bool = True

    def line(self, key: str) -> int:
        """Line of a header."""
        return self.headers[key][0]

    def value(self, key: str, default: str | None = None) -> str:
        """Value of a header; InputError if it is missing and has no default."""
        if key in self.headers:
            if not self.headers[key][1]:
                raise InputError(f"{key} has no value", "missing", line=self.headers[key][0])
            return self.headers[key][1]
        if default is None:
            raise InputError(f"header {key} is missing", "missing", line=self.end, expected=f"{key} : ...", found="the end of the file")
        return default

    def section(self, name: str) -> Section:
        """A section; InputError if it is missing."""
        if name not in self.sections:
            raise InputError(f"{name} is missing", "missing", line=self.end, expected=name, found="the end of the file")
        return self.sections[name]

    def whole(self, key: str) -> int:
        """A header that is a whole number of at least 1; nothing is allocated for what it claims."""
        return whole(self.value(key), self.line(key), key, least=1)

    def number(self, key: str) -> float:
        """A header that is a finite number."""
        return number(self.value(key), self.line(key), key)

    def fault(self, key: str, why: str, expected: str, found: str | None = None) -> InputError:
        """The error that a header breaks a rule."""
        held = self.value(key) if found is None else found
        return InputError(f"{key} {why}", "out-of-range", line=self.line(key), expected=expected, found=held)

    def refuse_unknown(self, headers: Collection[str], sections: Collection[str], where: str = "") -> None:
        """Raise InputError for headers and sections that would be dropped because they are not understood."""
        for key, (line, _) in self.headers.items():
            if key not in headers:
                message = f"header {shown(key)} is not supported{where}"
                raise InputError(message, "unsupported", line=line, expected=", ".join(sorted(headers)))
        for name, section in self.sections.items():
            if name not in sections:
                remark = "; fixed edges make it another problem, with another optimum" if name == "FIXED_EDGES_SECTION" else ""
                message = f"{name} is not supported{where}{remark}"
                raise InputError(message, "unsupported", line=section.line, expected=", ".join(sorted(sections)))


def scan(text: str) -> Specification:
    """Split a text into headers and sections; lines that begin with ``#`` and what follows EOF are not read."""
    headers: dict[str, tuple[int, str]] = {}
    sections: dict[str, Section] = {}
    current: Section | None = None
    last, complete = 1, False
    for at, line in lines_of(text):
        last = at
        if line.startswith("#"):
            continue
        if not line[0].isalpha():
            if current is None:
                raise InputError("neither a header nor a section", line=at, expected="KEY : value", found=shown(line))
            current.rows.append((at, line))
        elif line.upper().rstrip(" :") == "EOF":
            complete = True
            break
        elif match := _SECTION.match(line):
            name = match[1].upper()
            if name in sections:
                raise InputError(f"{name} stands twice, first in line {sections[name].line}", "duplicate", line=at)
            current = sections[name] = Section(name, at)
        elif match := _HEADER.match(line):
            key, value = match[1].upper(), match[2].strip()
            if key in headers and key != "COMMENT":
                raise InputError(f"header {key} stands twice, first in line {headers[key][0]}", "duplicate", line=at)
            headers[key] = (at, value)
            current = None
        else:
            place = "a header or a section" if current is None else f"numbers of {current.name}"
            raise InputError("line is not understood", line=at, expected=place, found=shown(line))
    if not complete and text and not text.endswith("\n"):
        message = "ends early: the last line is not ended, and EOF is missing"
        raise InputError(message, "missing", line=last, expected="EOF", found="the end of the file")
    return Specification(headers, sections, last, complete)


def node_table(spec: Specification, name: str, n: int, columns: tuple[str, ...]) -> tuple[Floats, Lines]:
    """Values of a section with one row per node, shape (n, columns), in order of the node numbers 1 to n, and the line of each."""
    section = spec.section(name)
    rows = section.rows
    if len(rows) and rows[-1][1].split() == ["-1"]:  # some writers end every section as TSPLIB ends DEPOT_SECTION
        rows = rows[:-1]
    if len(rows) != n:
        line = rows[n][0] if len(rows) > n else (rows[-1][0] if rows else section.line)
        raise InputError(f"{name} has a wrong number of rows", "wrong-shape", line=line, expected=f"{n} (DIMENSION)", found=str(len(rows)))
    values = np.empty((n, 1 + len(columns)))
    for k, (line, row) in enumerate(rows):
        cells = numbers(row, line, name)
        if len(cells) != values.shape[1]:
            expected = "node, " + ", ".join(columns)
            raise InputError(f"row of {name} has a wrong length", "wrong-shape", line=line, expected=expected, found=f"{len(cells)} values")
        values[k] = cells
    at = np.array([line for line, _ in rows], dtype=np.int64)
    nodes = values[:, 0]
    message = f"{name} names a node that does not exist"
    refuse((nodes != np.floor(nodes)) | (nodes < 1) | (nodes > n), at, message, nodes, f"1 to {n}", "unknown-name")
    order = np.argsort(nodes, kind="stable")
    twice = np.nonzero(np.diff(nodes[order]) == 0)[0]
    if len(twice):
        first, second = order[twice[0]], order[twice[0] + 1]
        message = f"{name} names node {int(nodes[second])} twice, first in line {int(at[first])}"
        raise InputError(message, "duplicate", line=int(at[second]), expected="different nodes")
    return values[order, 1:], at[order]


def node_column(spec: Specification, name: str, n: int, what: str) -> tuple[Floats, Lines]:
    """Values of a section with one number per node, none negative, and the line of each; ``what`` is the number's name."""
    table, lines = node_table(spec, name, n, (what,))
    refuse_negative(lines, **{what: table[:, 0]})
    return table[:, 0], lines


def node_list(spec: Specification, name: str, n: int) -> tuple[list[int], list[int]]:
    """Node numbers of a list, and the line of each. It ends with -1, or where another section or EOF begins, as PyVRP has it: a file that
    ends there without either may have been cut off."""
    section = spec.section(name)
    nodes: list[int] = []
    lines: list[int] = []
    tokens = [(line, token) for line, row in section.rows for token in row.split()]
    for k, (line, token) in enumerate(tokens):
        if token == "-1":
            if k + 1 < len(tokens):
                line, token = tokens[k + 1]
                raise InputError(f"{name} goes on after its end", line=line, expected="nothing after -1", found=shown(token))
            return nodes, lines
        node = whole(token, line, f"node in {name}", least=1)
        if node > n:
            raise InputError(f"{name} names a node that does not exist", "unknown-name", line=line, expected=f"1 to {n}", found=token)
        if node in nodes:
            raise InputError(f"{name} names node {node} twice", "duplicate", line=line, expected="different nodes")
        nodes.append(node)
        lines.append(line)
    ended = spec.complete or section is not list(spec.sections.values())[-1]
    if nodes and ended:
        return nodes, lines
    line, expected = lines[-1] if lines else section.line, "-1" if ended else "-1 or EOF"
    raise InputError(f"{name} ends early", "missing", line=line, expected=expected, found="the end of the section")


LAYOUTS = {
    "FULL_MATRIX": None,
    "LOWER_ROW": ("lower", 1), "UPPER_COL": ("lower", 1), "UPPER_ROW": ("upper", 1), "LOWER_COL": ("upper", 1),
    "LOWER_DIAG_ROW": ("lower", 0), "UPPER_DIAG_COL": ("lower", 0), "UPPER_DIAG_ROW": ("upper", 0), "LOWER_DIAG_COL": ("upper", 0),
}  # fmt: skip
"""Triangle that the entries of each layout list row by row, and its first diagonal: columns of one triangle are rows of the other one."""


def edge_weights(spec: Specification, n: int) -> tuple[Floats, Lines]:
    """The matrix of an EDGE_WEIGHT_SECTION, wrapped at any place and a triangle mirrored, and the line of each entry."""
    layout = spec.value("EDGE_WEIGHT_FORMAT").upper()
    if layout not in LAYOUTS:
        line, expected = spec.line("EDGE_WEIGHT_FORMAT"), ", ".join(LAYOUTS)
        raise InputError(f"EDGE_WEIGHT_FORMAT {shown(layout)} is not supported", "unsupported", line=line, expected=expected)
    triangle = LAYOUTS[layout]
    size = n * n if triangle is None else n * (n + 1) // 2 - triangle[1] * n
    section = spec.section("EDGE_WEIGHT_SECTION")
    values: list[float] = []
    counts: list[int] = []
    for line, row in section.rows:
        cells = numbers(row, line, section.name)
        values.extend(cells)
        counts.append(len(cells))
    if len(values) != size:
        line = section.line
        if counts:
            line = section.rows[min(int(np.searchsorted(np.cumsum(counts), size, side="right")), len(counts) - 1)][0]
        message = f"EDGE_WEIGHT_SECTION has a wrong number of values for {layout}"
        raise InputError(message, "wrong-shape", line=line, expected=f"{size} (DIMENSION {n})", found=str(len(values)))
    flat = np.array(values)
    at = np.repeat(np.array([line for line, _ in section.rows], dtype=np.int64), counts)
    if triangle is None:
        matrix, lines = flat.reshape(n, n).copy(), at.reshape(n, n)
        refuse((flat < 0) & ~np.eye(n, dtype=bool).ravel(), at, "distance is negative", flat, "0 or more")
    else:
        i, j = np.tril_indices(n, -triangle[1]) if triangle[0] == "lower" else np.triu_indices(n, triangle[1])
        refuse((flat < 0) & (i != j), at, "distance is negative", flat, "0 or more")
        matrix, lines = np.zeros((n, n)), np.zeros((n, n), dtype=np.int64)
        for target, source in ((matrix, flat), (lines, at)):
            target[i, j] = target[j, i] = source
    np.fill_diagonal(matrix, 0.0)
    return matrix, lines
