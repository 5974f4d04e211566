"""``waybound bench``."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..instances.errors import InputError, UsageError
from ..instances.suggestions import did_you_mean
from .delivery import check_outputs
from .handling import remark
from .options import Json, Quiet, Verbose, arg, bounded, opt
from .output import print_json, print_table, print_text
from .progress import PartsCounter

if TYPE_CHECKING:
    import pandas as pd

    from ..reports.campaigns.campaign import Campaign
    from ..reports.campaigns.running import Workers

EXPORT_SUFFIXES = (".csv", ".parquet")

_Status = Annotated[bool, opt("--status", "Say how far it is, and run nothing.")]
_Export = Annotated[Path | None, opt("--export FILE", "Write one row a run: .csv or .parquet.")]
_Cluster = Annotated[str | None, opt("--cluster ADDRESS", "Run on Dask: local, or a scheduler's address such as tcp://HOST:8786.")]


def bench(
    campaign: Annotated[str, arg("CAMPAIGN", "A campaign file (.toml), a bundled campaign, or a results file, of which nothing is run.")],
    status: _Status = False,
    export: _Export = None,
    jobs: Annotated[int, opt("--jobs N", "Runs at a time; more than there are cores would slow each other down.")] = 1,
    cluster: _Cluster = None,
    again: Annotated[bool, opt("--again", "Do those runs once more that ended in an error.")] = False,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Run a campaign, instances by solvers and heuristics by seeds: what its results file lacks is done, each run in a process of its own.

    Exit code 0 when all is done, 5 if an answer or a claim of some run failed a check, 2 for what cannot be run, 130 after Ctrl-C, which
    keeps what is done.
    """
    from ..reports.campaigns.frames import check_export

    bounded(jobs=jobs)
    check_outputs([campaign], export=(export, EXPORT_SUFFIXES))
    if export is not None:
        check_export(export)
    if _is_results(campaign):
        if again or cluster is not None:
            raise UsageError(f"{campaign} is a results file, of which nothing is run; name its campaign file", "contradiction")
        _tell(None, Path(campaign), export, json, 0)
        return
    asked = _asked(campaign)
    done = 0
    if not status:
        from ..reports.campaigns.running import run_campaign

        with PartsCounter(Path(campaign).stem, quiet, unit="runs") as counter:
            done = run_campaign(asked, _workers(cluster, jobs), again=again, progress=counter)
    elif again:
        raise UsageError("--status runs nothing, so that there is nothing to do --again")
    _tell(asked, asked.results, export, json, done)


def _is_results(path: str) -> bool:
    """Whether an argument names a results file: by how it begins, or by how its name ends."""
    try:
        with Path(path).open("rb") as stream:
            return stream.read(15) == b"SQLite format 3" or Path(path).suffix in (".sqlite", ".db")
    except (OSError, ValueError):
        return False


def _asked(campaign: str) -> Campaign:
    from ..reports.campaigns.bundled import bundled_campaigns
    from ..reports.campaigns.campaign import read_campaign

    bundled = bundled_campaigns()
    if campaign in bundled and not Path(campaign).exists():
        return read_campaign(bundled[campaign], Path.cwd())
    if not Path(campaign).exists() and Path(campaign).suffix != ".toml":
        hint = did_you_mean(campaign, bundled) or f"; bundled are {', '.join(bundled)}"
        raise InputError(f"no such campaign file, and no bundled campaign of that name{hint}", "file", file=campaign)
    return read_campaign(campaign)


def _workers(cluster: str | None, jobs: int) -> AbstractContextManager[Workers]:
    if cluster is not None:
        from ..reports.campaigns.dask_cluster import DaskWorkers

        return DaskWorkers(cluster, jobs)
    from ..reports.campaigns.run_processes import RunProcesses

    return RunProcesses(jobs)


def _tell(campaign: Campaign | None, path: Path, export: Path | None, json: bool, done: int) -> None:
    """Write the rows, show the summary, and end with 5 where a check failed."""
    from ..reports.campaigns import frames
    from ..reports.campaigns.summary import summary_of, summary_table

    frame: pd.DataFrame | None = None
    if campaign is None or path.exists():
        frame = frames.results(path)
        if campaign is not None:
            frame = frames.of_runs(frame, {run.key for run in campaign.runs})
    if export is not None:
        if frame is None:
            raise InputError("there are no results to export yet", "missing", file=path)
        frames.export(frame, export)
    known = None if campaign is None else campaign.best_known_values()
    rows = 0 if frame is None else len(frame)
    planned = rows if campaign is None else len(campaign.runs)
    failed = 0 if frame is None else int((frame["status"] == "error").sum())
    faults = 0 if frame is None else int(((frame["faults"] > 0) | (frame["error_code"] == "check-failed")).sum())
    summary = None if frame is None or not rows else summary_of(frame, path, known)
    if json:
        told: dict[str, Any] = {"results": str(path), "planned": planned, "done": rows, "missing": planned - rows, "ran": done}
        methods = [] if summary is None else summary.to_json()
        print_json({"schema": 1, **told, "errors": failed, "failed_checks": faults, "methods": methods})
    else:
        if summary is not None:
            print_table(summary_table(summary))
            for note in summary.notes:
                print_text(f"note: {note}")
        print_text(f"{rows} of {planned} runs are done, {done} of them now; results in {path}")
    if failed:
        remark(f"{failed} run{'s' if failed != 1 else ''} ended in an error (column reason); --again does them once more")
    if faults:
        raise typer.Exit(5)
