import pytest

from waybound.api import solve
from waybound.reports.benchmarks import certified_ratio as benchmark


@pytest.mark.parametrize("case", benchmark.CASES)
@pytest.mark.parametrize("constraint", ["cardinality", "partition"])
def test_the_bound_that_comes_with_the_answer_certifies_two_thirds(case: tuple[int, int, int, int], constraint: str) -> None:
    solution = solve(benchmark.generate(*case, constraint), heuristic="greedy", bound_time=0)
    assert isinstance(solution.objective, float) and isinstance(solution.bound, float)
    assert solution.bound_kind == "verified"
    assert solution.objective / solution.bound >= benchmark.FREE


def test_the_report_shows_both_bounds() -> None:
    text, _ = benchmark.report([(60, 5, 40, 6)], seconds=5.0)
    assert text.count("\n") == 3
    row = text.split("\n")[1].split("|")
    assert float(row[2].split()[1]) >= float(row[1].split()[1])


@pytest.mark.long
def test_the_linear_program_certifies_four_fifths() -> None:
    _, met = benchmark.report(benchmark.CASES, seconds=120.0)
    assert met
