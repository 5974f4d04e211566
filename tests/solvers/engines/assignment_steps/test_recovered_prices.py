"""Prices of an assignment that came without any."""

from __future__ import annotations

import numpy as np
import pytest
from bin_assignments import random_costs, worked
from draws import draws

from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.stop import NEVER
from waybound.solvers.engines.assignment_steps.auction import auction
from waybound.solvers.engines.assignment_steps.recovered_prices import recovered_prices


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
