"""Online greedy: worked epochs, orders, and its worst line."""

import math

import pytest
from bin_assignments import worked

from waybound import BinAssignment, UsageError
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.reports.studies.auctions.bin_auctions import serial_line


def run(problem: BinAssignment, **options):
    return run_heuristic(problem, "online-greedy", options, 1)


@pytest.mark.parametrize(
    ("name", "cost", "plan"),
    [
        ("A", 9, None), ("F", 9, None), ("E", 9, (0, 1, -1)), ("G", 3, None), ("O", 6, None), ("B", 100, None), ("D", 10, None),
        ("K4", 43, (0, 2, 3, 1)), ("L3", 201, None),
    ],
)  # fmt: skip
def test_worked_epochs(name: str, cost: float, plan: tuple[int, ...] | None) -> None:
    found = run(worked(name))
    assert worked(name).evaluate(found.answer).values == (cost,) and plan in (None, found.answer)


def test_the_order_decides() -> None:
    assert worked("O").evaluate(run(worked("O"), order=[1, 0]).answer).values == (4.0,)
    assert run(worked("K4"), order="random").answer == run(worked("K4"), order="random").answer
    for order in ("backwards", [0, 0], [1], ["a", "b"], 3):
        with pytest.raises(UsageError, match="order must"):
            run(worked("O"), order=order)


def test_its_ratio_is_attained_on_a_line_to_nine_digits() -> None:
    for n in range(1, 11):
        case = serial_line(n)
        assert case.optimum is not None and case.optimum.value == 1.0
        found = run(case.problem)
        assert case.problem.evaluate(found.answer).values[0] == pytest.approx(2**n - 1, rel=1e-9)
        assert found.guarantee is not None and found.guarantee.ratio == 2**n - 1


def test_no_ratio_holds_for_more_robots_than_bins_or_other_costs() -> None:
    assert run(BinAssignment.from_matrix([[100.0], [1.0]])).guarantee is None
    assert run(worked("B")).guarantee is None
    found = run(BinAssignment.from_matrix([[1.0, 9.0], [2.0, math.inf]]))
    assert found.answer == (1, 0) and found.guarantee is None
