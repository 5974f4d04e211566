"""``waybound report`` and ``waybound ratio``: experiments beside what was published, and approximation ratios beside what is stated."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..solvers import interrupts
from . import completing
from .handling import complain, remark
from .options import Json, Quiet, Verbose, arg, bounded, opt
from .output import print_json, print_table, print_text, table_fits
from .progress import PartsCounter

if TYPE_CHECKING:
    from ..reports.studies.study import Report, Study, StudySetting
    from ..reports.tables.table import Table

ALL = "all"
"""Names every study: with ``ratio``, those that test stated guarantees."""

StudyName = Annotated[str | None, arg("[STUDY]", "Name of a study, or all; without one, they are listed.", completing.names("study"))]
StudySeed = Annotated[int, opt("--seed N", "The same seed gives the same instances and runs.")]
Jobs = Annotated[int, opt("--jobs N", "Processes that share the work; the figures do not depend on it.")]


def report(
    study: StudyName = None,
    full: Annotated[bool, opt("--full", "All levels, runs and steps; without it, enough of each to see it work, in seconds.")] = False,
    out: Annotated[
        Path | None, opt("--out FILE.html|FOLDER", "Write a page that needs no network; into a folder also tables and figures.")
    ] = None,
    seed: StudySeed = 1,
    jobs: Jobs = 1,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Experiments of the literature played again, published numbers beside ours; ends with 5 where a guarantee or a value is broken."""
    from ..reports.studies.study import STUDIES
    from ..reports.studies.writing import check_out

    bounded(seed=seed, jobs=jobs)
    if out is not None:
        check_out(out, study == ALL)
    if study is None:
        _list_reports(json)
        return
    chosen = STUDIES.values() if study == ALL else [STUDIES[study]]
    _work([(one, one.setting(full=full, seed=seed, jobs=jobs)) for one in chosen], seed, out, True, json, quiet)


def ratio(
    study: StudyName = None,
    instances: Annotated[
        int | None,
        opt("--instances N", "Random instances for each heuristic, spread over the families; trials of each point of an experiment."),
    ] = None,
    seed: StudySeed = 1,
    jobs: Jobs = 1,
    out: Annotated[Path | None, opt("--out FOLDER", "Write tables (.csv, .md), figures (.png) and violating instances here.")] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Approximation ratios, observed against stated, and the experiments behind them; ends with 5 where a guarantee is broken."""
    from ..reports.studies.study import STUDIES
    from ..reports.studies.writing import check_folder

    bounded(instances=instances, seed=seed, jobs=jobs)
    if out is not None:
        check_folder(out)
    if study is None:
        _list_ratios(json)
        return
    chosen = [s for s in STUDIES.values() if s.guarantees] if study == ALL else [STUDIES[study]]
    _work([(one, one.setting(instances=instances or one.instances, seed=seed, jobs=jobs)) for one in chosen], seed, out, False, json, quiet)


def _work(chosen: list[tuple[Study, StudySetting]], seed: int, out: Path | None, paged: bool, json: bool, quiet: bool) -> None:
    """Run studies, show and keep what each brings; Ctrl-C ends one, which shows what it has, and none is begun after it."""
    from dataclasses import replace

    reports: list[Report] = []
    files: list[tuple[str | None, ...]] = []
    for one, setting in chosen:
        with PartsCounter(one.name, quiet) as counter:
            made = one(replace(setting, told=counter))
        if made.rows or not made.interrupted:
            reports.append(made)
            files.append(_keep(one, setting, made, out, paged, json))
        if made.interrupted:
            remark(f"interrupted: {made.done} of {made.asked} parts of {one.name} were done, and are shown")
            break
    if json:
        print_json({"schema": 1, "seed": seed, "studies": [r.to_json(f) for r, f in zip(reports, files, strict=True)]})
    if any(made.num_faults for made in reports):
        raise typer.Exit(5)
    raise typer.Exit(0 if reports else interrupts.exit_code())


def _keep(study: Study, setting: StudySetting, report: Report, out: Path | None, paged: bool, json: bool) -> tuple[str | None, ...]:
    """Show and write one report; returns where the instances of its faults are."""
    from ..reports.studies.page import write_page
    from ..reports.studies.violations import summary_lines, write_faults
    from ..reports.studies.writing import is_page, write_report

    page = out if out is not None and paged and is_page(out) else None
    folder = Path.cwd() if out is None else out.parent if page else out
    if not json:
        for table in report.tables:
            _show(table)
        for note in report.notes:
            print_text(f"note: {note}")
    if out is not None:
        written = () if page else write_report(report, out)
        if paged:
            written = (write_page(study, setting, report, page or out / f"{study.name}.html"), *written)
        if not json:
            print_text("written: " + ", ".join(str(path) for path in written))
    files = write_faults(report, folder)
    for line in summary_lines(report.faults, files, report.num_faults):
        complain(f"{report.study}: {line}")
    return files


def _show(table: Table) -> None:
    if table_fits(table):
        print_table(table)
    else:
        print_text(f"{table.title}: {len(table.columns)} columns, too wide to be shown here; --out and --json have them")


def _list_ratios(json: bool) -> None:
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


def _list_reports(json: bool) -> None:
    from ..reports.studies.study import STUDIES
    from ..reports.tables.table import Column, Table

    studies: list[Study] = sorted(STUDIES.values(), key=lambda s: (not s.source, s.name))  # experiments of a source first
    if json:
        listed = [{"name": s.name, "summary": s.summary, "source": s.source, "claim": s.claim} for s in studies]
        print_json({"schema": 1, "studies": listed})
        return
    columns = (Column("study"), Column("what it plays", wide=True), Column("source", wide=True))
    print_table(Table("Studies", columns, tuple((s.name, s.summary, s.source or "stated guarantees") for s in studies)))
