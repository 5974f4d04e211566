"""``waybound check, bound, explain``."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..instances.errors import UsageError
from ..solvers import interrupts
from .options import (
    Convention,
    File,
    Format,
    Json,
    LpSolver,
    Objective,
    ProblemName,
    Quiet,
    Seed,
    Set,
    Threads,
    Verbose,
    bounded,
    inputs_of,
    output_path,
    read_problem,
    remark,
)

if TYPE_CHECKING:
    from ..formulations.answers import ReadAnswer
    from ..formulations.evaluation import Evaluation

STATED_TOLERANCE = 1e-6
"""Relative difference up to which a stated objective counts as the recomputed one."""


def check(
    file: File,
    solution: Annotated[
        Path,
        typer.Argument(
            metavar="SOLUTION",
            help="Solution file: .json, .csv, .xlsx, of routes .sol, .tour, .vroom, .geojson; or a solver's, of an exported model.",
            show_default=False,
        ),
    ],
    certificate: Annotated[Path | None, typer.Option("--certificate", metavar="FILE", help="Verify this certificate's bound too.")] = None,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    convention: Convention = None,
    settings: Set = None,
    form: Annotated[
        str | None,
        typer.Option("--form", metavar="NAME", help="For a solver's file: the form that was exported; whichever fits by default."),
    ] = None,
    objective: Objective = None,
    json: Json = False,
    verbose: Verbose = False,
) -> None:
    """Verify anybody's solution, and a certificate's bound, against an instance; no solver is used.

    Exit code 0 if the solution is feasible, 5 if not, or if the certificate does not hold.
    """
    from ..api import check as verify
    from ..formulations.answers import read_answer

    asked = read_problem(file, format, problem, convention, settings, objective)
    read = read_answer(asked, solution, form)
    evaluation = asked.evaluate(read.answer)
    made = verify(asked, read.answer, certificate)
    notes = [*(f"{solution}: {note}" for note in read.notes), *_compare(read, evaluation)]
    if json:
        from .output import print_json

        print_json(
            {
                "instance": asked.name,
                "instance_hash": made.instance_hash,
                "problem": made.problem,
                "sense": made.sense,
                "convention": made.convention,
                "solution": str(solution),
                "stated_objective": read.stated,
                "quantities": evaluation.quantities,
                "notes": notes,
                **made.to_json(),
            }
        )
    else:
        from ..formulations.certificate import certificate_lines
        from ..formulations.rendering import Line, number
        from .output import print_lines

        lines = certificate_lines(made)
        if certificate is None:
            lines = [line for line in lines if line.label != "bound"]
        if read.stated is not None:
            agrees = "another objective, see the note" if _compare(read, evaluation) else "as recomputed"
            lines.append(Line("stated", f"{number(read.stated)} in the file, {agrees}"))
        lines += [Line("note", note) for note in notes]
        lines += [Line(name, f"{value:.10g}", "quiet") for name, value in evaluation.quantities.items()] if verbose else []
        print_lines(f"{solution}: a solution of {asked.name} ({made.problem}, {made.sense}, convention {made.convention})", lines)
    raise typer.Exit(0 if made.feasible else 5)


def _compare(read: ReadAnswer, evaluation: Evaluation) -> list[str]:
    """What to say where the file states another objective than its answer has."""
    from ..formulations.tolerance import same

    if read.stated is None:
        return []
    stated = read.stated if isinstance(read.stated, list) else [read.stated]
    values = list(evaluation.values)
    if len(stated) == 1 and len(values) > 1 and "distance" in evaluation.quantities:
        values = [evaluation.quantities["distance"]]  # a .sol states a cost, whatever the levels of the objective
    if len(stated) == len(values) and all(same(a, b, precision=STATED_TOLERANCE) for a, b in zip(stated, values, strict=True)):
        return []
    shown = values[0] if len(values) == 1 else values
    cure = "; is the convention of distance the file's?" if "distance" in evaluation.quantities else ""
    return [f"the file states {read.stated!r}, recomputed from the data it is {shown!r}{cure}"]


def bound(
    file: File,
    bound_time: Annotated[float, typer.Option("--bound-time", metavar="S", help="Seconds for all methods together.")] = 60.0,
    seed: Seed = 1,
    threads: Threads = 1,
    lp_solver: LpSolver = None,
    certificate: Annotated[Path | None, typer.Option("--certificate", metavar="FILE", help="Write the evidence (.json).")] = None,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    convention: Convention = None,
    settings: Set = None,
    objective: Objective = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """The best provable bound on the objective, of each level in order of priority, with its source; verified from its evidence.

    Exit code 0 with a bound, 3 if it is proved that there is no solution, or no best one, 4 if nothing was proved.
    """
    bounded(bound_time=bound_time, seed=seed, threads=threads)
    if bound_time <= 0:
        raise UsageError(f"--bound-time must be positive, not {bound_time:g}")
    asked = read_problem(file, format, problem, convention, settings, objective)
    output_path("--certificate", certificate, (".json",), unlike=inputs_of(file, settings))

    from ..formulations.certificate_files import write_certificate
    from ..formulations.json_text import json_text
    from ..solvers.linear_programs import linear_programs
    from ..solving.levels import bound_alone
    from .delivery import Delivery
    from .output import lines_text, stdout_is_ours
    from .progress import Progress

    unable: list[str] = []
    linear = linear_programs(lp_solver, seed, threads)
    interrupts.keep()
    with Progress(quiet) as progress, stdout_is_ours():
        made, evidence, seconds = bound_alone(asked, bound_time, linear, unable, progress)
    for line in unable:
        remark(line)
    bounds = [made.bound, *(level.bound for level in made.levels)]
    sources = [made.bound_source, *(level.source for level in made.levels)]
    figures = {
        "instance": asked.name,
        "instance_hash": made.instance_hash,
        "problem": made.problem,
        "sense": made.sense,
        "convention": made.convention,
        "bound": bounds[0] if len(asked.senses) == 1 or bounds[0] is None else [*bounds, *[None] * (len(asked.senses) - len(bounds))],
        "bound_kind": None if made.bound is None else "verified",
        "bound_source": ", then ".join(map(str, sources)) if made.levels else made.bound_source,
        "infeasible": made.infeasible,
        "unbounded": made.unbounded,
        "levels": [level.to_json() for level in made.levels],
        "found": [{"source": e.source, "value": e.value} for e in evidence],
        "seconds": seconds,
    }

    def shown() -> str:
        from ..formulations.certificate import bound_lines
        from ..formulations.rendering import Line

        lines = bound_lines(made)
        others = [e for e in evidence if e not in made.evidence]
        lines += [Line("also", f"{e.value:.10g}: {e.source}" if math.isfinite(e.value) else e.source, "quiet") for e in others]
        lines.append(Line("seconds", f"{seconds:.2f}", "quiet"))
        return lines_text(f"{asked.name}: {made.problem}, {made.sense}, convention {made.convention}", lines)

    delivery = Delivery(verbose)
    delivery.file("--certificate", certificate, lambda path: write_certificate(made, path))
    delivery.show(lambda: json_text(figures) if json else shown(), lambda: json_text(figures))
    raise typer.Exit(delivery.code or (3 if made.infeasible or made.unbounded else 0 if made.bound is not None else _nothing()))


def explain(
    file: File,
    form: Annotated[str | None, typer.Option("--form", metavar="NAME", help="Form whose rows shall be named.")] = None,
    time_limit: Annotated[float, typer.Option("--time-limit", metavar="S", help="Seconds for everything together.")] = 60.0,
    format: Format = None,  # noqa: A002
    problem: ProblemName = None,
    convention: Convention = None,
    settings: Set = None,
    objective: Objective = None,
    json: Json = False,
    verbose: Verbose = False,
) -> None:
    """Why an instance has no solution: sites out of reach, a fleet too small, or rows that contradict each other.

    Exit code 3 if there is no solution, 0 if there is one, 4 if neither was found out.
    """
    bounded(time_limit=time_limit)
    asked = read_problem(file, format, problem, convention, settings, objective)

    from ..solving.explaining import explain as find
    from .output import print_json, print_lines, print_table, stdout_is_ours

    interrupts.keep()
    with stdout_is_ours():
        made = find(asked, time_limit=time_limit, form=form)
    if json:
        print_json({"instance": asked.name, "problem": asked.problem, **made.to_json()})
    else:
        from ..reports.tables.table import Column, Table

        print_lines(f"{asked.name}: {asked.problem}", made.lines())
        if made.reasons:
            columns = (Column(made.reasons[0].kind), Column("reason", wide=True))
            title = f"Reasons (rows of form {made.form})" if made.form else "Reasons"
            print_table(Table(title, columns, tuple((r.where, r.message) for r in made.reasons)))
    raise typer.Exit({"infeasible": 3, "feasible": 0}[made.verdict] if made.verdict != "undecided" else _nothing())


def _nothing() -> int:
    """The exit code where nothing was found out, within the limit or before a signal came."""
    return interrupts.exit_code() if interrupts.received else 4
