"""``waybound warm``: the compiled loops of all methods, made before they are needed."""

import contextlib
import sys
import time
from collections.abc import Callable
from typing import Annotated

from ..instances.errors import UsageError
from .options import Quiet, Verbose, arg
from .output import print_text

_Names = Annotated[list[str] | None, arg("[PART]...", "Only loops whose names hold one of these: routing.")]


def warm(names: _Names = None, quiet: Quiet = False, verbose: Verbose = False) -> None:
    """Compile the inner loops of all methods ahead of time, once on each machine; those already compiled are skipped."""
    from ..formulations.kernels import kernel_modules, kernels

    began = time.perf_counter()
    every = [one for module in kernel_modules() for one in kernels(module)]
    for name in names or ():
        if not any(name in one.title for one in every):
            raise UsageError(f"no loop is named like {name!r}; without names all are compiled", "unknown-name")
    chosen = [one for one in every if not names or any(name in one.title for name in names)]
    missing = [one for one in chosen if not one.kept()]
    with contextlib.ExitStack() as stack:
        tell = _bar(stack, len(missing)) if missing and not quiet and sys.stderr.isatty() else None
        for one in missing:
            if tell is not None:
                tell(one.title)
            one.make()
            if verbose:
                print_text(one.title)
    if missing:
        many = f"{len(missing)} loop{'s' if len(missing) != 1 else ''} compiled in {time.perf_counter() - began:.1f} s"
        print_text(f"{many}, {len(chosen) - len(missing)} were ready")
    else:
        print_text(f"ready before: {len(chosen)} loop{'s' if len(chosen) != 1 else ''}, nothing to compile")
    if not all(one.cached() for one in missing):
        print_text("they are not kept: no folder for them can be written, and NUMBA_CACHE_DIR names none")


def _bar(stack: contextlib.ExitStack, count: int) -> Callable[[str], None]:
    """A progress bar on standard error, which names the loop that comes next."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("{task.description}", markup=False))
    bar = stack.enter_context(Progress(*columns, console=Console(file=sys.stderr), transient=True))
    task, begun = bar.add_task("", total=count), 0

    def tell(title: str) -> None:
        nonlocal begun
        bar.update(task, description=title, completed=begun)
        begun += 1

    return tell
