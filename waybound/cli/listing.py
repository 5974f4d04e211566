"""``waybound info, solvers, heuristics``: what an instance holds, and who can take it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .options import Convention, File, Format, Json, Objective, ProblemName, Quiet, Set, Verbose, read_both, read_problem

if TYPE_CHECKING:
    from ..reports.tables.table import Table

MaybeFile = Annotated[
    str | None,
    typer.Argument(metavar="[FILE]", help="Ask about this instance: who takes it, and what the others lack.", show_default=False),
]


def info(
    file: File,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    convention: Convention = None,
    settings: Set = None,
    objective: Objective = None,
    json: Json = False,
    verbose: Verbose = False,
) -> None:
    """What an instance holds, which solvers and heuristics take it, and what the others lack."""
    from ..reports.tables.facts import facts, facts_table
    from ..reports.tables.listing import heuristics_table, solvers_table
    from ..solving.listing import heuristic_table, solver_table
    from .output import print_json, print_table, print_text

    source, asked = read_both(file, format, problem, convention, settings, objective)
    data = facts(asked)
    able, approximate = solver_table(asked), heuristic_table(asked)
    if json:
        listed = {"solvers": [dataclasses.asdict(i) for i in able], "heuristics": [dataclasses.asdict(i) for i in approximate]}
        print_json({"format": source.format, "problems": list(source.problems), **data, **listed})
        return
    print_table(facts_table(data))
    foreign = {f"{asked.family} problems", f"a form for {asked.family} problems"}
    tables: dict[str, tuple[list[Any], Callable[..., Table]]] = {
        "solvers": (able, solvers_table), "heuristics": (approximate, heuristics_table),
    }  # fmt: skip
    for what, (rows, table) in tables.items():
        near = [row for row in rows if not foreign & set(row.missing)]
        print_table(table(near, asked=True))
        if len(near) < len(rows):
            print_text(f"{len(rows) - len(near)} {what} for other families are left out; `waybound {what} {file}` lists all")


def solvers(
    file: Annotated[
        str | None,
        typer.Argument(metavar="[FILE]", help="Ask about this instance; with --examine the name of a solver.", show_default=False),
    ] = None,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    settings: Set = None,
    objective: Objective = None,
    examine: Annotated[
        bool,
        typer.Option("--examine", help="Give solvers small programs whose optima are known: all that are installed, or the one named."),
    ] = False,
    count: Annotated[int | None, typer.Option("--count", metavar="N", help="Programs for each solver that is examined.")] = None,
    seed: Annotated[int | None, typer.Option("--seed", metavar="N", help="The same seed gives the same programs.")] = None,
    kind: Annotated[str | None, typer.Option("--kind", metavar="NAME", help="Programs of this kind alone, such as time-windows.")] = None,
    form: Annotated[str | None, typer.Option("--form", metavar="NAME", help="Programs of this form alone.")] = None,
    option: Annotated[
        list[str] | None,
        typer.Option("--option", metavar="KEY=VALUE", help="Option of the solver's own, which overrules waybound's. Repeatable."),
    ] = None,
    by: Annotated[str | None, typer.Option("--by", metavar="WORD", help="A row for each kind or form.")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FOLDER", help="Write the programs that a solver gets wrong here, as MPS.")
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """All solvers, installed or not, and with FILE which of them take it; with --examine, which can be believed (5: one cannot)."""
    from .examining import examine_solvers, refuse_settings

    own = {"count": count, "seed": seed, "kind": kind, "form": form, "option": option, "by": by, "out": out}
    if examine:
        refuse_settings("without", format=format, problem=problem, set=settings, objective=objective)
        examine_solvers(file, **own, json=json, quiet=quiet)  # type: ignore[arg-type]
        return
    refuse_settings("with", **own)
    from ..reports.tables.listing import solvers_table
    from ..solving.listing import solver_table
    from .output import print_json, print_table

    infos = solver_table(None if file is None else read_problem(file, format, problem, None, settings, objective))
    if json:
        print_json({"solvers": [dataclasses.asdict(i) for i in infos]})
    else:
        print_table(solvers_table(infos, asked=file is not None))


def heuristics(
    file: MaybeFile = None,
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
    from .output import print_json, print_table

    infos = heuristic_table(None if file is None else read_problem(file, format, problem, None, settings, objective))
    if json:
        print_json({"heuristics": [dataclasses.asdict(i) for i in infos]})
    else:
        print_table(heuristics_table(infos, asked=file is not None))
