from pathlib import Path

import pytest

from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.reports.benchmarks import compile_max_min as benchmark
from waybound.reports.benchmarks.side_by_side import same_model


@pytest.mark.parametrize("actions", [60, 400])
def test_pulp_writes_the_same_rows_columns_and_values(actions: int, tmp_path: Path) -> None:
    graph = benchmark.generate(actions, seed=3)
    program = BottleneckSATA(graph, fractional=True).compile().program
    benchmark.with_pulp(benchmark.lists_for_pulp(graph), tmp_path / "model.mps")
    same_model(program, tmp_path / "model.mps")
    assert benchmark.with_waybound(graph).getNumRow() == program.num_rows


def test_a_different_model_is_noticed(tmp_path: Path) -> None:
    graph = benchmark.generate(100, seed=3)
    data = benchmark.lists_for_pulp(graph)
    action, weight = data["targets"][0][0]
    data["targets"][0][0] = (action, weight + 0.5)
    benchmark.with_pulp(data, tmp_path / "model.mps")
    with pytest.raises(AssertionError, match="coefficients"):
        same_model(BottleneckSATA(graph, fractional=True).compile().program, tmp_path / "model.mps")


def test_same_seed_gives_the_same_graph() -> None:
    assert benchmark.generate(200, 1).digest() == benchmark.generate(200, 1).digest()
    assert benchmark.generate(200, 1).digest() != benchmark.generate(200, 2).digest()


@pytest.mark.long
def test_report_measures_both_and_compares_them() -> None:
    text = benchmark.report(200, seed=1, repeats=1)
    assert "waybound: sensing graph to HiGHS model" in text and "PuLP: lists to MPS file" in text and "target" in text
