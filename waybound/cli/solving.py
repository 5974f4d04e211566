"""``waybound solve``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..instances.errors import UsageError
from ..solvers import interrupts
from .delivery import PAGE_SUFFIXES, PLOT_SUFFIXES, Delivery, check_matplotlib, check_outputs
from .handling import complain, remark
from .options import Json, Log, LpSolver, Quiet, Seed, Source, Threads, Verbose, bounded, opt, parse_pairs
from .output import lines_text, stdout_is_ours, table_text
from .progress import Progress

if TYPE_CHECKING:
    from ..formulations.problem import Problem
    from ..formulations.solution import Solution


def solve(
    source: Source,
    solver: Annotated[
        str | None,
        opt("--solver NAME", "highs, pulp, ortools, pyvrp, ...; a solver within one as pulp:HiGHS. See `waybound solvers`.", "solver"),
    ] = None,
    heuristic: Annotated[
        str | None, opt("--heuristic NAME", "An approximation instead of a solver. See `waybound heuristics`.", "heuristic")
    ] = None,
    form: Annotated[str | None, opt("--form NAME", "How the problem is written down, for solvers that take programs.", "form")] = None,
    relax: Annotated[bool, opt("--relax", "Drop integrality: the optimum is a bound.")] = False,
    option: Annotated[list[str] | None, opt("--option KEY=VALUE", "An option of the solver or heuristic itself. Repeatable.")] = None,
    time_limit: Annotated[float, opt("--time-limit S", "Seconds for the search alone.")] = 60.0,
    bound_time: Annotated[
        float | None, opt("--bound-time S", "Seconds for bounding after it; a tenth of the limit, at least 1, by default; 0 turns it off.")
    ] = None,
    iterations: Annotated[int | None, opt("--iterations N", "Work limit; makes a run repeatable.")] = None,
    no_improvement: Annotated[
        int | None, opt("--no-improvement N", "End after so many iterations without a better answer, where the solver can.")
    ] = None,
    gap: Annotated[float, opt("--gap G", "Relative gap at which the search may stop.")] = 0.0,
    seed: Seed = 1,
    threads: Threads = 1,
    lp_solver: LpSolver = None,
    start: Annotated[Path | None, opt("--start SOLUTION", "A solution file to start from.")] = None,
    isolate: Annotated[bool, opt("--isolate", "Run the solver in a process of its own, with hard limits.")] = False,
    memory_limit: Annotated[
        float | None, opt("--memory-limit MB", "Memory of that process, beyond what it takes idle; kept on Linux only.")
    ] = None,
    out: Annotated[
        Path | None, opt("--out FILE", "Write the answer: .json, .csv, .xlsx, or for routes .sol, .tour, .vroom, .geojson.")
    ] = None,
    certificate: Annotated[Path | None, opt("--certificate FILE", "Write the certificate with its evidence (.json).")] = None,
    plot: Annotated[Path | None, opt("--plot FILE", "Draw the answer: .png, .svg or .pdf.")] = None,
    view: Annotated[
        str | None,
        opt("--view NAME", "What --plot draws: history; of routes also schedule, loads, of risks risks, violations; else a map."),
    ] = None,
    page: Annotated[
        Path | None, opt("--page FILE", "Write the answer as a page to look at (.html): map or pictures, tables, certificate.")
    ] = None,
    log: Log = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Solve an instance; the answer is checked and bounded, whichever solver finds it."""
    if solver is not None and heuristic is not None:
        raise UsageError("give either --solver or --heuristic, not both")
    bounded(
        time_limit=time_limit, bound_time=bound_time, gap=gap, memory_limit=memory_limit, iterations=iterations,
        no_improvement=no_improvement, seed=seed, threads=threads,
    )  # fmt: skip
    options = parse_pairs(option, "--option")
    problem = source.read()
    check_outputs(
        source.inputs(), log, out=(out, ()), certificate=(certificate, (".json",)), plot=(plot, PLOT_SUFFIXES), page=(page, PAGE_SUFFIXES)
    )
    _check_answer(problem, out, plot, view)
    if page is not None:
        check_matplotlib("--page")

    from ..api import solve as search
    from ..formulations.answers import read_answer
    from ..formulations.json_text import json_text

    if not quiet:
        for note in problem.remarks() if json else ():
            remark(note)
    begin = None
    if start is not None:
        read = read_answer(problem, start)
        begin = read.answer
        for note in read.notes:
            remark(f"{start}: {note}")
    interrupts.keep()
    with Progress(quiet, log, logged=True) as progress, stdout_is_ours():
        solution = search(
            problem, solver, heuristic=heuristic, form=form, relax=relax, time_limit=time_limit, bound_time=bound_time, gap=gap,
            iterations=iterations, seed=seed, threads=threads, start=begin, progress=progress, log=progress.log, isolate=isolate,
            memory_limit=memory_limit, no_improvement=no_improvement, lp_solver=lp_solver, options=options,
        )  # fmt: skip
    delivery = Delivery(verbose)

    def hand_over() -> None:
        _write_outputs(delivery, solution, out, certificate, plot, view)
        delivery.file("--page", page, lambda path: _write_page(solution, path))
        delivery.show(lambda: json_text(solution.to_json()) if json else _shown(solution, verbose), lambda: json_text(_least(solution)))
        for fault in solution.faults:
            complain(fault)

    try:
        hand_over()
    except KeyboardInterrupt:  # between two outputs; within one it is dealt with there
        hand_over()
    code = 0 if relax and solution.answer is None and solution.bound is not None else exit_code(solution)
    raise typer.Exit(code if solution.faults else delivery.code or code)


def exit_code(solution: Solution) -> int:
    """Exit code of a run that ended without an error: 5 where a claim or a bound contradicts the answer that is handed over."""
    if solution.faults:
        return 5
    if solution.answer is not None:
        return 0
    if solution.status in ("infeasible", "unbounded", "infeasible_or_unbounded"):
        return 3
    if solution.limit == "interrupt" or interrupts.received:  # also where the search had ended without an answer before
        return interrupts.exit_code()
    return 1 if solution.status == "error" else 4


def _check_answer(problem: Problem, out: Path | None, plot: Path | None, view: str | None) -> None:
    """Refuse now how the answer could not be written or drawn after the search."""
    if out is not None:
        from ..formulations.answers import check_answer_path

        check_answer_path(problem, out)
    if view is not None and plot is None:
        raise UsageError("--view says what --plot draws: give a file with --plot")
    if plot is not None:
        from ..reports.plots import check_drawable

        check_drawable(problem, view)
        check_matplotlib()


def _write_outputs(
    delivery: Delivery, solution: Solution, out: Path | None, certificate: Path | None, plot: Path | None, view: str | None
) -> None:
    from ..formulations.answers import write_answer
    from ..formulations.certificate_files import write_certificate

    def draw(path: Path) -> None:
        from ..reports.plots import save_plot

        save_plot(solution, path, view)

    if solution.answer is None:
        for path in (out, plot):
            if path is not None:
                remark(f"there is no answer, so {path} was not written")
    else:
        delivery.file("--out", out, lambda path: write_answer(solution, path))
    delivery.file("--certificate", certificate, lambda path: write_certificate(solution.certificate, path))
    if solution.answer is not None:
        delivery.file("--plot", plot, draw)


def _write_page(solution: Solution, path: Path) -> None:
    solution.to_html(path)


def _least(solution: Solution) -> dict[str, Any]:
    """The least that must not be lost where all else cannot be shown: a file of it is read back like any other answer."""
    answer = None if solution.answer is None else solution.problem.answer_to_json(solution.answer)
    facts = {"instance": solution.problem.name, "problem": solution.problem.problem, "status": solution.status}
    return {**facts, "objective": solution.objective, "answer": answer, "faults": list(solution.faults)}


def _shown(solution: Solution, verbose: bool) -> str:
    from ..formulations.rendering import Line
    from ..formulations.solution import solution_lines, solution_title
    from ..reports.tables.answers import answer_tables

    tables = "".join(table_text(table, every=verbose) for table in answer_tables(solution.problem, solution.answer))
    lines = solution_lines(solution)
    if verbose:
        lines.append(Line("versions", ", ".join(f"{k} {v}" for k, v in solution.versions.items()), "quiet"))
        lines += [Line("chain" if k == 0 else "", str(link), "quiet") for k, link in enumerate(solution.chain)]
        for name, value in solution.statistics.items():
            told = [", ".join(f"{k} {v}" for k, v in one.items()) for one in value] if name == "turns" else [str(value)]
            lines += [Line("" if k else name, each, "quiet") for k, each in enumerate(told)]
    return tables + lines_text(solution_title(solution), lines)
