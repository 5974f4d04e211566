"""Names that files, their readers, and modelling packages agree on: a variable is called the same wherever a program is handed to."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .program import Program

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
    return readable_names(program.num_variables, program.variable_name, "x")


def row_names(program: Program) -> list[str]:
    """The name of each row in every export."""
    return readable_names(program.num_rows, program.row_name, "r")


def block_names(program: Program) -> list[str]:
    """The name of each block of variables: a name that occurs again gets a number."""
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


def readable_names(count: int, name: Callable[[int], str], prefix: str) -> list[str]:
    """Different names made from ``name(k)``: ``time[17,4,2]`` becomes ``time(17,4,2)``.

    Parameters
    ----------
    count : int
    name : callable
        ``Program.variable_name`` or ``Program.row_name``.
    prefix : str
        One letter, put before a name that would not do as it is.
    """
    taken: set[str] = set()
    made = []
    for k in range(count):
        text = _FORBIDDEN.sub("_", name(k).translate(_BRACKETS))
        if not text or len(text) > LONGEST or text.lower() in RESERVED or _NUMBERLIKE.match(text):
            text = f"{prefix}_{text[:LONGEST]}"
        if text in taken:
            text = f"{text}_{prefix}{k}"
            while text in taken:
                text += "_"
        taken.add(text)
        made.append(text)
    return made


def plain_names(count: int, prefix: str) -> list[str]:
    """``x0, x1, ...``"""
    return [f"{prefix}{k}" for k in range(count)]
