"""Bertsekas' auction: worked bids and prices, and what epsilon promises."""

import numpy as np
import pytest
from bin_assignments import OPTIMA, enumerated, worked
from draws import draws

import waybound as wb
from waybound import BinAssignment
from waybound.reports.ratios.judged_runs import run_heuristic


def run(problem: BinAssignment, **options):
    return run_heuristic(problem, "bertsekas", options, 1)


@pytest.mark.parametrize(
    ("name", "epsilon", "cost", "bids", "prices"),
    [
        ("A", 0.3, 9, 3, [3.3, 4.6, 6.6]), ("O", 0.45, 4, 3, [3.45, 2.9]), ("O", 1.0, 4, None, [4, 4]), ("O", 5.0, 6, None, None),
        ("K4", 0.225, 38, 7, None), ("L3", 0.3, 183, 4, None),
    ],
)  # fmt: skip
def test_worked_auctions(name: str, epsilon: float, cost: float, bids: int | None, prices: list[float] | None) -> None:
    problem = worked(name)
    found = run(problem, epsilon=epsilon, scaling=False)
    value = problem.evaluate(found.answer).values[0]
    assert value == cost and bids in (None, found.statistics["bids"])
    assert prices is None or found.evidence[0].data["prices"] == pytest.approx(prices, abs=1e-9)
    assert value - OPTIMA[name] <= problem.num_bins * epsilon
    assert value - found.evidence[0].value <= problem.num_bins * epsilon + 1e-9


def test_prices_rise_step_by_step_where_robots_fight() -> None:
    war = BinAssignment.from_matrix([[0.0, 0.0, 1000.0]] * 3)
    bids = [run(war, epsilon=epsilon, scaling=False).statistics["bids"] for epsilon in (1.0, 0.1)]
    assert bids[0] == 1003 and bids[1] in (10_002, 10_003), "the last bid may be one of rounding"
    scaled = run(war)
    assert scaled.statistics["bids"] < bids[0] / 8 and war.evaluate(scaled.answer).values == (1000.0,)


def test_no_answer_is_further_from_the_optimum_than_epsilon_allows_and_whole_costs_are_solved() -> None:
    rng = np.random.default_rng(41)
    for k in range(draws(300)):
        n, m = (int(size) for size in rng.integers(1, 6, 2))
        costs = rng.integers(0, 30, (n, m)).astype(float)
        problem, best = BinAssignment.from_matrix(costs), enumerated(costs)[1]
        epsilon = float(rng.choice([0.01, 0.5, 2.0, 10.0]))
        found = run(problem, epsilon=epsilon, scaling=bool(k % 2))
        value = problem.evaluate(found.answer).values[0]
        assert value <= best + max(n, m) * epsilon + 1e-9
        if epsilon * max(n, m) < 1:
            assert value == best and found.guarantee is not None and found.guarantee.ratio == 1.0
        if found.guarantee is not None and best > 0:
            assert value <= found.guarantee.ratio * best * (1 + 1e-9)
        exact = run(problem)
        assert problem.evaluate(exact.answer).values[0] == best == exact.evidence[0].value


def test_by_default_other_costs_are_proved_to_nine_digits() -> None:
    found = wb.solve(BinAssignment.from_matrix(np.random.default_rng(5).random((40, 55))), heuristic="bertsekas", bound_time=0)
    assert found.status == "optimal" and found.bound_kind == "verified" and found.gap is not None and found.gap < 1e-9


@pytest.mark.parametrize(
    ("costs", "epsilon", "best"),
    [
        ([[3e-9, 1e-9, 1e9]], 1e-12, 1e-9), ([[3e-9, 1e-9, 1e9]], None, 1e-9),
        ([[3e-7, 1.5e-7, 1e9, 1e9], [1.5e-7, 3e-7, 1e9, 1e9]], 1e-12, 3e-7), ([[2e-200, 1e-200, 1e150]], None, 1e-200),
        ([[1e-300, 2e-300], [3e-300, 1e-300]], None, 2e-300),
    ],
)  # fmt: skip
def test_ratios_hold_where_costs_are_rounded(costs: list[list[float]], epsilon: float | None, best: float) -> None:
    found = run(BinAssignment.from_matrix(costs), **({} if epsilon is None else {"epsilon": epsilon}))
    value = BinAssignment.from_matrix(costs).evaluate(found.answer).values[0]
    assert found.evidence[0].value <= best * (1 + 1e-15)
    assert found.guarantee is None or value <= found.guarantee.ratio * best * (1 + 1e-15)
    assert found.statistics["epsilon"] > 0.0


def test_many_rounded_costs_add_up_to_no_false_ratio() -> None:
    step, count = 2.0**-49, 50
    costs = np.full((count, 2 * count), np.inf)
    at = np.arange(count)
    costs[at, at], costs[at, at + count], costs[0, 1] = 1.49 * step, 0.51 * step, 1.0
    problem = BinAssignment.from_matrix(costs)
    found = run(problem)
    assert found.guarantee is not None and problem.evaluate(found.answer).values[0] <= found.guarantee.ratio * 0.51 * step * count


@pytest.mark.parametrize("epsilon", [1.0, 1e7, 1e20, 1e300])
@pytest.mark.parametrize("costs", [[[0.0, 0.0]], [[1.0, 2.0], [2.0, 1.0]], [[6e-6, 5.2e-6], [4.2e-6, 7e-6], [np.inf, np.inf]]])
def test_an_epsilon_beyond_the_costs_ends_with_an_answer(costs: list[list[float]], epsilon: float) -> None:
    problem = BinAssignment.from_matrix(costs)
    assert problem.evaluate(run(problem, epsilon=epsilon).answer).feasible


@pytest.mark.parametrize(
    ("epsilon", "said"), [(5.0, "epsilon 5 is run as 4, the range"), (1e-30, "a whole number of the finest steps"), (4.0, ""), (0.1, "")]
)
def test_another_epsilon_than_was_asked_for_is_told(epsilon: float, said: str) -> None:
    found = wb.solve(wb.BinAssignment.from_matrix([[1, 2], [2, 5]]), heuristic="bertsekas", epsilon=epsilon)
    assert said in found.message and ("is run as" in found.message) == bool(said)


@pytest.mark.parametrize("seed", range(5))
def test_an_epsilon_near_the_finest_step_is_rounded_for_the_steps_and_not_for_the_range(seed: int) -> None:
    problem = BinAssignment.from_matrix(np.random.default_rng(seed).random((10, 10)))
    for epsilon in (1e-16, 1e-15, 1e-14, 3e-14):
        message = run(problem, epsilon=epsilon).message
        assert not message or "a whole number of the finest steps" in message
    assert "the range of the costs" in run(problem, epsilon=3.0).message
