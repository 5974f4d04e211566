import pytest

import waybound as wb
from waybound.instances.generating import generate
from waybound.reports.benchmarks import risk_allocation as benchmark


@pytest.mark.slow
def test_methods_stand_side_by_side(monkeypatch: pytest.MonkeyPatch) -> None:
    lines, slow, quick = benchmark.side_by_side(benchmark.stalling(), 1)
    text = "\n".join(lines)
    assert "13.731143" in text and "13.420585" in text and "verified bound 13.731143" in text
    assert slow > 0 and quick > 0
    monkeypatch.setattr(
        benchmark,
        "reference",
        lambda family, **settings: wb.RiskAllocation(
            generate("risk-allocation", 1, family=family, steps=14, **{k: v for k, v in settings.items() if k == "constraints"})
        ),
    )
    told = benchmark.report(3, 1, steps=14)
    assert told.count("target ") == 7 and "random: 3 problems" in told


def test_a_worse_default_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = benchmark.by_program
    monkeypatch.setattr(benchmark, "convex", lambda problem, gap: benchmark.Interval(answer=honest(problem, "uniform"), prices={}))
    with pytest.raises(AssertionError):
        benchmark.compared(5)


def test_the_rebuilt_loop_ends_where_iterative_does_as_soon_as_plans_are_unique() -> None:
    problem = benchmark.of_unique_plans(benchmark.reference("corridor"))
    (answer, rounds), (value, others) = benchmark.by_iterative(problem), benchmark.rebuilt(problem)
    assert answer is not None and rounds == others
    assert problem.evaluate(answer).values[0] == pytest.approx(value, rel=1e-9)
