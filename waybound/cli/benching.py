"""``waybound bench``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..instances.errors import InputError, UsageError
from ..instances.suggestions import did_you_mean
from . import completing
from .delivery import PAGE_SUFFIXES, PLOT_SUFFIXES, check_matplotlib, check_outputs
from .handling import remark
from .options import Json, Quiet, Verbose, arg, bounded, opt
from .output import print_json, print_table, print_text
from .progress import PartsCounter

if TYPE_CHECKING:
    import pandas as pd

    from ..reports.campaigns.campaign import Campaign

_Status = Annotated[bool, opt("--status", "Say how far it is, and run nothing.")]
_Export = Annotated[Path | None, opt("--export FILE", "Write one row a run: .csv or .parquet.")]
_Profile = Annotated[Path | None, opt("--profile FILE", "Write performance profiles: .csv, or a picture (.png, .svg, .pdf).")]
_Cluster = Annotated[str | None, opt("--cluster ADDRESS", "Run on Dask: local, or a scheduler's address such as tcp://HOST:8786.")]


def bench(
    campaign: Annotated[
        str,
        arg("CAMPAIGN", "A campaign file (.toml), a bundled campaign, or a results file, of which nothing is run.", completing.campaigns),
    ],
    status: _Status = False,
    export: _Export = None,
    jobs: Annotated[int, opt("--jobs N", "Runs at a time; more than there are cores would slow each other down.")] = 1,
    cluster: _Cluster = None,
    again: Annotated[bool, opt("--again", "Do those runs once more that ended in an error.")] = False,
    profile: _Profile = None,
    measure: Annotated[str, opt("--measure NAME", "What --profile is about: objective, or seconds to an optimum.")] = "objective",
    page: Annotated[Path | None, opt("--page FILE", "Write a page to look at (.html): overview, profiles, gaps, and all runs.")] = None,
    against: Annotated[str | None, opt("--against METHOD", "Paired tests of all methods against this one.")] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Run a campaign, instances by solvers and heuristics by seeds: what its results file lacks is done, each run in a process of its own.

    Exit code 0 when all is done, 5 if an answer or a claim of some run failed a check, 2 for what cannot be run, 130 after Ctrl-C, which
    keeps what is done.
    """
    from ..reports.campaigns.frames import EXPORTERS, check_export

    bounded(jobs=jobs)
    check_outputs(
        [campaign], export=(export, tuple(EXPORTERS.names())), profile=(profile, (".csv", *PLOT_SUFFIXES)), page=(page, PAGE_SUFFIXES)
    )
    if page is not None:
        check_matplotlib("--page")
    if profile is not None and profile.suffix.lower() != ".csv":
        check_matplotlib("--profile")
    if export is not None:
        check_export(export)
    asked, done = None, 0
    if _is_results(campaign):
        if again or cluster is not None:
            raise UsageError(f"{campaign} is a results file, of which nothing is run; name its campaign file")
        path = Path(campaign)
    else:
        asked = _asked(campaign)
        path = asked.results
        if status and again:
            raise UsageError("--status runs nothing, so that there is nothing to do --again")
        if not status:
            done = _run(asked, cluster, jobs, again, quiet)
    report = _Report(asked, _results(asked, path), path)
    if export is not None:
        report.export(export)
    if profile is not None:
        report.write_profile(measure, profile)
    if page is not None:
        report.write_page(against, page)
    report.show(done, against, json)


def _is_results(path: str) -> bool:
    """Whether an argument names a results file: by how it begins, or by how its name ends."""
    try:
        with Path(path).open("rb") as stream:
            return stream.read(15) == b"SQLite format 3" or Path(path).suffix in (".sqlite", ".db")
    except (OSError, ValueError):
        return False


def _asked(campaign: str) -> Campaign:
    from ..reports.campaigns.campaign import bundled_campaigns, read_campaign

    bundled = bundled_campaigns()
    if campaign in bundled and not Path(campaign).exists():
        return read_campaign(bundled[campaign], Path.cwd())
    if not Path(campaign).exists() and Path(campaign).suffix != ".toml":
        hint = did_you_mean(campaign, bundled) or f"; bundled are {', '.join(bundled)}"
        raise InputError(f"no such campaign file, and no bundled campaign of that name{hint}", "file", file=campaign)
    return read_campaign(campaign)


def _run(campaign: Campaign, cluster: str | None, jobs: int, again: bool, quiet: bool) -> int:
    from ..reports.campaigns.running import run_campaign, workers_at

    with PartsCounter(campaign.file.stem, quiet, unit="runs") as counter:
        return run_campaign(campaign, workers_at(cluster, jobs), again=again, progress=counter)


def _results(campaign: Campaign | None, path: Path) -> pd.DataFrame | None:
    """The rows of a campaign, or of a whole results file; None where nothing was run yet."""
    from ..reports.campaigns.frames import of_runs, results

    if campaign is None:
        return results(path)
    if not path.exists():
        return None
    try:
        return of_runs(results(path), {run.key for run in campaign.runs})
    except InputError as fault:
        if str(fault.code) != "missing":
            raise
        return None  # the campaign was killed before there was a table


class _Report:
    """Results, and their output."""

    def __init__(self, campaign: Campaign | None, frame: pd.DataFrame | None, path: Path) -> None:
        from ..reports.campaigns.counting import counted

        self.campaign, self.path = campaign, path
        self.frame = None if frame is None or frame.empty else frame
        known = None if campaign is None else campaign.best_known_values()
        self.runs = None if self.frame is None else counted(self.frame, known)

    def export(self, export: Path) -> None:
        from ..reports.campaigns import frames

        self._need()
        assert self.frame is not None
        frames.export(self.frame, export)

    def write_profile(self, measure: str, path: Path) -> None:
        from ..reports.campaigns.profiles import profile, write_profile

        self._need()
        assert self.runs is not None
        write_profile(profile(self.runs, measure), measure, path)

    def write_page(self, against: str | None, path: Path) -> None:
        from ..reports.pages.campaigns import campaign_page

        self._need()
        assert self.runs is not None
        name, planned = (self.path.stem, len(self.runs)) if self.campaign is None else (self.campaign.file.stem, len(self.campaign.runs))
        campaign_page(self.runs, self.path, name=name, planned=planned, against=against).write(path)

    def show(self, done: int, against: str | None, json: bool) -> None:
        """Show the summary, and end with 5 where a check failed."""
        from ..reports.campaigns.paired_tests import against as tests_against, paired_table
        from ..reports.campaigns.summary import summary_of, summary_table

        rows = 0 if self.frame is None else len(self.frame)
        planned = rows if self.campaign is None else len(self.campaign.runs)
        summary = None if self.runs is None else summary_of(self.runs, self.path)
        if against is not None:
            self._need()
        tests = None if against is None or self.runs is None else tests_against(self.runs, against)
        failed = 0 if summary is None else sum(method.errors for method in summary.methods)
        faults = 0 if summary is None else summary.failed_checks
        if json:
            counts: dict[str, Any] = {"results": str(self.path), "planned": planned, "done": rows, "missing": planned - rows, "ran": done}
            methods = [] if summary is None else summary.to_json()
            paired = {} if tests is None else {"against": against, "tests": tests.to_dict("records")}
            print_json({"schema": 1, **counts, "errors": failed, "failed_checks": faults, "methods": methods, **paired})
        else:
            if summary is not None:
                print_table(summary_table(summary))
                for note in summary.notes:
                    print_text(f"note: {note}")
            if tests is not None:
                print_table(paired_table(tests, str(against)))
            print_text(f"{rows} of {planned} runs are done, {done} of them now; results in {self.path}")
        if failed:
            remark(f"{failed} run{'s' if failed != 1 else ''} ended in an error (column reason); --again does them once more")
        if faults:
            raise typer.Exit(5)

    def _need(self) -> None:
        if self.frame is None:
            raise InputError("there are no results yet", "missing", file=self.path)
