"""Scanning of TSPLIB-like files: headers, sections, and the numbers in them, each with its line."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...text import lines_of, numbers, refuse, shown, whole

Floats = NDArray[np.float64]
Lines = NDArray[np.int64]

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
    """Headers as (line, value) and sections of one file; ``end`` is the line where the data end, ``complete`` whether EOF stands there."""

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
                raise InputError(f"{key} has no value", line=self.headers[key][0])
            return self.headers[key][1]
        if default is None:
            raise InputError(f"header {key} is missing", line=self.end, expected=f"{key} : ...", found="the end of the file")
        return default

    def section(self, name: str) -> Section:
        """A section; InputError if it is missing."""
        if name not in self.sections:
            raise InputError(f"{name} is missing", line=self.end, expected=name, found="the end of the file")
        return self.sections[name]

    def dimension(self) -> int:
        """The claimed number of nodes, which nothing is allocated for."""
        return whole(self.value("DIMENSION"), self.line("DIMENSION"), "DIMENSION", least=1)

    def refuse_unknown(self, headers: Collection[str], sections: Collection[str], where: str = "") -> None:
        """Raise InputError for what would be dropped if it were not understood."""
        for key, (line, _) in self.headers.items():
            if key not in headers:
                raise InputError(f"header {shown(key)} is not supported{where}", line=line, expected=", ".join(sorted(headers)))
        for name, section in self.sections.items():
            if name not in sections:
                remark = "; fixed edges make it another problem, with another optimum" if name == "FIXED_EDGES_SECTION" else ""
                raise InputError(f"{name} is not supported{where}{remark}", line=section.line, expected=", ".join(sorted(sections)))


def scan(text: str) -> Specification:
    """Split a text into headers and sections; lines that begin with ``#`` and what follows EOF are not read."""
    headers: dict[str, tuple[int, str]] = {}
    sections: dict[str, Section] = {}
    current: Section | None = None
    last, complete = 1, False
    for number, line in lines_of(text):
        last = number
        if line.startswith("#"):
            continue
        if not line[0].isalpha():
            if current is None:
                raise InputError("neither a header nor a section", line=number, expected="KEY : value", found=shown(line))
            current.rows.append((number, line))
        elif line.upper().rstrip(" :") == "EOF":
            complete = True
            break
        elif match := _SECTION.match(line):
            name = match[1].upper()
            if name in sections:
                raise InputError(f"{name} stands twice, first in line {sections[name].line}", line=number)
            current = sections[name] = Section(name, number)
        elif match := _HEADER.match(line):
            key, value = match[1].upper(), match[2].strip()
            if key in headers and key != "COMMENT":
                raise InputError(f"header {key} stands twice, first in line {headers[key][0]}", line=number)
            headers[key] = (number, value)
            current = None
        else:
            place = "a header or a section" if current is None else f"numbers of {current.name}"
            raise InputError("line is not understood", line=number, expected=place, found=shown(line))
    if not complete and text and not text.endswith("\n"):
        raise InputError(
            "ends early: the last line is not ended, and EOF is missing", line=last, expected="EOF", found="the end of the file"
        )
    return Specification(headers, sections, last, complete)


def node_table(spec: Specification, name: str, n: int, columns: tuple[str, ...]) -> tuple[Floats, Lines]:
    """Values of a section with one row a node, in order of the node numbers 1 to n, and the line of each.

    Returns
    -------
    (array of shape (n, columns), array of n line numbers)
    """
    section = spec.section(name)
    rows = section.rows
    if len(rows) and rows[-1][1].split() == ["-1"]:  # some writers end every section as TSPLIB ends DEPOT_SECTION
        rows = rows[:-1]
    if len(rows) != n:
        line = rows[n][0] if len(rows) > n else (rows[-1][0] if rows else section.line)
        raise InputError(f"{name} has a wrong number of rows", line=line, expected=f"{n} (DIMENSION)", found=str(len(rows)))
    width = 1 + len(columns)
    values = np.empty((n, width))
    for k, (line, row) in enumerate(rows):
        found = numbers(row, line, name)
        if len(found) != width:
            raise InputError(
                f"row of {name} has a wrong length", line=line, expected="node, " + ", ".join(columns), found=f"{len(found)} values"
            )
        values[k] = found
    at = np.array([line for line, _ in rows], dtype=np.int64)
    nodes = values[:, 0]
    refuse((nodes != np.floor(nodes)) | (nodes < 1) | (nodes > n), at, f"{name} names a node that does not exist", nodes, f"1 to {n}")
    order = np.argsort(nodes, kind="stable")
    twice = np.nonzero(np.diff(nodes[order]) == 0)[0]
    if len(twice):
        first, second = order[twice[0]], order[twice[0] + 1]
        raise InputError(
            f"{name} names node {int(nodes[second])} twice, first in line {int(at[first])}",
            line=int(at[second]),
            expected="different nodes",
        )
    return values[order, 1:], at[order]


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
                raise InputError(
                    f"{name} goes on after its end", line=tokens[k + 1][0], expected="nothing after -1", found=shown(tokens[k + 1][1])
                )
            return nodes, lines
        node = whole(token, line, f"node in {name}", least=1)
        if node > n:
            raise InputError(f"{name} names a node that does not exist", line=line, expected=f"1 to {n}", found=token)
        if node in nodes:
            raise InputError(f"{name} names node {node} twice", line=line, expected="different nodes")
        nodes.append(node)
        lines.append(line)
    last = section is list(spec.sections.values())[-1]
    if nodes and (spec.complete or not last):
        return nodes, lines
    raise InputError(
        f"{name} ends early",
        line=lines[-1] if lines else section.line,
        expected="-1" if spec.complete or not last else "-1 or EOF",
        found="the end of the section",
    )


def edge_weights(spec: Specification, n: int) -> tuple[Floats, Lines]:
    """The matrix of an EDGE_WEIGHT_SECTION, wrapped at any place, and the line of each entry.

    A triangle is mirrored: COL layouts of one triangle list the entries of the other one row by row.
    """
    layout = spec.value("EDGE_WEIGHT_FORMAT").upper()
    sizes = {
        "FULL_MATRIX": n * n,
        "LOWER_ROW": n * (n - 1) // 2, "UPPER_COL": n * (n - 1) // 2, "UPPER_ROW": n * (n - 1) // 2, "LOWER_COL": n * (n - 1) // 2,
        "LOWER_DIAG_ROW": n * (n + 1) // 2, "UPPER_DIAG_COL": n * (n + 1) // 2,
        "UPPER_DIAG_ROW": n * (n + 1) // 2, "LOWER_DIAG_COL": n * (n + 1) // 2,
    }  # fmt: skip
    if layout not in sizes:
        raise InputError(
            f"EDGE_WEIGHT_FORMAT {shown(layout)} is not supported", line=spec.line("EDGE_WEIGHT_FORMAT"), expected=", ".join(sizes)
        )
    section = spec.section("EDGE_WEIGHT_SECTION")
    values: list[float] = []
    counts: list[int] = []
    for line, row in section.rows:
        found = numbers(row, line, section.name)
        values.extend(found)
        counts.append(len(found))
    size = sizes[layout]
    if len(values) != size:
        line = section.line
        if counts:
            line = section.rows[min(int(np.searchsorted(np.cumsum(counts), size, side="right")), len(counts) - 1)][0]
        raise InputError(
            f"EDGE_WEIGHT_SECTION has a wrong number of values for {layout}", line=line, expected=f"{size} (DIMENSION {n})",
            found=str(len(values)),
        )  # fmt: skip
    flat = np.array(values)
    at = np.repeat(np.array([line for line, _ in section.rows], dtype=np.int64), counts)
    if layout == "FULL_MATRIX":
        matrix, where = flat.reshape(n, n).copy(), at.reshape(n, n)
        off = ~np.eye(n, dtype=bool).ravel()
    else:
        diagonal = "DIAG" in layout
        lower = layout in ("LOWER_ROW", "UPPER_COL", "LOWER_DIAG_ROW", "UPPER_DIAG_COL")
        i, j = np.tril_indices(n, 0 if diagonal else -1) if lower else np.triu_indices(n, 0 if diagonal else 1)
        matrix, where = np.zeros((n, n)), np.zeros((n, n), dtype=np.int64)
        for target, source in ((matrix, flat), (where, at)):
            target[i, j] = source
            target[j, i] = source
        off = i != j
    refuse((flat < 0) & off, at, "distance is negative", flat, "0 or more")
    np.fill_diagonal(matrix, 0.0)
    return matrix, where
