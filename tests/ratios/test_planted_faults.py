"""The ratio suite alone notices faults planted into heuristics, their statements and the checker; docs/ratios.md#planted-faults."""

from pathlib import Path

import pytest
from planted import FAULTS, INSTANCES, SEED, first_fault, plant
from typer.testing import CliRunner

from waybound.cli.app import app

QUICK = (
    "knapsack greedy that states 1 - 1/e from single elements",
    "auction in which whoever won a bin keeps it",
    "list schedule that is shortest first when asked for longest first",
    "local ratios that forget what a job brings elsewhere",
    "least mean that states the optimum at every risk",
)
"""Nothing has to be compiled for these."""

BY_NAME = {fault.name: fault for fault in FAULTS}


@pytest.mark.parametrize("name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in BY_NAME])
def test_a_planted_fault_is_noticed(name, monkeypatch, tmp_path):
    plant(BY_NAME[name], monkeypatch, tmp_path)
    assert any(first_fault(study, monkeypatch) for study in BY_NAME[name].studies)


def test_the_documentation_lists_all_planted_faults():
    table = (Path(__file__).parents[2] / "docs" / "ratios.md").read_text(encoding="utf-8")
    assert [name for name in BY_NAME if f"\n| {name} |" not in table] == []
    assert f"All {len(BY_NAME)} are noticed" in table


def test_the_command_ends_with_5_where_a_fault_is_planted(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    command = ["ratio", "least-mean", "--instances", str(INSTANCES), "--seed", str(SEED), "--quiet"]
    assert CliRunner().invoke(app, command).exit_code == 0
    plant(BY_NAME["least mean that weighs variance as well"], monkeypatch, tmp_path)
    ended = CliRunner().invoke(app, command)
    assert ended.exit_code == 5
    assert "ratio: least mean on" in ended.stderr
    assert (tmp_path / "violation-least-mean-1.json").exists()


def test_a_fault_is_gone_when_it_is_taken_out(tmp_path):
    with pytest.MonkeyPatch.context() as within:
        plant(BY_NAME["local ratios that forget what a job brings elsewhere"], within, tmp_path)
        assert first_fault("local-ratio", within)
    with pytest.MonkeyPatch.context() as within:
        assert first_fault("local-ratio", within) is None
