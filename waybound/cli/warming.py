"""``waybound warm``: the compiled loops of all methods, made before they are needed."""

from __future__ import annotations

import contextlib
import sys
import time
from typing import Annotated

import typer

from .options import Quiet, Verbose
from .output import print_text

_Names = Annotated[list[str] | None, typer.Argument(metavar="[PART]...", help="Only loops whose names hold one of these: routing.")]


def warm(names: _Names = None, quiet: Quiet = False, verbose: Verbose = False) -> None:
    """Compile the loops of all methods, once a machine: what is compiled already is passed over."""
    from ..formulations.kernels import kernel_modules, kernels

    began = time.perf_counter()
    every = [one for module in kernel_modules() for one in kernels(module)]
    asked = [one for one in every if not names or any(name in one.title for name in names)]
    left = [one for one in asked if not one.kept()]
    with contextlib.ExitStack() as stack:
        told = None
        if left and not quiet and sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

            columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("{task.description}", markup=False))
            bar = stack.enter_context(Progress(*columns, console=Console(file=sys.stderr), transient=True))
            told = (bar, bar.add_task("", total=len(left)))
        for one in left:
            if told is not None:
                told[0].update(told[1], description=one.title)
            one.make()
            if told is not None:
                told[0].advance(told[1])
    kept = [one for one in left if one.kept()] if left else []
    seconds = time.perf_counter() - began
    print_text(
        f"{len(left)} loops compiled in {seconds:.1f} s, {len(asked) - len(left)} were ready"
        if left
        else f"all {len(asked)} loops are ready"
    )
    if len(kept) < len(left):
        print_text("no folder for compiled loops can be written; NUMBA_CACHE_DIR names one")
