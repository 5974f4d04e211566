import math

import pytest

from waybound.reports.benchmarks import winner_takes_all as benchmark


@pytest.mark.parametrize("family", benchmark.FAMILIES)
def test_what_is_measured_is_proved_and_highs_agrees(family: str) -> None:
    graph = benchmark.FAMILIES[family](100)
    found = benchmark.measure(graph, 60.0)
    told = [seconds for seconds in found.until if not math.isnan(seconds)]
    assert len(told) == len(benchmark.GAPS) and told == sorted(told) and told[-1] <= found.seconds
    optimum = float(benchmark.by_highs(graph, "simplex", 60.0).rsplit(" ", 1)[1])
    assert found.value <= optimum + 1e-3 and found.greedy <= found.bound
    assert found.value == pytest.approx(optimum, rel=1e-6, abs=1e-3)
    assert math.floor(optimum) <= found.bound <= optimum * (1 + 1e-6) + 1e-3  # the checker rounds down to what a value may be


def test_that_highs_found_no_optimum_is_told() -> None:
    assert "simplex no optimum after" in benchmark.by_highs(benchmark.FAMILIES["torus"](400), "simplex", 0.0)


def test_the_report_has_a_line_for_each_size_and_the_target(capsys: pytest.CaptureFixture[str]) -> None:
    assert benchmark.main(["--families", "torus", "--robots", "16", "25"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in lines if line.startswith("torus")] == [["torus", "16", "64"], ["torus", "25", "100"]]
    assert sum("HiGHS" in line for line in lines) == 6 and lines[-1].endswith("met")
