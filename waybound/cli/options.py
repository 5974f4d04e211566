"""Options that commands share, and what they say: KEY=VALUE pairs, numbers within bounds, the instance."""

from __future__ import annotations

import contextlib
import math
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..instances.errors import UsageError
from ..instances.limits import check_number, check_whole
from . import completing

if TYPE_CHECKING:
    from ..formulations.problem import Problem
    from ..instances.instance import Instance


def opt(words: str, help: str, offers: str = "") -> Any:  # noqa: A002 - typer's word
    """An option by its names and the name of its value, ``opt("--seed N", ...)``, and whose names the shell offers for that."""
    names = [word for word in words.split() if word.startswith("-")]
    metavar = " ".join(words.split()[len(names) :]) or None
    return typer.Option(*names, metavar=metavar, help=help, autocompletion=completing.names(offers) if offers else None)


def arg(metavar: str, help: str, offers: Callable[[str], list[str]] | None = None) -> Any:  # noqa: A002 - typer's word
    """An argument by the name that help shows, and what the shell offers for it."""
    return typer.Argument(metavar=metavar, help=help, show_default=False, autocompletion=offers)


File = Annotated[str, arg("FILE", "Instance file, or the name of a bundled instance.", completing.instances)]
Format = Annotated[str | None, opt("--format NAME", "Format of FILE; recognised from the content by default.", "format")]
ProblemName = Annotated[str | None, opt("--problem NAME", "Problem to read FILE as; by default what its format stands for.", "problem")]
Convention = Annotated[
    str | None, opt("--convention NAME", "Rounding of distances: file, exact, trunc1 (dimacs), trunc2, round, ceil.", "convention")
]
Set = Annotated[
    list[str] | None,
    opt(
        "--set KEY=VALUE",
        "Change the problem's data: vehicles=3, vehicles=unlimited, vehicles-exactly=17, capacity=100, customers=25, fractional=true; "
        "of a CSV file speed=50, fleet=FILE, shipments=FILE, ... Repeatable.",
    ),
]
Seed = Annotated[int, opt("--seed N", "The same seed gives the same answer, where no time limit decides.")]
Threads = Annotated[int, opt("--threads N", "Threads that a solver may use, where it can use several.")]
LpSolver = Annotated[str | None, opt("--lp-solver NAME", "Solver of linear programs within methods; highs by default.", "solver")]
Json = Annotated[bool, opt("--json", "Print one JSON object and nothing else on standard output.")]
Verbose = Annotated[bool, opt("--verbose -v", "Say more; tracebacks of internal errors.")]
Quiet = Annotated[bool, opt("--quiet -q", "No progress.")]
Log = Annotated[str | None, opt("--log FILE", "Write the log of the search to FILE; - is standard error, also where it is no terminal.")]
Objective = Annotated[
    str | None,
    opt(
        "--objective TEXT",
        'The same as --set objective=TEXT: of routes terms with weights, in order of priority ("vehicles then total-cost", '
        '"total-cost - 2*reward"), of other problems the name of one of theirs.',
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
    values: dict[str, Any] = {}
    for pair in pairs or ():
        key, equals, value = (part.strip() for part in pair.partition("="))
        if not key or not equals or not value:
            raise UsageError(f"{option} takes KEY=VALUE, not {pair!r}", "malformed")
        if key in values:
            raise UsageError(f"{option} {key} is given twice", "duplicate")
        values[key] = parse_value(value)
        if isinstance(values[key], int) and abs(values[key]) > MOST_WHOLE:
            raise UsageError(f"{option} {key}={value}: whole numbers go up to {MOST_WHOLE}", "out-of-range")
    return values


def parse_settings(settings: Sequence[str] | None, objective: str | None) -> dict[str, Any]:
    """The pairs of ``--set`` and ``--objective``, a setting too, as settings of a problem; what says how FILE is read is refused."""
    values = parse_pairs(settings, "--set")
    if objective is not None and "objective" in values:
        raise UsageError("the objective is given twice: by --objective and by --set objective", "duplicate")
    for key in ("format", "problem", "convention", "path"):
        if key in values:
            raise UsageError(f"--set has no key {key!r}" + (f"; use --{key}" if key != "path" else ""), "unknown-name")
    if objective is not None:
        values["objective"] = objective
    return values


@dataclass(frozen=True)
class Source:
    """The instance that a command is about: a parameter of this type stands for the options that say how FILE is read."""

    file: File
    format: Format = None
    problem: ProblemName = None
    convention: Convention = None
    settings: Set = None
    objective: Objective = None

    def read(self) -> Problem:
        """The problem that the options name."""
        return self.read_both()[1]

    def read_both(self) -> tuple[Instance, Problem]:
        """The instance in the file, which is read once because it may be a pipe, and the problem that the options make of it."""
        from ..api import problem_of, read_source

        values = parse_settings(self.settings, self.objective)
        instance = read_source(self.file, self.format, self.problem, values)
        return instance, problem_of(instance, self.problem, self.convention, values)

    def inputs(self) -> list[str]:
        """The file, and whatever ``--set`` or its comment lines may name beside it."""
        named = [value for value in parse_pairs(self.settings, "--set").values() if isinstance(value, str)]
        if os.path.isfile(self.file):  # noqa: PTH113 - a pipe is read once, and a name may be too long for pathlib
            place = Path(self.file)
            with contextlib.suppress(OSError), place.open(encoding="utf-8", errors="replace") as lines:  # its reader will say so
                heads = takewhile(lambda line: line.lstrip("\ufeff").startswith("#") or not line.strip(), lines)
                named += [str(place.parent / value) for line in heads if (value := line.partition(":")[2].strip("\0 \t\r\n"))]
        return [self.file, *named]


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
                raise UsageError(f"{option} must be a finite number, not {value}", "out-of-range")
            check_number(name, value, above=0 if name in ("time_limit", "memory_limit") else None, option=option)
