"""``waybound export, convert, generate``: commands that write a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..instances.errors import UsageError
from .options import (
    Convention,
    File,
    Format,
    Objective,
    ProblemName,
    Set,
    Verbose,
    bounded,
    inputs_of,
    output_path,
    parse_pairs,
    parse_settings,
    read_problem,
)
from .output import print_text

PROGRAM_SUFFIXES = (".mps", ".lp")


def export(
    file: File,
    to: Annotated[Path, typer.Option("--to", metavar="FILE", help="model.mps or model.lp.", show_default=False)],
    form: Annotated[
        str | None, typer.Option("--form", metavar="NAME", help="How to write the problem down; its first form by default.")
    ] = None,
    relax: Annotated[bool, typer.Option("--relax", help="Drop integrality.")] = False,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    convention: Convention = None,
    settings: Set = None,
    objective: Objective = None,
    verbose: Verbose = False,
) -> None:
    """Write an instance as a mathematical program that any solver reads."""
    output_path("--to", to, PROGRAM_SUFFIXES, unlike=inputs_of(file, settings))
    made = read_problem(file, format, problem, convention, settings, objective).compile(form, relax=relax)
    made.write(to)
    program = made.program
    size = f"{program.num_variables} variables, {program.num_rows} rows, {len(program.data)} nonzeros"
    print_text(f"{to}: {program.kind}, form {made.form} ({made.exactness.value}), {size}")


def convert(
    file: File,
    to: Annotated[Path, typer.Option("--to", metavar="FILE", help="Written in the format that the suffix stands for.", show_default=False)],
    to_format: Annotated[
        str | None, typer.Option("--to-format", metavar="NAME", help="Format to write, where the suffix does not say it.")
    ] = None,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    convention: Convention = None,
    settings: Set = None,
    objective: Objective = None,
    verbose: Verbose = False,
) -> None:
    """Write an instance in another format, changed as asked; what that format cannot express is an error."""
    from ..api import problem_of, read_source
    from ..instances.writing import write_instance

    output_path("--to", to, unlike=inputs_of(file, settings))
    given = parse_settings(settings, objective)
    instance = read_source(file, format, problem, given)  # which takes out what its reader needs
    if given or problem is not None or convention is not None:
        instance = problem_of(instance, problem, convention, given).to_instance()
    write_instance(instance, to, to_format)
    print_text(f"{to}: {instance.name}, read as {instance.format}")


def generate(
    kind: Annotated[
        str, typer.Argument(metavar="KIND", help="solomon, uchoa, sata, coverage, ...; an unknown one lists them all.", show_default=False)
    ],
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="Written in the format that the suffix stands for.", show_default=False)
    ],
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="A setting of the recipe; an unknown one lists them all. Repeatable."),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", metavar="N", help="The same seed and settings give the same bytes.")] = 1,
    to_format: Annotated[
        str | None, typer.Option("--to-format", metavar="NAME", help="Format to write, where the suffix does not say it.")
    ] = None,
    verbose: Verbose = False,
) -> None:
    """Make an instance by a published recipe; the same seed gives the same file."""
    from ..instances.generating import generate as make
    from ..instances.writing import write_instance

    bounded(seed=seed)
    given = parse_pairs(settings, "--set")
    if given.keys() & {"kind", "seed"}:
        raise UsageError("--set has neither a kind nor a seed; the kind is the command's argument, the seed is --seed")
    output_path("--out", out)
    instance = make(kind, seed, **given)
    write_instance(instance, out, to_format)
    print_text(f"{out}: {instance.name}")
