"""``waybound compare``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..instances.errors import UsageError
from ..solvers import interrupts
from .delivery import PLOT_SUFFIXES, Delivery, check_matplotlib, check_outputs
from .handling import complain, nothing_found
from .options import Json, Log, Quiet, Seed, Source, Threads, Verbose, arg, bounded, opt
from .output import lines_text, print_json, print_table, print_text, stdout_is_ours, table_text
from .progress import Progress

if TYPE_CHECKING:
    from ..reports.comparison import Comparison

TABLE_SUFFIXES = (".csv", ".json")


def compare(
    source: Source,
    other: Annotated[
        str | None, arg("[RESULTS]", "A second results file, of waybound bench: FILE is one too, and the two are compared.")
    ] = None,
    solver: Annotated[list[str] | None, opt("--solver NAME", "A solver to compare. Repeatable.", "solver")] = None,
    heuristic: Annotated[list[str] | None, opt("--heuristic NAME", "A heuristic to compare. Repeatable.", "heuristic")] = None,
    time_limit: Annotated[float, opt("--time-limit S", "Seconds for each search alone.")] = 60.0,
    bound_time: Annotated[float | None, opt("--bound-time S", "Seconds for bounding after each; a tenth of the limit by default.")] = None,
    seed: Seed = 1,
    threads: Threads = 1,
    isolate: Annotated[bool, opt("--isolate", "Run each in a process of its own, with hard limits.")] = False,
    out: Annotated[Path | None, opt("--out FILE", "Write the table: .csv, or .json with all solutions.")] = None,
    plot: Annotated[Path | None, opt("--plot FILE", "Draw the progress of all: .png, .svg or .pdf.")] = None,
    log: Log = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Solve an instance by several solvers and heuristics, and set their answers, all checked, against the best verified bound.

    Exit code 0 with an answer, 3 if it is proved that there is none, 4 if nothing was found, 5 if results contradict each other. Of two
    results files: 1 if a method is worse in the second one, beyond noise, else 0.
    """
    if other is not None:
        if solver or heuristic or plot is not None:
            raise UsageError("two results files are compared as they are: --solver, --heuristic and --plot are of no use")
        _before_and_after(Path(source.file), Path(other), out, json)
        return
    names = [*(solver or ()), *(heuristic or ())]
    if not names:
        raise UsageError("name what is to be compared: --solver NAME, --heuristic NAME, several times", "missing")
    bounded(time_limit=time_limit, bound_time=bound_time, seed=seed, threads=threads)
    problem = source.read()
    check_outputs(source.inputs(), log, out=(out, TABLE_SUFFIXES), plot=(plot, PLOT_SUFFIXES))
    if plot is not None:
        check_matplotlib()

    from ..formulations.json_text import json_text
    from ..reports.comparison import compare as by_all

    interrupts.keep()
    with Progress(quiet, log, logged=True) as progress, stdout_is_ours():
        comparison = by_all(
            problem, names, time_limit=time_limit, bound_time=bound_time, seed=seed, threads=threads, isolate=isolate, progress=progress,
            log=progress.log,
        )  # fmt: skip
    delivery = Delivery(verbose)
    delivery.file("--out", out, lambda path: _write(comparison, path))
    delivery.file("--plot", plot, lambda path: _draw(comparison, path))
    delivery.show(
        lambda: json_text(comparison.to_json()) if json else _shown(comparison), lambda: str(comparison.to_frame().to_csv(index=False))
    )
    for fault in comparison.faults:
        complain(fault)
    without = 3 if comparison.infeasible else nothing_found()
    raise typer.Exit(5 if comparison.faults else delivery.code or (0 if comparison.best is not None else without))


def _before_and_after(first: Path, second: Path, out: Path | None, json: bool) -> None:
    """The regression check of two results files; ends with 1 where a method is worse beyond noise."""
    from ..formulations.json_text import json_text
    from ..instances.atomic import atomic_write
    from ..reports.campaigns.frames import results
    from ..reports.campaigns.regression import regression, regression_table

    check_outputs([str(first), str(second)], out=(out, TABLE_SUFFIXES))
    changes = regression(results(first), results(second))
    if out is not None:
        import pandas as pd

        table = pd.DataFrame(changes.to_json()["changes"])
        atomic_write(out, json_text(changes.to_json()) if out.suffix.lower() == ".json" else table.to_csv(index=False))
    if json:
        print_json(changes.to_json())
    else:
        print_table(regression_table(changes))
        for note in changes.notes:
            print_text(f"note: {note}")
        print_text("worse beyond noise" if changes.worse else "nothing is worse beyond noise")
    raise typer.Exit(int(changes.worse))


def _shown(comparison: Comparison) -> str:
    from ..reports.tables.comparison import comparison_lines, comparison_table

    return table_text(comparison_table(comparison)) + lines_text("", comparison_lines(comparison)).lstrip("\n")


def _write(comparison: Comparison, path: Path) -> None:
    from ..formulations.json_text import json_text
    from ..instances.atomic import atomic_write

    text = json_text(comparison.to_json()) if path.suffix.lower() == ".json" else comparison.to_frame().to_csv(index=False)
    atomic_write(path, text)


def _draw(comparison: Comparison, path: Path) -> None:
    from ..reports.plots import save_axes
    from ..reports.plots.drawing import axes_without_display

    save_axes(comparison.plot(ax=axes_without_display()), path)
