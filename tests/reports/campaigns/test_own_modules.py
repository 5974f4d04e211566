import sys
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import campaign_file
from coded import coded

from waybound import InputError, results
from waybound.reports.campaigns.campaign import read_campaign
from waybound.reports.campaigns.own_modules import import_modules
from waybound.reports.campaigns.run_processes import RunProcesses
from waybound.reports.campaigns.running import run_campaign

MODULE = """
from waybound.extending import BACKENDS, Engine, RawResult, Routes

@BACKENDS.register("one-each")
class OneEach(Engine):
    name, package, summary, modules, family = "one-each", "waybound", "A route a customer.", (), "routing"
    features = BACKENDS["pyvrp"].features

    def run(self, problem, options, control):
        self.begin(problem, options, control)
        return RawResult("feasible", answer=Routes.of([[int(k)] for k in problem.customers]))
"""


@pytest.fixture
def folder(tmp_path: Path, own_modules: Any) -> Path:
    """A campaign's folder, with a module beside it."""
    (tmp_path / "own_solver_of_a_test.py").write_text(MODULE)
    return tmp_path


def test_a_solver_beside_the_campaign_runs_in_processes_of_its_own(folder: Path) -> None:
    asked = read_campaign(
        campaign_file(folder, without="heuristics", solvers=["one-each"], modules=["own_solver_of_a_test"], seeds=[1], set={"vehicles": 99})
    )
    assert run_campaign(asked, RunProcesses()) == 1
    row = results(asked.results).iloc[0]
    assert (row["status"], row["solver"], row["reason"]) == ("feasible", "one-each", None) and row["checked"]
    assert 0.0 < row["cpu_seconds"] < 60.0


def test_a_module_that_is_not_there_is_told_before_anything_is_run(folder: Path) -> None:
    with pytest.raises(InputError, match="a module cannot be imported: No module named 'gone_of_a_test'", check=coded("missing")):
        read_campaign(campaign_file(folder, modules=["gone_of_a_test"]))


def test_the_folder_comes_behind_all_others(tmp_path: Path, own_modules: Any) -> None:
    (tmp_path / "statistics.py").write_text("raise ZeroDivisionError")
    before = list(sys.path)
    import_modules(["statistics"], tmp_path)
    assert sys.path == [*before, str(tmp_path)]
