"""``waybound info, solvers, heuristics, instances``: what an instance holds, the methods that take it, and what they guarantee."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..instances.errors import UsageError
from ..instances.limits import check_whole
from ..solvers import interrupts
from . import completing
from .handling import complain, handled, remark
from .options import Format, Json, Objective, ProblemName, Quiet, Set, Source, Verbose, arg, bounded, opt, parse_pairs
from .output import print_json, print_table, print_text, write_out
from .progress import PartsCounter

if TYPE_CHECKING:
    from ..reports.battery.cases import Draw
    from ..reports.battery.examining import Examination


def info(source: Source, json: Json = False, verbose: Verbose = False) -> None:
    """Show what an instance holds, which solvers and heuristics take it, and with -v what the others lack."""
    from ..reports.tables.facts import facts, facts_table
    from ..reports.tables.listing import heuristics_table, solvers_table
    from ..solving.listing import heuristic_table, solver_table

    instance, problem = source.read_both()
    data = facts(problem)
    able, approximate = solver_table(problem), heuristic_table(problem)
    if json:
        listed = {"solvers": [dataclasses.asdict(i) for i in able], "heuristics": [dataclasses.asdict(i) for i in approximate]}
        print_json({"format": instance.format, "problems": list(instance.problems), **data, **listed})
        return
    print_table(facts_table(data))
    print_table(solvers_table(able, asked=True), verbose)
    print_table(heuristics_table(approximate, asked=True), verbose)


def solvers(
    file: Annotated[
        str | None, arg("[FILE]", "Ask about this instance; with --examine the name of a solver.", completing.instances)
    ] = None,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    settings: Set = None,
    objective: Objective = None,
    examine: Annotated[
        bool, opt("--examine", "Give solvers small programs whose optima are known: all that are installed, or the one named.")
    ] = False,
    count: Annotated[int | None, opt("--count N", "Programs for each solver that is examined.")] = None,
    seed: Annotated[int | None, opt("--seed N", "The same seed gives the same programs.")] = None,
    kind: Annotated[str | None, opt("--kind NAME", "Programs of this kind alone, such as time-windows.")] = None,
    form: Annotated[str | None, opt("--form NAME", "Programs of this form alone.", "form")] = None,
    option: Annotated[
        list[str] | None, opt("--option KEY=VALUE", "Option of the solver's own, which overrules waybound's. Repeatable.")
    ] = None,
    by: Annotated[str | None, opt("--by WORD", "A row for each kind or form.")] = None,
    out: Annotated[Path | None, opt("--out FOLDER", "Write the programs that a solver gets wrong here, as MPS.")] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """All solvers, installed or not, and with FILE which of them take it; with --examine, which can be believed (5: one cannot)."""
    own = {"count": count, "seed": seed, "kind": kind, "form": form, "option": option, "by": by, "out": out}
    if examine:
        _refuse_settings("without", format=format, problem=problem, set=settings, objective=objective)
        _examine(file, **own, json=json, quiet=quiet)  # type: ignore[arg-type]
        return
    _refuse_settings("with", **own)
    from ..reports.tables.listing import solvers_table
    from ..solving.listing import solver_table

    infos = solver_table(None if file is None else Source(file, format, problem, None, settings, objective).read())
    if json:
        print_json({"solvers": [dataclasses.asdict(i) for i in infos]})
    else:
        print_table(solvers_table(infos, asked=file is not None), verbose)


def heuristics(
    file: Annotated[
        str | None, arg("[FILE]", "Ask about this instance: which solvers take it, and what the others lack.", completing.instances)
    ] = None,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    settings: Set = None,
    objective: Objective = None,
    json: Json = False,
    verbose: Verbose = False,
) -> None:
    """All heuristics with what they guarantee, and with FILE which of them take it."""
    from ..reports.tables.listing import heuristics_table
    from ..solving.listing import heuristic_table

    infos = heuristic_table(None if file is None else Source(file, format, problem, None, settings, objective).read())
    if json:
        print_json({"heuristics": [dataclasses.asdict(i) for i in infos]})
    else:
        print_table(heuristics_table(infos, asked=file is not None), verbose)


# -- solvers --examine ----------------------------------------------------------------------------------------------------

COUNT = 1000
"""Cases for each solver where the user says nothing."""


def _refuse_settings(word: str, **options: Any) -> None:
    """Raise UsageError for options that go only ``with`` or ``without`` an examination."""
    for name, value in options.items():
        if value not in (None, []):
            raise UsageError(f"--{name} is for solvers {word} --examine")


def _examine(
    solver: str | None, count: int | None, seed: int | None, kind: str | None, form: str | None, option: Sequence[str] | None,
    by: str | None, out: Path | None, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Examine one solver or all that are installed; ends with 5 if anything that one says is false."""
    from ..reports.battery.cases import Draw
    from ..reports.battery.examining import examinable
    from ..reports.studies.writing import check_folder
    from ..solvers.backend import solver_named

    bounded(seed=seed)
    if count is not None:
        check_whole("instances", count, least=1, option="--count")
    if by not in (None, "kind", "form"):
        raise UsageError(f"--by takes kind or form, not {by!r}", "unknown-name")
    own = parse_pairs(option, "--option")
    if own and solver is None:
        raise UsageError("--option is for one solver: --examine NAME --option KEY=VALUE")
    if out is not None:
        check_folder(out)
    draw = Draw(COUNT if count is None else count, 1 if seed is None else seed, kind, form)
    names = examinable() if solver is None else [solver_named(solver).label]
    examinations = _examined(names, draw, own, quiet)
    if examinations:
        _tell(draw, examinations, by or "", out, json)
    if any(e.wrong for e in examinations):
        raise typer.Exit(5)
    raise typer.Exit(0 if examinations else interrupts.exit_code())


def _examined(names: Sequence[str], draw: Draw, own: dict[str, Any], quiet: bool) -> list[Examination]:
    """Examine the solvers one by one; Ctrl-C ends the examination under way, keeps its results, and begins no further one."""
    from ..reports.battery.examining import examine

    examinations: list[Examination] = []
    for name in names:
        with PartsCounter(name, quiet, "cases") as counter:
            one = examine(name, draw, own, progress=counter)
        if one.outcomes:
            examinations.append(one)
        if one.interrupted:
            remark(f"interrupted: {name} was given {len(one.outcomes)} of {draw.count} cases")
            break
    return examinations


def _tell(draw: Draw, examinations: Sequence[Examination], by: str, out: Path | None, json: bool) -> None:
    from ..reports.battery.report import examination_table, summary_lines, to_json, write_wrong

    files = {} if out is None else {e.solver: write_wrong(out, draw, e) for e in examinations}
    if json:
        print_json(to_json(draw, examinations, files))
    else:
        print_table(examination_table(examinations, by))
    for one in examinations:
        for line in summary_lines(one, files.get(one.solver)):
            complain(line)


# -- instances ----------------------------------------------------------------------------------------------------------

instances = typer.Typer(help="Bundled instances.", no_args_is_help=True)

Name = Annotated[str, arg("NAME", "Name of a bundled instance.", completing.names("instance"))]


@instances.command("list")
@handled
def list_all(json: Json = False, verbose: Verbose = False) -> None:
    """Bundled instances, and how each was made."""
    from ..instances.bundled import RECIPES, bundled_path

    if json:
        origins = {name: (str(bundled_path(name)), recipe.command(name) or None, recipe.source or None) for name, recipe in RECIPES.items()}
        print_json({"bundled": [{"name": n, "path": place, "recipe": by, "source": source} for n, (place, by, source) in origins.items()]})
        return
    from ..reports.tables.table import Column, Table

    listed = tuple((name, recipe.source or recipe.command(name)) for name, recipe in RECIPES.items())
    print_table(Table("Bundled", (Column("name"), Column("made by", wide=True)), listed))


@instances.command()
@handled
def path(name: Name, verbose: Verbose = False) -> None:
    """Print the path of a bundled instance."""
    from ..instances.bundled import bundled_path

    print_text(str(bundled_path(name)))


@instances.command()
@handled
def show(name: Name, verbose: Verbose = False) -> None:
    """The text of a bundled instance."""
    from ..instances.bundled import bundled_path

    write_out(bundled_path(name).read_text(encoding="utf-8"))
