"""What commands share: options, the parsing of KEY=VALUE, and the way from an error to one line and an exit code."""

from __future__ import annotations

import contextlib
import functools
import math
import os
import re
import sys
import warnings
from collections.abc import Callable, Sequence
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ParamSpec, TypeVar

import typer

from ..instances.errors import InputError, UsageError, WayboundError
from ..instances.limits import check_number, check_whole
from ..instances.printable import one_line, printable
from ..solvers import interrupts

if TYPE_CHECKING:
    from ..formulations.problem import Problem
    from ..instances.instance import Instance

P = ParamSpec("P")
R = TypeVar("R")

File = Annotated[str, typer.Argument(metavar="FILE", help="Instance file, or the name of a bundled instance.", show_default=False)]
Format = Annotated[str | None, typer.Option("--format", metavar="NAME", help="Format of FILE; recognised from the content by default.")]
ProblemName = Annotated[
    str | None, typer.Option("--problem", metavar="NAME", help="Problem to read FILE as; by default what its format stands for.")
]
Convention = Annotated[
    str | None,
    typer.Option("--convention", metavar="NAME", help="Rounding of distances: file, exact, trunc1 (dimacs), trunc2, round, ceil."),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change the problem's data: vehicles=3, vehicles=unlimited, vehicles-exactly=17, capacity=100, customers=25, fractional=true; "
        "of a CSV file speed=50, fleet=FILE, shipments=FILE, ... Repeatable.",
    ),
]
Seed = Annotated[int, typer.Option("--seed", metavar="N", help="The same seed gives the same answer, where no time limit decides.")]
Threads = Annotated[int, typer.Option("--threads", metavar="N", help="Threads that a solver may use, where it can use several.")]
LpSolver = Annotated[
    str | None, typer.Option("--lp-solver", metavar="NAME", help="Who solves the linear programs met on the way; highs by default.")
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else on standard output.")]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Say more; tracebacks of internal errors.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress.")]
Log = Annotated[
    str | None,
    typer.Option("--log", metavar="FILE", help="Write the log of the search to FILE; - is standard error, also where it is no terminal."),
]
Objective = Annotated[
    str | None,
    typer.Option(
        "--objective",
        metavar="TEXT",
        help='Of routes: terms with weights, in order of priority: "vehicles then total-cost", "total-cost - 2*reward".',
    ),
]

MOST_WHOLE = 2**63 - 1
"""Largest whole number of KEY=VALUE: what machines count in."""

_WHOLE = re.compile(r"[+-]?[0-9]{1,300}\Z")
_DECIMAL = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\Z")


def parse_value(text: str) -> Any:
    """A value of KEY=VALUE: whole number, finite decimal number, true or false, else the text itself."""
    if _WHOLE.match(text):
        return int(text)
    if _DECIMAL.match(text) and math.isfinite(float(text)):
        return float(text)
    return {"true": True, "false": False}.get(text.lower(), text)


def parse_pairs(pairs: Sequence[str] | None, option: str) -> dict[str, Any]:
    """The KEY=VALUE pairs of a repeatable option; a repeated key is refused."""
    found: dict[str, Any] = {}
    for pair in pairs or ():
        key, equals, value = (part.strip() for part in pair.partition("="))
        if not key or not equals or not value:
            raise UsageError(f"{option} takes KEY=VALUE, not {pair!r}")
        if key in found:
            raise UsageError(f"{option} {key} is given twice")
        found[key] = parse_value(value)
        if isinstance(found[key], int) and abs(found[key]) > MOST_WHOLE:
            raise UsageError(f"{option} {key}={value}: whole numbers go up to {MOST_WHOLE}")
    return found


def parse_settings(settings: Sequence[str] | None, objective: str | None) -> dict[str, Any]:
    """The pairs of ``--set`` and ``--objective`` as settings of a problem; a key that has an option of its own is refused."""
    given = parse_pairs(settings, "--set")
    for key in ("format", "problem", "convention", "objective", "path"):
        if key in given:
            raise UsageError(f"--set has no key {key!r}" + (f"; use --{key}" if key != "path" else ""))
    if objective is not None:
        given["objective"] = objective
    return given


def read_problem(
    file: str,
    format: str | None,  # noqa: A002
    problem: str | None,
    convention: str | None,
    settings: Sequence[str] | None,
    objective: str | None = None,
) -> Problem:
    """The problem that the common options name."""
    return read_both(file, format, problem, convention, settings, objective)[1]


def read_both(
    file: str,
    format: str | None,  # noqa: A002
    problem: str | None,
    convention: str | None,
    settings: Sequence[str] | None,
    objective: str | None = None,
) -> tuple[Instance, Problem]:
    """The instance in a file, which is read once because it may be a pipe, and the problem that the common options make of it."""
    from ..api import problem_of, read_source

    given = parse_settings(settings, objective)
    instance = read_source(file, format, problem, given)
    return instance, problem_of(instance, problem, convention, given)


def bounded(**options: Any) -> None:
    """Raise UsageError for an option that is infinite, no number, negative, or beyond what any machine can do.

    Keywords are keys of ``MOST``; None stands for an option that is not given.
    """
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if isinstance(value, int):
            check_whole(
                name, value, least=int(name in ("iterations", "no_improvement", "threads", "steps", "instances", "jobs")), option=option
            )
        elif value is not None:
            if not math.isfinite(value):
                raise UsageError(f"{option} must be a finite number, not {value}")
            check_number(name, value, above=0 if name in ("time_limit", "memory_limit") else None, option=option)


def output_path(option: str, path: Path | None, suffixes: Sequence[str] = (), *, unlike: Sequence[str] = ()) -> None:
    """Raise UsageError, before anything is run, if a file could not be written to ``path`` later.

    Parameters
    ----------
    option : str
        For the message.
    path : Path or None
    suffixes : sequence of str
        Those allowed; all if empty.
    unlike : sequence of str
        Inputs, which must not be overwritten; see ``inputs_of``.
    """
    if path is None:
        return
    if suffixes and path.suffix.lower() not in suffixes:
        raise UsageError(f"{option} {path}: the suffix must be one of {', '.join(suffixes)}")
    from ..instances.atomic import check_writable

    try:
        check_writable(path)
    except InputError as fault:
        raise UsageError(f"{option} {fault}") from None
    if path.exists() and any(os.path.exists(file) and path.samefile(file) for file in unlike):  # noqa: PTH110 - a name may be too long
        raise UsageError(f"{option} {path} would overwrite the input")


def inputs_of(file: str, settings: Sequence[str] | None) -> list[str]:
    """The file, and whatever ``--set`` or its comment lines may name beside it."""
    named = [value for value in parse_pairs(settings, "--set").values() if isinstance(value, str)]
    if os.path.isfile(file):  # noqa: PTH113 - a pipe is read once, and a name may be too long for pathlib
        with contextlib.suppress(OSError), Path(file).open(encoding="utf-8", errors="replace") as lines:  # its reader will say so
            heads = takewhile(lambda line: line.lstrip("\ufeff").startswith("#") or not line.strip(), lines)
            named += [str(Path(file).parent / value) for line in heads if (value := line.partition(":")[2].strip("\0 \t\r\n"))]
    return [file, *named]


def distinct_paths(**options: Path | None) -> None:
    """Raise UsageError if two outputs go to one file."""
    seen: dict[Path, str] = {}
    for name, path in options.items():
        if path is not None:
            real = Path(os.path.realpath(path))
            if real in seen:
                raise UsageError(f"--{seen[real]} and --{name} name the same file {path}")
            seen[real] = name


def log_path(log: str | None, unlike: Sequence[str], *outputs: Path | None) -> None:
    """Raise UsageError if the log could not be written, or would be written over the input or another output."""
    if log is not None and log != "-":
        output_path("--log", Path(log), unlike=unlike)
        for other in outputs:
            if other is not None and os.path.realpath(other) == os.path.realpath(log):
                raise UsageError(f"--log {log} names the file of another output")


def handled(command: Callable[P, R]) -> Callable[P, R]:
    """``command``, with errors as one line on standard error and the exit code that belongs to them."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = lambda message, *_, **__: remark(str(message))  # of whatever package: one line, and no source
                return command(*args, **kwargs)
        except WayboundError as error:
            complain(str(error))
            raise typer.Exit(error.exit_code) from None
        except KeyboardInterrupt:
            complain("interrupted")
            raise typer.Exit(interrupts.exit_code()) from None
        except (BrokenPipeError, typer.Exit, typer.Abort):
            raise
        except MemoryError as error:
            complain(f"not enough memory for this{f': {error}' if str(error) else ''}")
            raise typer.Exit(4) from None
        except Exception as error:
            if kwargs.get("verbose"):
                import traceback

                print("\n".join(printable(line) for line in traceback.format_exc().splitlines()), file=sys.stderr)
            hint = "" if kwargs.get("verbose") else "; run again with -v for the traceback"
            complain(f"internal error: {type(error).__name__}: {error}{hint}")
            raise typer.Exit(1) from None

    return run


def complain(message: str) -> None:
    """One line ``error: ...`` on standard error."""
    _say(f"error: {one_line(message)}")


def remark(message: str) -> None:
    """One line ``note: ...`` on standard error."""
    _say(f"note: {one_line(message)}")


def _say(line: str) -> None:
    try:
        typer.echo(line, err=True)
    except OSError:  # nobody can read it, which must not cost the answer
        from .output import silence

        silence(sys.stderr)
