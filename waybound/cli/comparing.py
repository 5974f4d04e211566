"""``waybound compare``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..instances.errors import MissingPackageError, UsageError
from ..solvers import interrupts
from .delivery import Delivery
from .options import (
    Convention,
    File,
    Format,
    Json,
    Log,
    Objective,
    ProblemName,
    Quiet,
    Seed,
    Set,
    Threads,
    Verbose,
    bounded,
    complain,
    distinct_paths,
    inputs_of,
    log_path,
    output_path,
    read_problem,
)
from .solving import PLOT_SUFFIXES

if TYPE_CHECKING:
    from ..reports.comparison import Comparison

TABLE_SUFFIXES = (".csv", ".json")


def compare(
    file: File,
    solver: Annotated[list[str] | None, typer.Option("--solver", metavar="NAME", help="A solver to compare. Repeatable.")] = None,
    heuristic: Annotated[list[str] | None, typer.Option("--heuristic", metavar="NAME", help="A heuristic to compare. Repeatable.")] = None,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    settings: Set = None,
    objective: Objective = None,
    convention: Convention = None,
    time_limit: Annotated[float, typer.Option("--time-limit", metavar="S", help="Seconds for each search alone.")] = 60.0,
    bound_time: Annotated[
        float | None, typer.Option("--bound-time", metavar="S", help="Seconds for bounding after each; a tenth of the limit by default.")
    ] = None,
    seed: Seed = 1,
    threads: Threads = 1,
    isolate: Annotated[bool, typer.Option("--isolate", help="Run each in a process of its own, with hard limits.")] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the table: .csv, or .json with all solutions.")] = None,
    plot: Annotated[Path | None, typer.Option("--plot", metavar="FILE", help="Draw the progress of all: .png, .svg or .pdf.")] = None,
    log: Log = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Solve an instance by several solvers and heuristics, and set their answers, all checked, against the best verified bound.

    Exit code 0 with an answer, 3 if it is proved that there is none, 4 if nothing was found, 5 if results contradict each other.
    """
    names = [*(solver or ()), *(heuristic or ())]
    if not names:
        raise UsageError("name what is to be compared: --solver NAME, --heuristic NAME, several times")
    bounded(time_limit=time_limit, bound_time=bound_time, seed=seed, threads=threads)
    asked = read_problem(file, format, problem, convention, settings, objective)
    distinct_paths(out=out, plot=plot)
    inputs = inputs_of(file, settings)
    output_path("--out", out, TABLE_SUFFIXES, unlike=inputs)
    output_path("--plot", plot, PLOT_SUFFIXES, unlike=inputs)
    log_path(log, inputs, out, plot)
    if plot is not None:
        from importlib.util import find_spec

        if find_spec("matplotlib") is None:
            raise MissingPackageError("--plot needs the package matplotlib: pip install matplotlib")

    from ..formulations.json_text import json_text
    from ..reports.comparison import compare as by_all
    from .output import stdout_is_ours
    from .progress import Progress

    interrupts.keep()
    with Progress(quiet, log, logged=True) as progress, stdout_is_ours():
        made = by_all(
            asked, names, time_limit=time_limit, bound_time=bound_time, seed=seed, threads=threads, isolate=isolate, progress=progress,
            log=progress.log,
        )  # fmt: skip
    delivery = Delivery(verbose)
    delivery.file("--out", out, lambda path: _write(made, path))
    delivery.file("--plot", plot, lambda path: _draw(made, path))
    delivery.show(lambda: json_text(made.to_json()) if json else _shown(made), lambda: str(made.to_frame().to_csv(index=False)))
    for fault in made.faults:
        complain(fault)
    raise typer.Exit(5 if made.faults else delivery.code or (0 if made.best is not None else _nothing(made)))


def _nothing(comparison: Comparison) -> int:
    return 3 if comparison.infeasible else interrupts.exit_code() if interrupts.received else 4


def _shown(comparison: Comparison) -> str:
    from ..reports.tables.comparison import comparison_lines, comparison_table
    from .output import lines_text, table_text

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
