import math
from fractions import Fraction

import numpy as np
import pytest
from bin_assignments import enumerated, random_costs, worked
from coded import coded
from draws import draws

from waybound import BinAssignment, InputError
from waybound.formulations.auctions.checking.assignment_prices import check_assignment_prices


def exactly(problem: BinAssignment, prices: list[float], level: float) -> Fraction:
    """The bound in fractions, by its definition."""
    given = [Fraction(p) if problem.pairs == problem.num_bins else max(Fraction(0), Fraction(p)) for p in prices]
    costs = problem.matrix().tolist()
    least = [min((Fraction(c) + p for c, p in zip(row, given, strict=True) if c < math.inf), default=None) for row in costs]
    if problem.pairs == problem.num_robots:
        return sum(least, Fraction(0)) - sum(given)  # type: ignore[arg-type]
    gains = [Fraction(level) - one for one in least if one is not None and one < Fraction(level)]
    return problem.pairs * Fraction(level) - sum(given) - sum(gains)


@pytest.mark.parametrize("scale", [1.0, 2.0**-40, 1e-9, 1e9, 1e140])
def test_any_prices_prove_no_more_than_what_holds(scale: float) -> None:
    rng = np.random.default_rng(3)
    for _ in range(draws(60)):
        costs = random_costs(rng, 4)
        problem = BinAssignment.from_matrix(costs * scale)
        best = enumerated(costs * scale)[1]
        for prices in (rng.random(costs.shape[1]) * 60 - 20, rng.integers(-5, 60, costs.shape[1]).astype(float), np.zeros(costs.shape[1])):
            given = (prices * scale).tolist()
            level = float(rng.integers(-20, 60)) * scale
            bound = check_assignment_prices(problem, {"prices": given, "level": level})
            true = exactly(problem, given, level)
            assert Fraction(bound) <= true and bound <= best
            assert float(true) - bound <= 1e-14 * (abs(float(true)) + sum(map(abs, given)) + scale * 60 * sum(costs.shape))


def test_whole_numbers_are_proved_to_the_last_digit() -> None:
    assert check_assignment_prices(worked("O"), {"prices": [4.0, 3.0]}) == 4.0
    zero = BinAssignment.from_matrix([[0.0, 7.0], [3.0, 0.0]])
    assert check_assignment_prices(zero, {"prices": [0.0, 0.0]}) == 0.0


def test_evidence_of_another_shape_is_refused() -> None:
    for data in ({}, {"prices": [1.0]}, {"prices": [1.0, None]}, {"prices": [1.0, math.nan]}, {"prices": [1.0, 1e301]}, {"prices": "ab"},
                 {"prices": [1.0, True]}, {"prices": [0.0, 0.0], "level": math.inf}, {"prices": [0.0, 0.0], "level": None}):  # fmt: skip
        with pytest.raises(InputError, check=coded("malformed")):
            check_assignment_prices(worked("O"), data)


def test_nothing_is_proved_of_the_largest_cost() -> None:
    assert check_assignment_prices(worked("O", objective="bottleneck"), {"prices": [4.0, 3.0]}) == -math.inf


def test_robots_without_a_bin_prove_that_there_is_no_answer_where_all_are_asked_for() -> None:
    problem = BinAssignment.from_matrix([[1.0], [math.inf]], match="robots")
    assert check_assignment_prices(problem, {"prices": [0.0]}) == math.inf
