"""Runs on a Dask cluster. Where Dask is not installed, what is told of that."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import campaign_file
from coded import coded

from waybound.instances.errors import MissingPackageError, SearchFailedError, UsageError
from waybound.reports.campaigns import dask_cluster
from waybound.reports.campaigns.campaign import read_campaign
from waybound.reports.campaigns.dask_cluster import DaskWorkers
from waybound.reports.campaigns.one_run import Outcome, Task
from waybound.reports.campaigns.running import run_campaign
from waybound.reports.campaigns.setting import Setting

TASK = Task("a", Setting(method="savings"), 1, ".", 1.0)


def test_without_dask_its_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_cluster, "find_spec", lambda name: None)
    with pytest.raises(MissingPackageError, match=r"pip install 'waybound\[cluster\]'"):
        DaskWorkers("local")


def test_an_address_is_local_or_that_of_a_scheduler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_cluster, "find_spec", lambda name: name)
    with pytest.raises(UsageError, match="tcp://HOST:8786", check=coded("malformed")):
        DaskWorkers("somewhere")


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
    import sys
    import types

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


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(dask_cluster, "PATIENCE", "1s")
    with pytest.raises(UsageError, match="no scheduler can be reached", check=coded("file")), DaskWorkers("tcp://127.0.0.1:9"):
        pass
