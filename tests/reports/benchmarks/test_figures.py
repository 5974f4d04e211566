from pathlib import Path
from typing import Any

import pytest
from campaign_cases import Here, campaign_file, outcome

from waybound.instances.bundled import bundled_path
from waybound.instances.errors import InputError
from waybound.reports.benchmarks import figures
from waybound.reports.campaigns.campaign import Campaign, read_campaign
from waybound.reports.campaigns.running import run_campaign

CAMPAIGNS = sorted((Path(figures.__file__).parent / "campaigns").glob("*.toml"))

UNKNOWN = {
    "portfolio-other-families": {"lc101", "lr104", "lrc103", "lr205", "lc1_2_5", "lr1_2_10", "lrc1_2_10", "lr2_2_10"},
    "routing-heuristics": {"M-n200-k17"},
    "routing-families": {"lc101", "tsiligirides_problem_1_budget_30"},
}
"""Instances that are compared with no best known value: those of vehicles and then distance, and others that have none."""


@pytest.mark.parametrize("file", CAMPAIGNS, ids=lambda file: file.stem)
def test_every_campaign_plans_files_that_are_there_and_have_a_value_to_compare_with(
    file: Path, benchmarks: Path, tmp_path: Path, own_modules: Any
) -> None:
    asked = read_campaign(file, tmp_path)
    known = asked.best_known_values()
    values = {run.instance.name: known[run.instance.hash, run.setting.reading] for run in asked.runs}
    without = {name for name, of in values.items() if not of or len({value[:2] for value in of}) < len(of)}  # none, or several
    if file.stem not in ("proofs-solomon-cut", "winner-takes-all"):  # of parts of files and what is generated nobody published a value
        assert without == UNKNOWN.get(file.stem, set())
    assert asked.results.name == f"{file.stem}.sqlite" and len(asked.runs) > 30


def test_without_the_variable_that_names_the_files_it_is_asked_for(monkeypatch: pytest.MonkeyPatch, own_modules: Any) -> None:
    monkeypatch.delenv("WAYBOUND_BENCHMARKS", raising=False)
    with pytest.raises(InputError, match="needs the environment variable WAYBOUND_BENCHMARKS, which is not set"):
        read_campaign(CAMPAIGNS[0])


def campaign(folder: Path, of: Any, **changes: Any) -> Campaign:
    """One that was done by making things up: files in two folders, whose best known value is 100."""
    for place in ("one", "two"):
        (folder / place).mkdir(exist_ok=True)
        for name in ("a", "b"):
            (folder / place / f"{name}.json").write_bytes(bundled_path("demo-tiny").read_bytes() + f"{place}{name}".encode())
    (folder / "bks.csv").write_text("instance,value\na,100\nb,100\n")
    own = {"instances": ["one/*.json", "two/*.json"], "heuristics": ["savings", "insertion"], "seeds": [1]}
    asked = read_campaign(campaign_file(folder, **{**own, **changes}))
    run_campaign(asked, Here(of))
    return asked


def test_a_folder_has_a_table_of_gaps_proofs_and_seconds_of_the_processor(tmp_path: Path) -> None:
    def made(task: Any) -> Any:
        if "two" in task.path and task.setting.method == "insertion":
            return outcome(None, status="error", error_code="unsupported")
        proved = {"status": "optimal", "bound": 110.0, "bound_kind": "verified"}
        own = proved if task.path.endswith("a.json") else {"bound": 90.0, "verified_bound": 90.0}
        return outcome(110.0 if task.setting.method == "savings" else 120.0, cpu_seconds=4.0, **own)

    runs = figures.runs_of(campaign(tmp_path, made))
    one, two = figures.tables(runs)
    assert one.splitlines()[1] == "### one" and two.splitlines()[1] == "### two"
    row = "| `savings` | 2 | 2 | 1 | 1 | 10.00 (10.00) | 9.09 (18.18) | 10.00 (10.00) | 4.00 (4.00) | 4.0 (1) |"
    assert row in one.splitlines() and row in two.splitlines()
    assert "insertion" in one and "insertion" not in two, "who can take no file of a folder has no row there"
    assert figures.excluding(runs).empty


def test_a_verified_bound_that_excludes_the_best_known_value_and_a_run_that_failed_are_exit_code_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made: dict[str, Any] = {"instances": ["one/a.json"], "heuristics": ["savings"]}
    for result, told in (
        (outcome(110.0, verified_bound=100.1, cpu_seconds=1.0), "has the verified bound 100.1, best known 100.0"),
        (outcome(None, status="error", reason="out of memory", error_code="too-large"), "out of memory"),
        (outcome(110.0, verified_bound=100.00001, cpu_seconds=1.0), ""),
    ):
        asked = campaign(tmp_path, lambda task, result=result: result, **made)
        assert figures.main(["--campaign", str(asked.file)]) == bool(told)
        assert told in capsys.readouterr().err
        asked.results.unlink()


def test_an_answer_that_is_called_optimal_and_is_not_the_best_is_exit_code_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own = {"bound": 110.0, "bound_kind": "claimed", "status": "optimal", "cpu_seconds": 1.0}
    asked = campaign(tmp_path, lambda task: outcome(110.0 + (task.setting.method == "savings"), **own), instances=["one/a.json"])
    assert figures.main(["--campaign", str(asked.file)]) == 1
    assert "a: savings calls 111.0 optimal, 110.0 is better" in capsys.readouterr().err


@pytest.mark.slow
def test_files_of_each_family_are_bounded_within_their_gaps(benchmarks: Path, tmp_path: Path) -> None:
    files = ["cvrp/A/A-n32-k5.vrp", "top/set6/p6.2.d.txt", "minmax-mtsp/mtsplib/eil51-m2.txt"]
    own: dict[str, Any] = {"heuristics": ["savings", "greedy-orienteering", "tour-splitting"], "seeds": [1], "bound_time": 5}
    asked = read_campaign(campaign_file(tmp_path, instances=[{"folder": "$WAYBOUND_BENCHMARKS", "file": files}], **own))
    run_campaign(asked, Here())
    runs = figures.runs_of(asked)
    assert figures.excluding(runs).empty
    least = runs.groupby("instance")["bound_gap"].min()
    assert least["A-n32-k5"] <= 0.12 and least["p6.2.d"] <= 0.12 and least["eil51-m2"] <= 0.15
