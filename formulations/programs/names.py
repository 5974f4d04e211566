"""Names of variables and rows that files, their readers and modelling packages agree on."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .program import Program, Rows, Variables

RESERVED = frozenset(
    {
        "max", "maximize", "maximise", "maximum", "min", "minimize", "minimise", "minimum", "subject", "such", "st", "s.t.", "bound",
        "bounds",
        "free", "inf", "infinity", "gen", "general", "generals", "int", "integer", "integers", "bin", "binary", "binaries", "semi",
        "semis", "sos", "sos1", "sos2", "end", "obj", "rhs", "rng", "bnd", "marker", "objsense",
    }
)  # fmt: skip
LONGEST = 200

_BRACKETS = str.maketrans("[]", "()")
_FORBIDDEN = re.compile(r"[^A-Za-z0-9_(),.]")
_NUMBERLIKE = re.compile(r"[^A-Za-z_]|[eE][0-9.]|[eE]$|inf|nan", re.IGNORECASE)


def column_names(program: Program) -> list[str]:
    """The name of each variable in every export: ``load_flow(1,2)`` for ``load-flow[1,2]``."""
    return readable_names(program.variables, "x")


def row_names(program: Program) -> list[str]:
    """The name of each row in every export."""
    return readable_names(program.rows, "r")


def file_names(program: Program, *, readable: bool) -> tuple[list[str], list[str]]:
    """Names of columns and rows in a file: those of every export where ``readable``, else ``x0, x1, ...`` and ``r0, r1, ...``."""
    if readable:
        return column_names(program), row_names(program)
    return [f"x{j}" for j in range(program.num_variables)], [f"r{i}" for i in range(program.num_rows)]


def own_names(blocks: Iterable[Variables | Rows]) -> list[str]:
    """``Program.variable_name`` of all variables, or ``row_name`` of all rows."""
    return [name for block in blocks for name in _in_brackets(block, block.name, str, "[", "]")]


def block_names(program: Program) -> list[str]:
    """Name of each block of variables, with a number where it occurs again."""
    seen: dict[str, int] = {}
    names = []
    for block in program.variables:
        if block.size:
            seen[block.name] = seen.get(block.name, 0) + 1
        names.append(block.name if seen.get(block.name, 0) <= 1 else f"{block.name}.{seen[block.name]}")
    return names


def in_block(name: str, k: int) -> str:
    """The k-th variable of a block, where only vectors have names."""
    return f"{name}#{k}"


def readable_names(blocks: Iterable[Variables | Rows], prefix: str) -> list[str]:
    """Different names made from those of blocks: ``time(17,4,2)`` from ``time[17,4,2]``, ``prefix`` before reserved or numeric ones."""
    readable: list[str] = []
    for block in blocks:
        start = _spelt(block.name)
        names = _in_brackets(block, start, _spelt, "(", ")")
        # What makes a name unfit stands at its beginning, but for its length; without brackets it is looked at as a whole.
        fit = not _unfit(f"{start}(") and all(name.endswith(")") for name in names[:1])
        if not fit or max(map(len, names), default=0) > LONGEST:
            names = [f"{prefix}_{name[:LONGEST]}" if _unfit(name) else name for name in names]
        readable += names
    return readable if len(set(readable)) == len(readable) else _different(readable, prefix)


def _in_brackets(block: Variables | Rows, start: str, spelt: Callable[[str], str], opened: str, closed: str) -> list[str]:
    """Names of the entries of a block; each label is spelt once."""
    if not block.keys:
        return [start] if block.size == 1 else [f"{start}{opened}{k}{closed}" for k in range(block.size)]
    parts = []
    for position, key in enumerate(block.keys):
        labels = block.labels[position] if position < len(block.labels) else None
        entries = key.tolist()
        texts = {k: spelt(str(k if labels is None else labels[k])) for k in set(entries)}
        parts.append([texts[k] for k in entries])
    begin = start + opened
    return [begin + ",".join(words) + closed for words in zip(*parts, strict=True)]


def _spelt(text: str) -> str:
    return _FORBIDDEN.sub("_", text.translate(_BRACKETS))


def _unfit(text: str) -> bool:
    return not text or len(text) > LONGEST or text.lower() in RESERVED or _NUMBERLIKE.match(text) is not None


def _different(names: list[str], prefix: str) -> list[str]:
    """The same names, made different by adding its index to each that repeats an earlier one."""
    taken: set[str] = set()
    different = []
    for k, text in enumerate(names):
        if text in taken:
            text = f"{text}_{prefix}{k}"
            while text in taken:
                text += "_"
        taken.add(text)
        different.append(text)
    return different
