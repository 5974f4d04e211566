"""``waybound export, convert, generate``: commands that write a file."""

from pathlib import Path
from typing import Annotated

from ..instances.errors import UsageError
from . import completing
from .delivery import output_path
from .options import Source, Verbose, arg, bounded, opt, parse_pairs, parse_settings
from .output import print_text

PROGRAM_SUFFIXES = (".mps", ".lp")


def export(
    source: Source,
    to: Annotated[Path, opt("--to FILE", "model.mps or model.lp.")],
    form: Annotated[str | None, opt("--form NAME", "How to write the problem down; its first form by default.", "form")] = None,
    relax: Annotated[bool, opt("--relax", "Drop integrality.")] = False,
    verbose: Verbose = False,
) -> None:
    """Write an instance as a mathematical program that any solver reads."""
    output_path("--to", to, PROGRAM_SUFFIXES, unlike=source.inputs())
    compiled = source.read().compile(form, relax=relax)
    compiled.write(to)
    program = compiled.program
    size = f"{program.num_variables} variables, {program.num_rows} rows, {len(program.data)} nonzeros"
    print_text(f"{to}: {program.kind}, form {compiled.form} ({compiled.exactness.value}), {size}")


def convert(
    source: Source,
    to: Annotated[Path, opt("--to FILE", "Written in the format that the suffix stands for.")],
    to_format: Annotated[str | None, opt("--to-format NAME", "Format to write, where the suffix does not say it.", "format")] = None,
    verbose: Verbose = False,
) -> None:
    """Write an instance in another format, changed as asked; what that format cannot express is an error."""
    from ..api import problem_of, read_source
    from ..instances.writing import write_instance

    output_path("--to", to, unlike=source.inputs())
    changes = parse_settings(source.settings, source.objective)
    instance = read_source(source.file, source.format, source.problem, changes)  # which takes out what its reader needs
    if changes or source.problem is not None or source.convention is not None:
        instance = problem_of(instance, source.problem, source.convention, changes).to_instance()
    write_instance(instance, to, to_format)
    print_text(f"{to}: {instance.name}, read as {instance.format}")


def generate(
    kind: Annotated[str, arg("KIND", "solomon, uchoa, sata, coverage, ...; an unknown one lists them all.", completing.names("generator"))],
    out: Annotated[Path, opt("--out FILE", "Written in the format that the suffix stands for.")],
    settings: Annotated[
        list[str] | None, opt("--set KEY=VALUE", "A setting of the recipe; an unknown one lists them all. Repeatable.")
    ] = None,
    seed: Annotated[int, opt("--seed N", "The same seed and settings give the same bytes.")] = 1,
    to_format: Annotated[str | None, opt("--to-format NAME", "Format to write, where the suffix does not say it.", "format")] = None,
    verbose: Verbose = False,
) -> None:
    """Make an instance by a published recipe; the same seed gives the same file."""
    from ..instances.generating import generate as make
    from ..instances.writing import write_instance

    bounded(seed=seed)
    recipe_settings = parse_pairs(settings, "--set")
    if recipe_settings.keys() & {"kind", "seed"}:
        raise UsageError("--set has neither a kind nor a seed; the kind is the command's argument, the seed is --seed", "unknown-name")
    output_path("--out", out)
    instance = make(kind, seed, **recipe_settings)
    write_instance(instance, out, to_format)
    print_text(f"{out}: {instance.name}")
