"""The battery of small cases: instances of every sort, a brute force that is right, and an exit code that tells of disagreement."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from exact_routing import best_values

from waybound.reports.benchmarks import small_cases as benchmark


def problems(count: int) -> list[benchmark.RoutingProblem]:
    rng = np.random.default_rng(5)
    return [p for k in range(4 * count) if len((p := benchmark.random_problem(rng, k)).customers) <= 4][:count]


def test_its_brute_force_is_that_of_the_tests() -> None:
    """The one of a command that stands in the repository for everybody, and may not import the tests."""
    found = []
    for problem in problems(30):
        known = best_values(problem)
        found.append(benchmark.brute_force(problem))
        assert found[-1] == pytest.approx(math.inf if known is None else known[0])
    assert any(map(math.isfinite, found)) and not all(map(math.isfinite, found))


def test_instances_are_of_every_sort() -> None:
    drawn = problems(30)
    assert {p.travel.convention for p in drawn} == {"trunc1", "exact"}
    assert {bool(p.sites.service.any()) for p in drawn} == {True, False}


def test_agreement_is_exit_0_and_a_disagreement_is_told_with_exit_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["small_cases", "--instances", "3", "--seed", "2", "--solvers", "highs"])
    assert benchmark.main() == 0
    assert "highs    agrees on 3/3" in capsys.readouterr().out
    monkeypatch.setattr(benchmark, "brute_force", lambda problem: 1.0)
    assert benchmark.main() == 1
    assert "brute force 1.0" in capsys.readouterr().out
