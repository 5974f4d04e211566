"""Running a campaign: what is missing is done, by processes of this machine or a cluster, and written by this process alone."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, suppress
from typing import Protocol

from ...instances.errors import InputError, UnsupportedError, UsageError
from ...instances.registry import Registry
from .campaign import Campaign, Planned
from .one_run import Outcome, Task
from .results_file import ResultsFile

Told = Callable[[int, int, str], None]
"""Hears how many runs are done, of how many, and which was the last."""


class Workers(Protocol):
    """Does the runs of a campaign: processes of this machine (``run_processes.py``) or a cluster (``dask_cluster.py``)."""

    def outcomes(self, tasks: Iterator[tuple[Planned, Task]]) -> Iterator[tuple[Planned, Outcome]]:
        """Each run with its outcome, in the order in which they end; tasks are taken as they can be done."""
        ...


WORKERS: Registry[Callable[[str, int], AbstractContextManager[Workers]]] = Registry("cluster", __package__, group="waybound.workers")
"""Functions from the address of a cluster and a number of jobs to its workers, by the scheme of the address: ``tcp`` of ``tcp://host:8786``."""


def workers_at(address: str | None, jobs: int) -> AbstractContextManager[Workers]:
    """The workers of a cluster, or processes of this machine.

    Raises UsageError for an address of another kind than there are; MissingPackageError where the package that it takes is not installed.
    """
    if address is None:
        return WORKERS["processes"]("", jobs)
    scheme, colon, _ = address.partition("://")
    if scheme == "processes" or not (colon or scheme in WORKERS):
        raise UsageError(f"no cluster is named {address!r}: write local, or the address of a scheduler, tcp://HOST:8786", "unknown-name")
    return WORKERS[scheme](address, jobs)


def run_campaign(campaign: Campaign, workers: AbstractContextManager[Workers], *, again: bool = False, progress: Told | None = None) -> int:
    """Do the runs of a campaign that its results file lacks; returns how many were done.

    ``workers`` is entered only if anything is to be done; with ``again`` runs that ended in an error are done once more; ``progress`` hears
    ``(done, planned, what)`` after each run. Raises InputError and UsageError of the results file; what was done until then is in it.
    """
    with ResultsFile(campaign.results) as results:
        if again:
            results.forget({run.key for run in campaign.runs})
        there = results.keys()
        missing = [run for run in campaign.runs if run.key not in there]
        if not missing:
            return 0
        check_reading(missing)
        done, planned, common = 0, len(campaign.runs), (str(campaign.folder), campaign.overtime)
        tasks = ((run, Task(run.instance.source, run.setting, run.seed, *common, run.instance.hash, campaign.modules)) for run in missing)
        with workers as able:
            for run, outcome in able.outcomes(tasks):
                results.add(run, outcome)
                done += 1
                if progress is not None:
                    progress(planned - len(missing) + done, planned, f"{run.instance.name} by {run.setting.label}, seed {run.seed}")
        return done


def check_reading(runs: list[Planned]) -> None:
    """Read one instance in each way that these runs ask for, so that an unknown setting is one error, not one for every run.

    Raises UsageError for a problem, convention or change of the data that does not exist.
    """
    from ...api import problem_of, read_source

    ways = {run.setting.reading: run for run in reversed(runs)}
    for run in ways.values():
        s = run.setting
        changes = {**s.changes}
        with suppress(InputError, UnsupportedError, OSError):  # of this instance: told by its runs
            instance = read_source(run.instance.source, s.format, s.problem, changes)
            problem_of(instance, s.problem, s.convention, changes)
