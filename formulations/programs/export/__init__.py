"""Exports of programs: MPS and LP files, and models of HiGHS, PuLP, CVXPY and MathOpt."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from ....instances.errors import UsageError

if TYPE_CHECKING:
    from ..program import Program

SUFFIXES = (".mps", ".lp")


def write_program(program: "Program", path: str | PathLike[str], *, names: bool = True) -> None:
    """Write a program as free MPS or as LP (the format of CPLEX), by the suffix; whole or not at all.

    ``program``: linear or with a quadratic objective, without cones and circuits, with one objective. ``path``: ends in ``.mps`` or
    ``.lp``. ``names``: write the names of variables and rows, such as ``time(17,4,2)``; without, ``x0, x1, ...`` and ``r0, r1, ...``.
    Raises UsageError if the suffix is another one. Raises UnsupportedError if the program has cones, circuits, or several objectives in
    order of priority. Raises InputError if the data hold a NaN or sides that cross, which neither format can express, or the file cannot be
    written.
    """
    from ....instances.atomic import atomic_write
    from ._checks import check_export, refuse_crossing
    from .lp import lp_text
    from .mps import mps_text

    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise UsageError(f"programs are written as {' or '.join(SUFFIXES)}, not as {suffix or 'a file without suffix'}", "unknown-name")
    check_export(program, f"a {suffix} file")
    refuse_crossing(program)
    text = mps_text if suffix == ".mps" else lp_text
    atomic_write(path, text(program, names=names))
