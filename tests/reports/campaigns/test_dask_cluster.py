"""Runs on a Dask cluster. Where Dask is not installed, what is told of that."""

import json
import logging
import signal
import subprocess
import sys
import time
import types
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import campaign_file
from coded import coded

from waybound.instances.errors import MissingPackageError, SearchFailedError, UsageError
from waybound.reports.campaigns import dask_cluster
from waybound.reports.campaigns.campaign import Campaign, read_campaign
from waybound.reports.campaigns.dask_cluster import DaskWorkers
from waybound.reports.campaigns.one_run import Outcome, Task
from waybound.reports.campaigns.results_file import opened
from waybound.reports.campaigns.run_processes import RunProcesses
from waybound.reports.campaigns.running import run_campaign, workers_at
from waybound.reports.campaigns.setting import Setting
from waybound.solvers.children import child

TASK = Task("a", Setting(method="savings"), 1, ".", 1.0)


def test_without_dask_its_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_cluster, "find_spec", lambda name: None)
    with pytest.raises(MissingPackageError, match=r"pip install 'waybound\[cluster\]'"):
        DaskWorkers("local")


def test_an_address_is_local_or_that_of_a_scheduler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_cluster, "find_spec", lambda name: name)
    here, there = workers_at(None, 3), workers_at("tcp://x:1", 2)
    assert isinstance(here, RunProcesses) and here.jobs == 3
    assert isinstance(there, DaskWorkers) and there.address == "tcp://x:1"
    with pytest.raises(
        UsageError, match="no cluster is named 'somewhere': write local, or the address of a scheduler", check=coded("unknown-name")
    ):
        workers_at("somewhere", 1)


class Future:
    def __init__(self, status: str, value: Any) -> None:
        self.status, self.value = status, value

    def result(self) -> Any:
        return self.value

    exception = result


class Killed(Exception):
    allowed_failures = 3


@pytest.fixture
def workers(monkeypatch: pytest.MonkeyPatch) -> DaskWorkers:
    """Workers of a Dask that is made up."""
    monkeypatch.setattr(dask_cluster, "find_spec", lambda name: name)
    monkeypatch.setitem(sys.modules, "distributed", types.SimpleNamespace(KilledWorker=Killed))  # type: ignore[arg-type]
    return DaskWorkers("tcp://nowhere:1")


def test_a_run_that_loses_all_its_workers_is_an_error_and_a_lost_scheduler_ends_the_campaign(workers: DaskWorkers) -> None:
    made = Outcome({"status": "feasible"}, {}, {}, {})
    assert workers._outcome(Future("finished", made), TASK) is made
    assert workers._outcome(Future("error", Killed()), TASK).row["reason"] == "4 workers were lost while they did this run"
    with pytest.raises(SearchFailedError, match="cannot do runs: ModuleNotFoundError"):
        workers._outcome(Future("error", ModuleNotFoundError("waybound")), TASK)
    with pytest.raises(SearchFailedError, match="the scheduler of tcp://nowhere:1 was lost"):
        workers._outcome(Future("cancelled", None), TASK)


def test_what_dask_says_is_kept_off_standard_error_for_as_long_as_its_workers_are_used() -> None:
    before = logging.getLogger("distributed").level
    with dask_cluster._quiet():
        assert not logging.getLogger("distributed").isEnabledFor(logging.CRITICAL)
    assert logging.getLogger("distributed").level == before


@pytest.mark.slow
def test_a_campaign_runs_on_workers_of_this_machine(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    asked = read_campaign(campaign_file(tmp_path, seeds=[1, 2, 3]))
    assert run_campaign(asked, DaskWorkers("local", 2)) == 3
    assert run_campaign(asked, DaskWorkers("local", 2)) == 0


SLOW_SOLVER = """
import time
from waybound.extending import BACKENDS, Engine, RawResult, Routes

class OneEach(Engine):
    name, package, summary, modules, family = "one-each-slowly", "waybound", "A route a customer.", (), "routing"
    features = BACKENDS["pyvrp"].features

    def run(self, problem, options, control):
        self.begin(problem, options, control)
        time.sleep(0.3)
        return RawResult("feasible", answer=Routes.of([[int(k)] for k in problem.customers]))

BACKENDS.add("one-each-slowly", OneEach)
"""

ROWS = """SELECT i.name, s.method, r.seed, r.status, r.objective, r.checked FROM runs r JOIN instances i ON i.id = r.instance
JOIN settings s ON s.id = r.setting ORDER BY r.seed"""


class Cluster:
    """A scheduler and workers, each a process that was started by hand."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.file, self.stack = folder / "scheduler.json", stack
        self.scheduler = self.start("scheduler", "--port", "0", "--no-dashboard")
        while not self.file.exists():
            assert self.scheduler.poll() is None, "the scheduler ended"
            time.sleep(0.05)
        self.workers = [self.worker(), self.worker()]

    @property
    def address(self) -> str:
        return str(json.loads(self.file.read_text())["address"])

    def worker(self) -> subprocess.Popen[bytes]:
        return self.start("worker", "--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(self.file.parent))

    def start(self, what: str, *words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", "--scheduler-file", str(self.file), *words]
        return self.stack.enter_context(child(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))


@pytest.fixture
def cluster(tmp_path: Path, own_modules: Any) -> Iterator[Cluster]:
    pytest.importorskip("distributed")
    with ExitStack() as stack:
        yield Cluster(tmp_path, stack)


def slow_campaign(folder: Path, results: str, count: int) -> Campaign:
    """Runs of 0.3 s by a solver beside the campaign."""
    (folder / "slow_solver_of_a_test.py").write_text(SLOW_SOLVER)
    own: dict[str, Any] = {"solvers": ["one-each-slowly"], "modules": ["slow_solver_of_a_test"], "set": {"vehicles": 99}}
    asked = campaign_file(folder, without="heuristics", results=results, seeds=list(range(1, count + 1)), **own)
    return read_campaign(asked.rename(folder / f"{results}.toml"))


def rows(campaign: Campaign) -> list[Any]:
    with opened(campaign.results) as connection:
        return connection.execute(ROWS).fetchall()


@pytest.mark.slow
def test_a_worker_that_is_killed_in_the_middle_of_its_runs_costs_none_of_them(cluster: Cluster, tmp_path: Path) -> None:
    quiet, killed = (slow_campaign(tmp_path, name, 16) for name in ("quiet.sqlite", "killed.sqlite"))
    run_campaign(quiet, RunProcesses(2))
    victims = list(cluster.workers)

    def kill(done: int, planned: int, what: str) -> None:
        if done in (4, 8):
            time.sleep(0.1)  # into the next run of the worker
            victim = victims.pop()
            assert victim.poll() is None
            victim.kill()
            cluster.worker()

    assert run_campaign(killed, DaskWorkers(cluster.address), progress=kill) == 16
    assert not victims and all(worker.wait(30) == -signal.SIGKILL for worker in cluster.workers)
    assert rows(killed) == rows(quiet) and [row[3:] for row in rows(killed)] == 16 * [("feasible", rows(killed)[0][4], 1)]


@pytest.mark.slow
def test_a_scheduler_that_is_killed_ends_the_campaign_which_goes_on_elsewhere(cluster: Cluster, tmp_path: Path) -> None:
    asked = slow_campaign(tmp_path, "r.sqlite", 6)

    def kill(done: int, planned: int, what: str) -> None:
        if done == 2:
            cluster.scheduler.kill()

    with pytest.raises(SearchFailedError, match="was lost; what was done is kept"):
        run_campaign(asked, DaskWorkers(cluster.address), progress=kill)
    done = len(rows(asked))
    assert 2 <= done < 6
    assert run_campaign(asked, RunProcesses(2)) == 6 - done


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(dask_cluster, "PATIENCE", "1s")
    with pytest.raises(UsageError, match="no scheduler can be reached", check=coded("file")), DaskWorkers("tcp://127.0.0.1:9"):
        pass
