import numpy as np
import pytest
from bin_assignments import random_costs, worked
from draws import draws
from scipy.optimize import linear_sum_assignment

from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.stop import NEVER
from waybound.solvers.engines.auctions.assignment_steps.auction import auction
from waybound.solvers.engines.auctions.assignment_steps.recovered_prices import recovered_prices


def test_an_optimal_assignment_is_proved_so() -> None:
    rng = np.random.default_rng(12)
    for _ in range(draws(150)):
        problem = BinAssignment.from_matrix(random_costs(rng, 7))
        answer = auction(problem, NEVER).answer
        value = problem.evaluate(answer).values[0]
        assert recovered_prices(problem, answer, "x", NEVER).value == pytest.approx(value, abs=1e-9)


def test_of_another_one_less_is_proved() -> None:
    assert recovered_prices(worked("O"), (0, 1), "x", NEVER).value <= 4.0
    assert recovered_prices(worked("O"), (1, 0), "x", NEVER).value == 4.0


@pytest.mark.parametrize(
    "costs",
    [
        [[2.19e-8], [np.inf], [4439700.535], [37582421.2748]],
        [[np.inf, 1e-11, 8.0, 10.0], [2e-12, 4.0, 1e-11, 9.0]],
        [[3.55e-10, np.inf], [963804213232.2109, 4.371e-07], [595450330557.8839, 27410017469.41327]],
        [[0.0, np.inf, 13.69, 6.66]],
    ],
)
def test_tiny_optima_beside_large_costs_are_proved_too(costs: list[list[float]]) -> None:
    problem = BinAssignment.from_matrix(costs)
    found = auction(problem, NEVER)
    value = problem.evaluate(found.answer).values[0]
    for evidence in (found.evidence(problem, "x"), recovered_prices(problem, found.answer, "x", NEVER)):
        assert evidence.value == pytest.approx(value, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("spread", ["uniform", "orders of magnitude"])
def test_optima_of_several_hundred_robots_are_proved_to_nine_digits(spread: str) -> None:
    rng = np.random.default_rng(0)
    costs = rng.random((900, 900)) if spread == "uniform" else rng.lognormal(0, 4, size=(300, 300))
    problem = BinAssignment.from_matrix(costs)
    answer = tuple(linear_sum_assignment(costs)[1].tolist())
    value = problem.evaluate(answer).values[0]
    assert recovered_prices(problem, answer, "x", NEVER).value == pytest.approx(value, rel=1e-9, abs=0.0)
