"""``waybound check, bound, explain``."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..instances.errors import UsageError
from ..solvers import interrupts
from .delivery import Delivery, output_path
from .handling import nothing_found, remark
from .options import Json, LpSolver, Quiet, Seed, Source, Threads, Verbose, arg, bounded, opt
from .output import lines_text, print_json, print_lines, print_table, stdout_is_ours
from .progress import Progress

if TYPE_CHECKING:
    from ..formulations.answers import ReadAnswer
    from ..formulations.certificate import Certificate
    from ..formulations.evaluation import Evaluation
    from ..formulations.problem import Problem

STATED_TOLERANCE = 1e-6
"""Relative difference up to which a stated objective counts as the recomputed one."""


def check(
    source: Source,
    solution: Annotated[
        Path,
        arg("SOLUTION", "Solution file: .json, .csv, .xlsx, of routes .sol, .tour, .vroom, .geojson; or a solver's, of an exported model."),
    ],
    certificate: Annotated[Path | None, opt("--certificate FILE", "Verify this certificate's bound too.")] = None,
    form: Annotated[
        str | None, opt("--form NAME", "For a solver's file: the form that was exported; whichever fits by default.", "form")
    ] = None,
    json: Json = False,
    verbose: Verbose = False,
) -> None:
    """Verify anybody's solution, and a certificate's bound, against an instance; no solver is used.

    Exit code 0 if the solution is feasible, 5 if not, or if the certificate does not hold.
    """
    from ..api import check as verify
    from ..formulations.answers import read_answer

    problem = source.read()
    read = read_answer(problem, solution, form)
    verdict = verify(problem, read.answer, certificate)
    evaluation = problem.evaluate(read.answer)
    notes = [*(f"{solution}: {note}" for note in read.notes), *_compare(read, evaluation)]
    if json:
        print_json(
            {
                **_about(problem, verdict),
                "solution": str(solution),
                "stated_objective": read.stated,
                "quantities": evaluation.quantities,
                "notes": notes,
                **verdict.to_json(),
            }
        )
    else:
        from ..formulations.certificate import certificate_lines
        from ..formulations.rendering import Line, number

        lines = certificate_lines(verdict)
        if certificate is None:
            lines = [line for line in lines if line.label != "bound"]
        if read.stated is not None:
            agrees = "another objective, see the note" if _compare(read, evaluation) else "as recomputed"
            lines.append(Line("stated", f"{number(read.stated)} in the file, {agrees}"))
        lines += [Line("note", note) for note in notes]
        lines += [Line(name, f"{value:.10g}", "quiet") for name, value in evaluation.quantities.items()] if verbose else []
        kind = f"{verdict.problem}, {verdict.sense}, convention {verdict.convention}"
        print_lines(f"{solution}: a solution of {problem.name} ({kind})", lines)
    raise typer.Exit(0 if verdict.feasible else 5)


def _about(problem: Problem, certificate: Certificate) -> dict[str, Any]:
    """The first keys of JSON about a certificate."""
    stated = {name: getattr(certificate, name) for name in ("instance_hash", "problem", "sense", "convention")}
    return {"instance": problem.name, **stated}


def _compare(read: ReadAnswer, evaluation: Evaluation) -> list[str]:
    """Notes for a file that states another objective than its answer has."""
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
    source: Source,
    bound_time: Annotated[float, opt("--bound-time S", "Seconds for all methods together.")] = 60.0,
    seed: Seed = 1,
    threads: Threads = 1,
    lp_solver: LpSolver = None,
    certificate: Annotated[Path | None, opt("--certificate FILE", "Write the evidence (.json).")] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """The best provable bound on the objective, of each level in order of priority, with its source; verified from its evidence.

    Exit code 0 with a bound, 3 if it is proved that there is no solution, or no best one, 4 if nothing was proved.
    """
    bounded(bound_time=bound_time, seed=seed, threads=threads)
    if bound_time <= 0:
        raise UsageError(f"--bound-time must be positive, not {bound_time:g}", "out-of-range")
    problem = source.read()
    output_path("--certificate", certificate, (".json",), unlike=source.inputs())

    from ..formulations.certificate_files import write_certificate
    from ..formulations.json_text import json_text
    from ..solvers.linear_programs import linear_programs
    from ..solving.levels import bound_alone

    unable: list[str] = []
    linear = linear_programs(lp_solver, seed, threads)
    interrupts.keep()
    with Progress(quiet) as progress, stdout_is_ours():
        proved, evidence, seconds = bound_alone(problem, bound_time, linear, unable, progress)
    for line in unable:
        remark(line)
    bounds = [proved.bound, *(level.bound for level in proved.levels)]
    sources = [proved.bound_source, *(level.source for level in proved.levels)]
    figures = {
        **_about(problem, proved),
        "bound": bounds[0] if len(problem.senses) == 1 or bounds[0] is None else [*bounds, *[None] * (len(problem.senses) - len(bounds))],
        "bound_kind": None if proved.bound is None else "verified",
        "bound_source": ", then ".join(map(str, sources)) if proved.levels else proved.bound_source,
        "infeasible": proved.infeasible,
        "unbounded": proved.unbounded,
        "levels": [level.to_json() for level in proved.levels],
        "found": [{"source": e.source, "value": e.value} for e in evidence],
        "seconds": seconds,
    }

    def shown() -> str:
        from ..formulations.certificate import bound_lines
        from ..formulations.rendering import Line

        lines = bound_lines(proved)
        others = [e for e in evidence if e not in proved.evidence]
        lines += [Line("also", f"{e.value:.10g}: {e.source}" if math.isfinite(e.value) else e.source, "quiet") for e in others]
        lines.append(Line("seconds", f"{seconds:.2f}", "quiet"))
        return lines_text(f"{problem.name}: {proved.problem}, {proved.sense}, convention {proved.convention}", lines)

    delivery = Delivery(verbose)
    delivery.file("--certificate", certificate, lambda path: write_certificate(proved, path))
    delivery.show(lambda: json_text(figures) if json else shown(), lambda: json_text(figures))
    raise typer.Exit(delivery.code or (3 if proved.infeasible or proved.unbounded else 0 if proved.bound is not None else nothing_found()))


def explain(
    source: Source,
    form: Annotated[str | None, opt("--form NAME", "Form whose rows shall be named.", "form")] = None,
    time_limit: Annotated[float, opt("--time-limit S", "Seconds for everything together.")] = 60.0,
    json: Json = False,
    verbose: Verbose = False,
) -> None:
    """Why an instance has no solution: sites out of reach, a fleet too small, or rows that contradict each other.

    Exit code 3 if there is no solution, 0 if there is one, 4 if neither was found out.
    """
    bounded(time_limit=time_limit)
    problem = source.read()

    from ..solving.explaining import explain as find

    interrupts.keep()
    with stdout_is_ours():
        explanation = find(problem, time_limit=time_limit, form=form)
    if json:
        print_json({"instance": problem.name, "problem": problem.problem, **explanation.to_json()})
    else:
        from ..reports.tables.table import Column, Table

        print_lines(f"{problem.name}: {problem.problem}", explanation.lines())
        if explanation.reasons:
            columns = (Column(explanation.reasons[0].kind), Column("reason", wide=True))
            title = f"Reasons (rows of form {explanation.form})" if explanation.form else "Reasons"
            print_table(Table(title, columns, tuple((r.where, r.message) for r in explanation.reasons)))
    raise typer.Exit({"infeasible": 3, "feasible": 0}[explanation.verdict] if explanation.verdict != "undecided" else nothing_found())
