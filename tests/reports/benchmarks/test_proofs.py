"""The measurement of proofs: what it draws, and what it counts as proved."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from exact_truth import truth

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.reports.benchmarks.proofs import files, main, proof, small, small_instances


def test_instances_are_drawn_from_every_family_and_repeat() -> None:
    drawn = list(small_instances(10, 4))
    assert {problem.problem for problem in drawn} == {"cvrp", "arrays", "selection", "bottleneck", "winner-takes-all"}
    assert [p.digest() for p in drawn] == [p.digest() for p in small_instances(10, 4)]


def test_a_proof_is_the_optimum_of_a_small_program() -> None:
    for problem in [p for p in small_instances(60, 2) if isinstance(p, ArrayProblem) and p.program.num_variables <= 4]:
        best = truth(problem).best
        bound, seconds, evidence = proof(problem, None, 10.0)
        assert seconds < 11.0
        if best is None:
            assert bound is not None and math.isinf(bound)
        else:
            assert bound == pytest.approx(float(best[0]))
            assert evidence is not None


def test_what_is_proved_is_counted(capsys: pytest.CaptureFixture[str]) -> None:
    assert small(5, 10.0, 1) == 0
    said = capsys.readouterr().out
    assert "5 of 5 proved" in said and "0 contradictions" in said and "not proved" not in said


def test_the_command_ends_well(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.argv", ["proofs", "--instances", "2", "--winner-takes-all", "1"])
    assert main() == 0
    assert "leaves  proved" in capsys.readouterr().out


def test_files_are_cut_and_proved(benchmarks: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files(benchmarks / "vrptw-solomon", ["R101", "none"], 30.0)
    assert "R101     617.1" in capsys.readouterr().out
