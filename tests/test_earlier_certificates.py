"""Certificates of all families that earlier versions wrote still hold, and still prove the same bound."""

import json
from pathlib import Path
from typing import Any

import pytest

import waybound as wb
from waybound.formulations.certificate import Certificate, check_certificate
from waybound.formulations.problem import Problem

FILES = sorted(Path(__file__).with_name("earlier_certificates").glob("*.json"))


@pytest.fixture(params=FILES, ids=lambda file: file.stem)
def recorded(request: pytest.FixtureRequest) -> dict[str, Any]:
    return dict(json.loads(request.param.read_text(encoding="utf-8")))


@pytest.fixture
def problem(recorded: dict[str, Any], tmp_path: Path) -> Problem:
    instance = tmp_path / recorded["file"]
    instance.write_text(recorded["instance"], encoding="utf-8")
    words = recorded["arguments"].split()
    asked = {key: words[words.index(f"--{key}") + 1] for key in ("problem", "convention") if f"--{key}" in words}
    return wb.read(instance, **asked)


def check(problem: Problem, recorded: dict[str, Any], **changes: Any) -> Certificate:
    certificate = {**recorded["certificate"], **changes}
    if recorded["answer"] is None:
        return check_certificate(problem, certificate, None)
    return wb.check(problem, recorded["answer"], certificate)


def test_an_earlier_certificate_holds(problem: Problem, recorded: dict[str, Any]) -> None:
    checked = check(problem, recorded).to_json(with_evidence=True)
    for key in ("instance_hash", "infeasible", "feasible", "objective", "bound", "bound_source"):
        assert checked[key] == recorded["certificate"][key], key


def test_an_earlier_certificate_that_states_more_is_refused(problem: Problem, recorded: dict[str, Any]) -> None:
    if recorded["certificate"]["bound"] is None:
        change = {"evidence": [], "infeasible": True, "feasible": None}
    else:
        better = 1.0 if problem.sense == "min" else -1.0
        change = {"bound": recorded["certificate"]["bound"] + better, "gap": 0.0}
    with pytest.raises(wb.CheckFailedError):
        check(problem, recorded, **change)
