"""``waybound ratio``: approximation ratios observed against stated ones, and the experiments on sensing graphs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..solvers import interrupts
from . import completing
from .handling import complain, remark
from .options import Json, Quiet, Verbose, arg, bounded, opt
from .output import print_json, print_table, print_text
from .progress import PartsCounter

if TYPE_CHECKING:
    from ..reports.studies.study import Report, Study

ALL = "all"
"""Names every study that tests stated guarantees or published values."""


def ratio(
    study: Annotated[
        str | None, arg("[STUDY]", "Name of a study, or all; without one, they are listed.", completing.names("study"))
    ] = None,
    instances: Annotated[
        int | None,
        opt("--instances N", "Random instances for each heuristic, spread over the families; trials of each point of an experiment."),
    ] = None,
    seed: Annotated[int, opt("--seed N", "The same seed gives the same instances and runs.")] = 1,
    jobs: Annotated[int, opt("--jobs N", "Processes that share the work; the figures do not depend on it.")] = 1,
    out: Annotated[Path | None, opt("--out FOLDER", "Write tables (.csv, .md), figures (.png) and violating instances here.")] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Approximation ratios, observed against stated, and the experiments behind them; ends with 5 where a guarantee is broken."""
    from ..reports.studies.study import STUDIES, StudySetting
    from ..reports.studies.writing import check_folder

    bounded(instances=instances, seed=seed, jobs=jobs)
    if out is not None:
        check_folder(out)
    if study is None:
        _list(json)
        return
    chosen = [s for s in STUDIES.values() if s.guarantees] if study == ALL else [STUDIES[study]]
    # Ctrl-C ends a study, which then brings what it has; a second study is not begun after it.
    reports: list[Report] = []
    files: list[tuple[str | None, ...]] = []
    for one in chosen:
        with PartsCounter(one.name, quiet) as counter:
            report = one(StudySetting(instances or one.instances, seed, jobs, counter))
        if report.rows or not report.interrupted:
            reports.append(report)
            files.append(_keep(report, out, json))
        if report.interrupted:
            remark(f"interrupted: {report.done} of {report.asked} parts of {one.name} were done, and are shown")
            break
    if json:
        print_json({"schema": 1, "seed": seed, "studies": [r.to_json(f) for r, f in zip(reports, files, strict=True)]})
    if any(report.num_faults for report in reports):
        raise typer.Exit(5)
    raise typer.Exit(0 if reports else interrupts.exit_code())


def _list(json: bool) -> None:
    from ..reports.studies.study import STUDIES
    from ..reports.tables.table import Column, Table

    studies: list[Study] = STUDIES.values()
    if json:
        listed = [{"name": s.name, "summary": s.summary, "instances": s.instances, "all": s.guarantees} for s in studies]
        print_json({"schema": 1, "studies": listed})
        return
    columns = (Column("study"), Column("instances", right=True), Column("in all"), Column("what it measures", wide=True))
    rows = tuple((s.name, str(s.instances), "yes" if s.guarantees else "no", s.summary) for s in studies)
    print_table(Table("Studies", columns, rows))


def _keep(report: Report, out: Path | None, json: bool) -> tuple[str | None, ...]:
    """Show and write one report; returns where the instances of its faults are."""
    from ..reports.studies.violations import summary_lines, write_faults
    from ..reports.studies.writing import write_report

    if not json:
        print_table(report.table)
        for note in report.notes:
            print_text(f"note: {note}")
    if out is not None:
        written = write_report(report, out)
        if not json:
            print_text("written: " + ", ".join(str(path) for path in written))
    files = write_faults(report, out or Path.cwd())
    for line in summary_lines(report.faults, files, report.num_faults):
        complain(f"{report.study}: {line}")
    return files
