from pathlib import Path

import pytest

from waybound.reports.benchmarks import compile_three_index as benchmark
from waybound.reports.benchmarks.side_by_side import same_model


@pytest.mark.parametrize("windows", benchmark.WINDOWS)
def test_pulp_writes_the_same_rows_columns_and_values(windows: str, tmp_path: Path) -> None:
    problem = benchmark.generate(9, 2, windows, seed=3)
    program = problem.compile("three-index").program
    benchmark.with_pulp(benchmark.lists_for_pulp(problem), tmp_path / "model.mps")
    same_model(program, tmp_path / "model.mps")
    assert benchmark.with_waybound(problem).getNumRow() == program.num_rows
    assert benchmark.with_bare_highs(program)[0].getNumCol() == program.num_variables


def test_a_different_model_is_noticed(tmp_path: Path) -> None:
    problem = benchmark.generate(6, 2, "wide", seed=3)
    data = benchmark.lists_for_pulp(problem)
    data["capacity"] += 1.0
    benchmark.with_pulp(data, tmp_path / "model.mps")
    with pytest.raises(AssertionError, match="right sides"):
        same_model(problem.compile("three-index").program, tmp_path / "model.mps")


def test_same_seed_gives_the_same_problem() -> None:
    assert benchmark.generate(5, 2, "wide", 1).digest() == benchmark.generate(5, 2, "wide", 1).digest()
    assert benchmark.generate(5, 2, "wide", 1).digest() != benchmark.generate(5, 2, "wide", 2).digest()


@pytest.mark.long
def test_report_measures_all_three_and_compares_them() -> None:
    text = benchmark.report(6, 2, "medium", seed=1, repeats=1)
    assert "waybound: problem to HiGHS model" in text and "PuLP: lists to MPS file" in text and "targets" in text
