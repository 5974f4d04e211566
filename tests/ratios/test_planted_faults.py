"""The ratio suite alone notices faults planted into heuristics, their statements and the checker; docs/ratios.md#planted-faults."""

from __future__ import annotations

from pathlib import Path

import pytest
from planted import FAULTS, INSTANCES, SEED, first_fault, plant
from typer.testing import CliRunner

QUICK = (
    "sequential greedy that forgets what others took",
    "knapsack greedy that states 1 - 1/e from single elements",
    "stochastic greedy that states 1 - 1/e",
    "auction in which whoever won a bin keeps it",
    "least mean that states the optimum at every risk",
)

BY_NAME = {fault.name: fault for fault in FAULTS}


@pytest.mark.parametrize("name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in BY_NAME])
def test_a_planted_fault_is_noticed(name, monkeypatch, tmp_path):
    plant(BY_NAME[name], monkeypatch, tmp_path)
    assert any(first_fault(study, monkeypatch) for study in BY_NAME[name].studies)
